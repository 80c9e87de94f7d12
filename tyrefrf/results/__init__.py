"""What a run computed, and the HDF5 file that keeps it (the only HDF5 code of the program)."""

from tyrefrf.results.comparison import Comparison
from tyrefrf.results.comparison_layout import write_comparison
from tyrefrf.results.dispersion import Dispersion
from tyrefrf.results.dispersion_layout import write_dispersion
from tyrefrf.results.labelled import to_xarray
from tyrefrf.results.measured import Agreement, Measured, agreements
from tyrefrf.results.measured_reader import read_measured
from tyrefrf.results.modes import Modes
from tyrefrf.results.modes_layout import write_modes
from tyrefrf.results.reader import (
    load_any,
    load_comparison,
    load_dispersion,
    load_modes,
    load_results,
    load_sweep,
)
from tyrefrf.results.results import Provenance, Results, StaticState
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.writer import write_results, write_sweep

__all__ = [
    "Agreement",
    "Comparison",
    "Dispersion",
    "Measured",
    "Modes",
    "Provenance",
    "Results",
    "StaticState",
    "SweepResults",
    "agreements",
    "load_any",
    "load_comparison",
    "load_dispersion",
    "load_modes",
    "load_results",
    "load_sweep",
    "read_measured",
    "to_xarray",
    "write_comparison",
    "write_dispersion",
    "write_modes",
    "write_results",
    "write_sweep",
]
