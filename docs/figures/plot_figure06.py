r"""
Figure 6: angle of the cell
===========================

**The paper:** the radial (a) and the tangential mobility (b) at point 5 for periods of 0.5, 1, 2, 4
and 8 degrees. The influence of the angle is important only for high frequencies, and higher for the
radial component than for the tangential part.
"""

from tempfile import mkdtemp

import numpy as np
import pandas as pd
from measures import case_of, decibels, lines

import tyrefrf
from tyrefrf.plots import draw_plots

study = tyrefrf.sweep(case_of(6), {"sector_angle": None})
drawn = {path.stem: path for path in draw_plots(study, mkdtemp())}
shown = [drawn["mobility_radial_point_5_r"], drawn["mobility_tangential_point_5_theta"]]

# %%
# **Ours:** mean absolute difference of the levels [dB] to those of the finest cell:

PARTS = {"radial": ("radial", "point 5 r"), "tangential": ("tangential", "point 5 theta")}
BANDS = {"20-300 Hz": (20, 300), "300-1000 Hz": (300, 1000), "1-2 kHz": (1000, 2000)}
finest, *coarser = study.points


def deviation(point, part, band):
    """From the finest cell [dB]."""
    there = lines(point, *BANDS[band])
    levels = [decibels(one.response(*PARTS[part])[there]) for one in (point, finest)]
    return np.abs(levels[0] - levels[1]).mean()


table = pd.DataFrame(
    {
        label: {(part, band): deviation(point, part, band) for part in PARTS for band in BANDS}
        for label, point in zip(study.labels[1:], coarser, strict=True)
    }
).T
assert (table["radial"] > table["tangential"]).all(axis=None)  # as the paper says
table.style.format("{:.2f}")
