"""What a run computed, and the HDF5 file that keeps it (the only HDF5 code of the program)."""

from tyrefrf.results.reader import load_results
from tyrefrf.results.results import Provenance, Results
from tyrefrf.results.writer import write_results

__all__ = ["Provenance", "Results", "load_results", "write_results"]
