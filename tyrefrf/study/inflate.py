"""A case's inflation: the pressure put on its cell, and the state checked for stability."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefrf.errors import CaseError, Problem, SolveError
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.fem.constitutive import Scaled, constitutive
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.fem.inflation import Inflatable, Inflation
from tyrefrf.fem.orientation import in_bricks
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.solvers.stability import instability

if TYPE_CHECKING:
    from tyrefrf.case import Case, Material


SMALL = 0.15
"""Strain up to which a linear inflation is let pass without a word; the paper's own, 2 bar in its
layered tyre, has 0.09."""


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
    follows = case.inflation.pressure_stiffness
    about = state.applied_to(cell, pressure_stiffness=follows)
    _check_stable(case, about, "its static stiffness")
    if any(not np.array_equal(static[name], dynamic[name]) for name in static):
        about = state.at_equilibrium(cell, pressure_stiffness=follows)
        _check_stable(case, about, "its static stiffness, with the moduli for inflation,")
    return state


def _check_stable(case: Case, about: CellMatrices, stiffness: str) -> None:
    """Raise CaseError where a tyre about its state under pressure has an unstable direction."""
    found = instability(about, case.cell.n_cells)
    if found is None:
        return
    pressure, bears = case.inflation.pressure, ""
    if case.inflation.kind == "linear" and found.share:  # K_G and K_P grow with the pressure
        bears = f"; it bears {found.share * pressure:.4g} Pa"
    raise _refused(
        f"the tyre buckles under {pressure:.6g} Pa: {stiffness} is {found.words}{bears}; lower the "
        "pressure, or stiffen the tyre"
    )


def strained(strain: float) -> tuple[str, ...]:
    """A warning where strains that are taken as small are not; strain: the largest, or NaN."""
    if not strain > SMALL:
        return ()
    return (
        f"the linear inflation strains the tyre by up to {100.0 * strain:.0f} %, and leaves "
        "out what is of the strain's square; lower inflation.pressure, stiffen the tyre, or let "
        'inflation.kind = "nonlinear" (hex20, hex20r)',
    )


def elasticity_key(stuff: Material) -> str:
    """What of a material an inflation depends on, as text."""
    law = constitutive(stuff)
    if isinstance(law, Scaled):
        return (law.static.tobytes() + law.reference.tobytes()).hex()
    return stuff.model_dump_json()  # plies: their loss stands in the deformed parts too


def _refused(message: str) -> CaseError:
    return CaseError([Problem(("inflation", "pressure"), message)])
