r"""
Figure 10: internal pressure
============================

**The paper:** the influence of the internal air-pressure on the mobility, 0 to 3000 Hz. Changing
the pressure mainly shifts the resonance frequencies, which comes from the increase in rigidity as
the pressure increases.
"""

from tempfile import mkdtemp

import pandas as pd
from measures import case_of, first_peak, level

import tyrefrf
from tyrefrf.plots import draw_plots

study = tyrefrf.sweep(case_of(10), {"pressure": None})
drawn = {path.stem: path for path in draw_plots(study, mkdtemp())}
shown = [drawn["mobility_radial_drive"]]

# %%
# **Ours:**

table = pd.DataFrame(
    {
        label: {
            "first resonance [Hz]": first_peak(point),
            "mean level, 20-500 Hz [dB]": level(point, "radial.drive", 20, 500),
            "mean level, 1-3 kHz [dB]": level(point, "radial.drive", 1000, 3000),
        }
        for label, point in zip(study.labels, study.points, strict=True)
    }
).T
assert table["first resonance [Hz]"].is_monotonic_increasing  # as the paper says
table.style.format("{:.1f}")
