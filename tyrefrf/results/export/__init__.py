"""Responses as files of other programs: universal files, CSV and MATLAB."""

from tyrefrf.results.export.files import FORMATS, check_formats, export, planned_files

__all__ = ["FORMATS", "check_formats", "export", "planned_files"]
