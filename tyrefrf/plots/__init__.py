"""Figures of results (the only matplotlib code of the program)."""

from tyrefrf.plots.files import draw_plots

__all__ = ["draw_plots"]
