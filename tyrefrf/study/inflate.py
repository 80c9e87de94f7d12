"""A case's inflation: the pressure put on its cell, and the state checked for stability."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefrf.errors import CaseError, Problem, SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.constitutive import Scaled, constitutive
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.fem.inflation import Inflatable, Inflation
from tyrefrf.fem.orientation import in_bricks
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.solvers.inertia import unstable_orders

if TYPE_CHECKING:
    from tyrefrf.case import Case, Material


def inflate(case: Case, mesh: CellMesh, cell: CellMatrices) -> Inflation:
    """The cell at rest under the case's pressure; `applied_to` gives its matrices about it.

    Raises CaseError at `inflation.pressure` where no equilibrium is found, or an unstable one:
    a tyre whose static stiffness is indefinite has buckled.
    """
    element = ELEMENTS[case.cell.element]
    laws = {name: constitutive(case.laid_materials[name]) for name in mesh.materials}
    static, dynamic = {}, {}
    for index, name in enumerate(mesh.materials):
        X, law = mesh.cartesian[mesh.bricks[mesh.material == index]], laws[name]
        static[name] = in_bricks(law, law.static, element, X)
        dynamic[name] = in_bricks(law, law.reference, element, X)
    body = Inflatable(mesh, element, cell, static, dynamic)
    pressure = case.inflation.pressure
    try:
        state = (
            body.linear(pressure) if case.inflation.kind == "linear" else body.nonlinear(pressure)
        )
    except SolveError as error:
        raise _refused(str(error)) from error
    about = state.applied_to(cell, pressure_stiffness=case.inflation.pressure_stiffness)
    unstable = unstable_orders(about, case.cell.n_cells)
    if unstable:
        orders = ", ".join(map(str, unstable))
        raise _refused(
            f"the tyre buckles under {pressure:.6g} Pa: its static stiffness is indefinite at "
            f"circumferential order {orders}; lower the pressure, or stiffen the tyre"
        )
    return state


def elasticity_key(stuff: Material) -> str:
    """What of a material an inflation depends on, as text."""
    law = constitutive(stuff)
    if isinstance(law, Scaled):
        return (law.static.tobytes() + law.reference.tobytes()).hex()
    return stuff.model_dump_json()  # plies: their loss stands in the deformed parts too


def _refused(message: str) -> CaseError:
    return CaseError([Problem(("inflation", "pressure"), message)])
