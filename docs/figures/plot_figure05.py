r"""
Figure 5: homogeneous tyre, point mobilities
============================================

**The paper:** the present technique against a full computation with Ansys, for the radial (a) and
the tangential mobility (b) at the force. The two are very close; the largest relative error is of
order 4e-6 (in the axial case).

**Ours** holds the recursion against the assembled ring, ``direct``.
"""

from tempfile import mkdtemp

import numpy as np
import pandas as pd
from measures import case_of, first_peak, level

import tyrefrf
from tyrefrf.plots import draw_plots
from tyrefrf.solvers import SOLVERS
from tyrefrf.study.model import build_model

case = case_of(5)
results = tyrefrf.run(case)
drawn = {path.stem: path for path in draw_plots(results, mkdtemp())}
shown = [drawn["mobility_radial"], drawn["mobility_tangential"]]

# %%
# The largest difference to the assembled ring at any section of the tyre, relative to the
# displacement of that section, under either load:

problem = build_model(case).problem
rows = {}
for hertz in np.linspace(5.0, 2000.0, 5):
    q = {name: make(problem).field(2.0 * np.pi * hertz).q for name, make in SOLVERS.items()}
    truth = q.pop("direct")
    size = np.linalg.norm(truth, axis=1)
    rows[f"{hertz:g} Hz"] = {
        name: f"{(np.linalg.norm(found - truth, axis=1) / size).max():.0e}"
        for name, found in q.items()
    }
pd.DataFrame(rows).T

# %%
# First resonances and mean level:

print(f"first radial resonance at {first_peak(results):.0f} Hz")
print(f"first tangential resonance at {first_peak(results, 'tangential'):.0f} Hz")
print(f"mean radial level in 1-2 kHz {level(results, 'radial.drive', 1000, 2000):.1f} dB")
