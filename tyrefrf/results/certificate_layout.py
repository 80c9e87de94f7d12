"""The certificate in the file of a run that has one; its loads and probes are the run's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import ArrayLike

from tyrefrf.results.certificate import Certificate
from tyrefrf.results.field import Columns, Field, Kind


def _second(
    name: str,
    axes: tuple[str, ...],
    kind: Kind,
    units: str,
    long_name: str,
    value: Callable[[Certificate], ArrayLike],
) -> Field:
    """A dataset of the certificate."""

    def of(results: Any) -> ArrayLike:
        return value(results.certificate)

    paths = tuple(axis if axis in ("load", "probe") else f"certificate/{axis}" for axis in axes)
    return Field(f"certificate/{name}", paths, kind, units, long_name, of)


CERTIFICATE = (
    _second("checked", ("checked",), "float", "Hz", "lines solved again", lambda c: c.frequency),
    _second(
        "refined",
        ("refined",),
        "float",
        "Hz",
        "lines of the refined ring",
        lambda c: c.refined_frequency,
    ),
    _second("number", ("number",), "int", "1", "the one certificate", lambda _: [0]),
    _second("solver", ("number",), "text", "", "who solved again", lambda c: [c.solver]),
    _second("residual", ("checked",), "float", "1", "||F - D q|| / ||F||", lambda c: c.residual),
    _second(
        "difference",
        ("load", "checked"),
        "float",
        "1",
        "||H' - H|| / ||H|| over the probes",
        lambda c: c.difference,
    ),
    _second(
        "cell_difference",
        ("load", "checked"),
        "float",
        "1",
        "largest ||q' - q|| / ||q|| of any cell",
        lambda c: c.cell_difference,
    ),
    _second("n_cells", ("number",), "int", "1", "of the refined ring, or 0", lambda c: [c.n_cells]),
    _second(
        "level_change",
        ("load", "probe", "refined"),
        "float",
        "dB",
        "level by the refined ring less level; of refining around the axle alone",
        lambda c: c.level_change,
    ),
    _second("left_out", ("number",), "text", "", "why no ring is refined", lambda c: [c.left_out]),
)
"""In the file only where a certificate was asked for."""


def certificate_of(columns: Columns) -> Certificate | None:
    """The certificate, read back, or none."""
    found = {
        name.removeprefix("certificate/"): array
        for name, array in columns.items()
        if name.startswith("certificate/")
    }
    if not found:
        return None
    return Certificate(
        solver=found["solver"][0],
        frequency=found["checked"],
        residual=found["residual"],
        difference=found["difference"],
        cell_difference=found["cell_difference"],
        n_cells=int(found["n_cells"][0]),
        refined_frequency=found["refined"],
        level_change=found["level_change"],
        left_out=found["left_out"][0],
    )
