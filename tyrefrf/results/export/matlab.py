"""MAT-files (version 5, which MATLAB, Octave and scipy load): everything of a run or a sweep.

    m = load("case.mat");
    plot(m.frequency, squeeze(20*log10(abs(m.mobility(1, 2, :)))))
    legend(m.probe{2})

Responses are complex, (load, probe, line), with the parameters of a sweep leading; a line without
an answer is NaN. Names are cell arrays. `place` tells where loads and probes are; `bands` holds
mean squares and levels in one-third octaves; `regions` the means over regions.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefrf.errors import ResultsError
from tyrefrf.mesh.place import Place
from tyrefrf.results.derived import (
    UNITS,
    Reference,
    band_mean_square,
    bands_of,
    level,
    lines_in,
    regions_of,
    space_mean_square,
)
from tyrefrf.results.results import Quantity, Results
from tyrefrf.results.run_layout import PLACE_COLUMNS
from tyrefrf.results.sweep import SweepResults

LARGEST = 2**31 - 1
"""Bytes of one variable that a file of version 5 can hold."""

Struct = dict[str, Any]


def write_mat(
    path: Path, results: Results | SweepResults, quantity: Quantity, reference: Reference
) -> None:
    """Write a run's or a sweep's responses to a MAT-file.

    Raises ResultsError where one variable is too large for such a file.
    """
    from scipy.io import savemat

    response = getattr(results, quantity)
    if response.nbytes > LARGEST:
        raise ResultsError(
            f"{quantity} takes {response.nbytes / 1e9:.1f} GB, a MAT-file holds 2 GB of one "
            "variable; in MATLAB, h5read takes it from the results file itself"
        )
    variables: Struct = {
        **_origin(results),
        "frequency": results.frequency[:, None],
        "quantity": quantity,
        "units": UNITS[quantity],
        quantity: response,
        "load": cells(place.name for place in results.loads),
        "probe": cells(place.name for place in results.probes),
        "place": {
            "load": _places(results.loads),
            "probe": _places(results.probes),
        },
        "solved": results.solved,
        "residual": results.residual,
        "bands": _bands(results, quantity, reference),
        "regions": _regions(results, quantity, reference),
    }
    if results.hub:
        variables |= {"hub": cells(results.hub), "blocked_force": results.blocked_force}
    if isinstance(results, SweepResults):
        variables["parameter"] = {
            "name": cells(axis.name for axis in results.axes),
            "units": cells(axis.units for axis in results.axes),
            "meaning": cells(axis.meaning for axis in results.axes),
            "values": cells(np.array(axis.values)[:, None] for axis in results.axes),
        }
    savemat(
        str(path),
        variables,
        appendmat=False,
        do_compression=True,
        oned_as="column",
        long_field_names=True,
    )


def cells(items: Any) -> NDArray[np.object_]:
    """A column of cells."""
    listed = list(items)
    column = np.empty((len(listed), 1), dtype=object)
    for k, item in enumerate(listed):
        column[k, 0] = item
    return column


def _origin(results: Results | SweepResults) -> Struct:
    origin = results.provenance
    return {
        "case_name": origin.case_name,
        "title": origin.title,
        "case_hash": origin.case_hash,
        "tyrefrf_version": origin.version,
        "solver": origin.solver,
        "created": origin.created,
    }


def _places(places: tuple[Place, ...]) -> Struct:
    """Columns, one value per place: cells of texts, numbers in SI and radians."""
    return {
        name: cells(getattr(place, name) for place in places)
        if kind == "text"
        else np.array([[getattr(place, name)] for place in places])
        for name, kind, *_ in PLACE_COLUMNS
    }


def _bands(results: Results | SweepResults, quantity: Quantity, reference: Reference) -> Struct:
    """One-third octaves of every response, (..., load, probe, band)."""
    bands = bands_of(results.frequency)
    square = np.abs(getattr(results, quantity)) ** 2
    mean = band_mean_square(results.frequency, square, bands)
    return {
        "nominal": bands.nominal[:, None],
        "centre": bands.centre[:, None],
        "lower": bands.lower[:, None],
        "upper": bands.upper[:, None],
        "lines": lines_in(bands, results.frequency)[:, None],
        "mean_square": mean,
        "level": level(mean, reference),
        "reference": reference.value,
        "reference_name": reference.name,
    }


def _regions(results: Results | SweepResults, quantity: Quantity, reference: Reference) -> Struct:
    """Means over regions, (..., load, region, line) and (..., load, region, band)."""
    names = list(regions_of(results.probes))
    if not names:
        return {"name": cells([])}
    square = np.stack([space_mean_square(results, name, quantity) for name in names], axis=-2)
    mean = band_mean_square(results.frequency, square, bands_of(results.frequency))
    return {
        "name": cells(names),
        "mean_square": square,
        "band_mean_square": mean,
        "band_level": level(mean, reference),
    }
