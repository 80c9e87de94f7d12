r"""
Figure 9: modulus of the rubber
===============================

**The paper:** the radial mobility at the position of the force for three values of the modulus of
the rubber. As expected, the mobilities decrease with the value of the rubber modulus.
"""

from tempfile import mkdtemp

import pandas as pd
from measures import case_of, first_peak, level

import tyrefrf
from tyrefrf.plots import draw_plots

study = tyrefrf.sweep(case_of(9), {"E_rubber": None})
drawn = {path.stem: path for path in draw_plots(study, mkdtemp())}
shown = [drawn["mobility_radial_drive"]]

# %%
# **Ours:**

table = pd.DataFrame(
    {
        label: {
            "mean level, 20-2000 Hz [dB]": level(point, "radial.drive", 20, 2000),
            "first resonance [Hz]": first_peak(point),
        }
        for label, point in zip(study.labels, study.points, strict=True)
    }
).T
assert table["mean level, 20-2000 Hz [dB]"].is_monotonic_decreasing  # as the paper says
table.style.format("{:.1f}")
