"""How the ring is solved."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer

from tyrefrf.case.faults import Fault
from tyrefrf.case.table import Table
from tyrefrf.case.units import FREQUENCY, Quantity

SolverName = Literal["recursive", "cyclic", "direct", "modal", "auto"]

_OWNERS = {
    "library": "direct",
    "modes": "modal",
    "cutoff": "modal",
    "damping": "modal",
    "static_correction": "modal",
}
"""The solver that each key beside `name` belongs to."""


class Solver(Table):
    """How the ring is solved. All solvers give the same answer, but `modal` is truncated."""

    name: SolverName = Field(
        "recursive",
        description="recursive: doubling (the paper's); cyclic: one system per circumferential "
        "order; direct: the whole ring, assembled; modal: undamped modes, superposed; auto: "
        "recursive or cyclic, whichever is expected to be the faster",
    )
    library: Literal["auto", "superlu", "pardiso"] = Field(
        "auto",
        description="direct: what factorises; auto: the fastest installed, superlu: scipy's, "
        "pardiso: MKL's",
    )
    modes: int | None = Field(
        None, ge=1, le=10_000_000, description="modal: how many of the lowest modes (1000)"
    )
    cutoff: Annotated[float, Quantity(FREQUENCY, ge=1e-3, le=1e6)] | None = Field(
        None, description="modal: all modes up to this frequency [Hz], instead of a number"
    )
    damping: Literal["full", "modal"] = Field(
        "full",
        description="modal: full: all of the damping, projected on the modes; modal: one loss "
        "factor per mode, from the strain energy of the materials",
    )
    static_correction: bool = Field(
        False, description="modal: whether the modes left out respond as they do at 0 Hz"
    )

    def _faults(self) -> Iterator[Fault]:
        for key, owner in _OWNERS.items():
            given = getattr(self, key) != type(self).model_fields[key].default
            if given and self.name != owner:
                yield Fault((key,), f"belongs to the solver '{owner}', not to '{self.name}'")
        if self.modes is not None and self.cutoff is not None:
            yield Fault(("cutoff",), "not together with modes; give one of the two")

    @model_serializer(mode="wrap")
    def _own_keys(self, written: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without the keys of other solvers."""
        keys: dict[str, Any] = written(self)
        return {key: keys[key] for key in keys if _OWNERS.get(key, self.name) == self.name}
