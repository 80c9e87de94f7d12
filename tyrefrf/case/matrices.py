"""One cell as matrices that another program assembled."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from tyrefrf.case.faults import Fault
from tyrefrf.case.modulus import LossFactor, ModulusLaw
from tyrefrf.case.table import Name, Table

ONE_PART = "tyre"
"""Name of the stiffness that comes in one part."""

File = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]+$")]
"""Name of a file, or of a set in one: in one line."""

_MATRIX = (
    "Matrix Market (.mtx), scipy's sparse .npz, or lines of row, column and value "
    "(CalculiX's .sti and .mas)"
)
_SET = "file with the numbers of its nodes, or node set of the .inp file in `nodes`"


class Part(Table):
    """A part of the stiffness with a loss of its own: K (1 + i eta), or K scaled by a modulus."""

    file: File = Field(description=f"the real stiffness matrix: {_MATRIX}")
    eta: LossFactor = Field(0.0, description="loss factor [-]")
    modulus: ModulusLaw | None = Field(
        None,
        description="complex modulus that depends on frequency, instead of eta: the file's matrix "
        "is that of its value at 0 Hz",
    )

    def _faults(self) -> Iterator[Fault]:
        if self.modulus is not None and self.eta != 0.0:
            yield Fault(("eta",), "not together with modulus, which gives eta")


@dataclass(frozen=True)
class _OneOrMore:
    """Annotation of the parts: a file's name, or a part's table, stands for the only one."""

    def __get_pydantic_core_schema__(
        self, source: type[Any], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_before_validator_function(_parts, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        parts = handler(schema)
        ((name, part),) = parts["patternProperties"].items()
        one = [{"type": "string", "pattern": r"^[^\x00-\x1f\x7f]+$"}, part]
        return {"anyOf": [*one, {**parts, "patternProperties": {name: {"anyOf": one}}}]}


def _parts(value: object) -> object:
    """What is written of the stiffness, as parts by name."""
    if isinstance(value, str) or (isinstance(value, dict) and isinstance(value.get("file"), str)):
        value = {ONE_PART: value}
    if not isinstance(value, dict):
        return value
    return {name: {"file": part} if isinstance(part, str) else part for name, part in value.items()}


class Matrices(Table):
    """K, M, C and K_G of one cell, real and symmetric, with its nodes and their three sets."""

    K: Annotated[dict[Name, Part], Field(min_length=1), _OneOrMore()] = Field(
        description='stiffness: a file, { file = "K.mtx", eta = 0.1 }, or several such by name, '
        "as [matrices.K.rubber]"
    )
    M: File = Field(description=f"mass: {_MATRIX}")
    C: File | None = Field(None, description="viscous damping; beside that of [damping]")
    K_G: File | None = Field(
        None, description="geometric stiffness of the loaded state, where K is without it; no loss"
    )
    units: Literal["SI", "mm-t-s", "mm-kg-ms"] = Field(
        description="units of the matrices and of the nodes' coordinates: SI (m, kg, s, N), mm-t-s "
        "(N, MPa) or mm-kg-ms (kN, GPa)"
    )
    directions: Literal["cartesian", "cylindrical"] = Field(
        "cartesian",
        description="directions of the rows: x, y, z, or r, y, theta at each node (r outwards, "
        "y along the axle, theta growing from x towards z)",
    )
    axis: Literal["x", "y", "z"] = Field("y", description="the axle in the files' x, y, z")
    dofs: File | None = Field(
        None,
        description="node and direction of every row, as node.direction (CalculiX's .dof) or row, "
        "node, direction; default: three rows for each node, in the order of `nodes`",
    )
    nodes: File = Field(
        description="number, x, y, z of every node, or, with a heading that says so, r, y, theta "
        "[deg]; or the nodes of an .inp file"
    )
    left: File = Field(description=f"section where the cell begins: {_SET}")
    right: File = Field(description=f"section where the cell ends, sector_angle further: {_SET}")
    rim: File | None = Field(
        None, description=f"nodes that the rim holds: {_SET}; default: a free tyre"
    )

    @property
    def sets(self) -> dict[str, str]:
        """The node sets that are given, by their keys."""
        return {key: value for key in ("left", "right", "rim") if (value := getattr(self, key))}

    @property
    def has_named_sets(self) -> bool:
        """Whether the sets are those of a mesh file, and not files of their own."""
        return self.nodes.lower().endswith(".inp")

    def _faults(self) -> Iterator[Fault]:
        if self.directions == "cylindrical" and self.axis != "y":
            message = "not with directions = 'cylindrical', which are r, y, theta: the axle is y"
            yield Fault(("axis",), message)
