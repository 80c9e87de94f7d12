"""Results as an xarray.Dataset: what opening their file with xarray gives, without the file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefrf.errors import ResultsError
from tyrefrf.results.file import attributes_of
from tyrefrf.results.results import Results
from tyrefrf.results.sweep import SweepResults
from tyrefrf.results.writer import content_of

if TYPE_CHECKING:
    import xarray


def to_xarray(results: Results | SweepResults) -> xarray.Dataset:
    """The responses of a run or a sweep with their axes, units and proofs.

    The axes of a sweep's parameters lead. What the file keeps in groups (the section, the
    inflation) is left out. Raises ResultsError where xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise ResultsError(
            'xarray is not installed; `pip install "tyrefrf[xarray]"` brings it'
        ) from None

    content, datasets = content_of(results)
    here = [(field, array) for field, array in datasets if not field.group]
    variables = {
        field.name: (
            field.axes,
            array,
            {"units": field.units, "long_name": field.long_name, **dict(field.more)},
        )
        for field, array in here
    }
    axes = {field.name: variables.pop(field.name) for field, _ in here if field.is_scale}
    return xarray.Dataset(variables, axes, attributes_of(content, results.provenance))
