"""How many digits are left of thin cells and wide ones, thin walls, and steel beside soft rubber.

A tyre of N elements around is N cells, or N / k of k elements: the same ring, cut in other ways.
What is lost in the matrices and in their solution is measured against 80-bit numbers, which have
the matrices by the elements' own formulas. A line that passes its proof is right to WRONG_AT_MOST.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from extended import HAS_MORE_DIGITS, ExtendedRing
from rings import PAPER, THETA, UNDAMPED, R, Ring, tyre, with_steel_belt
from small import case_with

from tyrefrf.case import Geometry, Isotropic
from tyrefrf.case.geometry import Thickness
from tyrefrf.errors import SolveError
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.mesh.cell import revolve
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.results.proof import AMPLIFICATION, RESIDUAL_LIMIT, WRONG_AT_MOST
from tyrefrf.solvers import SOLVERS, solve_field, solve_line
from tyrefrf.solvers.digits import MANY, rounding_moves, too_few_digits
from tyrefrf.study.estimate import estimate

HZ = 2.0 * np.pi
extended = pytest.mark.skipif(not HAS_MORE_DIGITS, reason="longdouble is no more than double here")
REGIONS = ("crown", "shoulder", "sidewall", "bead")


def with_walls(share: float, n_cells: int = 60) -> Ring:
    """The homogeneous tyre with all walls so much thinner."""
    usual = Thickness()
    thickness = Thickness(**{region: share * getattr(usual, region) for region in REGIONS})
    geometry = Geometry(elements_along=4, material="rubber", thickness=thickness)
    section = tyre_section(geometry, quadratic=False)
    mesh = revolve(section, 2.0 * np.pi / n_cells, 1)
    return Ring(mesh, {"rubber": PAPER}, ELEMENTS["hex8i"], n_cells, UNDAMPED)


def with_rubber(E: float, n_cells: int = 60) -> Ring:
    """A belt of steel in rubber of that modulus [Pa]."""
    ring = with_steel_belt(tyre("hex8i", n_cells, 6))
    rubber = Isotropic(E=E, nu=0.45, rho=1100.0, eta=0.1)
    return replace(ring, materials={**ring.materials, "rubber": rubber})


MADE = {
    "360 cells": lambda: tyre("hex8i", 360, 4),
    "2400 cells": lambda: tyre("hex8i", 2400, 4),
    "24000 cells": lambda: tyre("hex8i", 24_000, 4),
    "B-bar, 2400 cells": lambda: tyre("hex8", 2400, 4),
    "quadratic": lambda: tyre("hex20", 24, 4),
    "reduced": lambda: tyre("hex20r", 120, 4),
    "walls of 0.1 mm": lambda: with_walls(1e-2),
    "walls of 10 um": lambda: with_walls(1e-3),
    "walls of 1 um": lambda: with_walls(2e-4),
    "steel, 28 MPa": lambda: with_rubber(28e6),
    "steel, 1 kPa": lambda: with_rubber(1e3),
    "steel, 10 Pa": lambda: with_rubber(10.0),
    "steel, 2400 cells": lambda: with_rubber(28e6, 2400),
    "steel, 12000 cells": lambda: with_rubber(28e6, 12_000),
}
LOSES_TOO_MUCH = {"walls of 10 um", "walls of 1 um", "steel, 1 kPa", "steel, 10 Pa",
                  "steel, 12000 cells"}  # fmt: skip
"""At 0 Hz: its lines breach their proof, or fail, and `check` says so beforehand."""


NAMES = [
    pytest.param(name, marks=[pytest.mark.long] if "000 cells" in name else []) for name in MADE
]


@cache
def made(name: str) -> Ring:
    return MADE[name]()


@cache
def truth(name: str, hertz: float, dof: int) -> np.ndarray:
    """(2, n_own) the driven cell and the one across."""
    ring = made(name)
    across = ring.n_cells // 2
    return ExtendedRing(ring).sections(HZ * hertz, dof, (0, across)).astype(complex)


def driven(ring: Ring, direction: int) -> int:
    """Dof of the outermost node of the first section."""
    return 3 * int(np.argmax(ring.mesh.points[: ring.mesh.n_face, 0])) + direction


def answer(ring: Ring, solver: str, hertz: float, dof: int):
    """Driven cell and the one across, and the residual; None where the line fails."""
    problem = ring.problem(ring.columns({dof: 1.0}))
    try:
        field = solve_field(problem, SOLVERS[solver](problem), HZ * hertz)
    except SolveError:
        return None, np.inf
    return field.q[[0, ring.n_cells // 2], :, 0], field.residual


@extended
@pytest.mark.parametrize("hertz", [0.0, 30.0, 300.0])
@pytest.mark.parametrize("direction", [R, THETA])
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("solver", ["recursive", "cyclic"])
def test_a_line_that_passes_is_right_and_the_residual_tells_of_others(
    solver, name, direction, hertz
):
    ring = made(name)
    dof = driven(ring, direction)
    q, residual = answer(ring, solver, hertz, dof)
    if hertz == 0.0 and name in LOSES_TOO_MUCH:
        assert residual > RESIDUAL_LIMIT
    if q is None:
        return
    expected = truth(name, hertz, dof)
    lack = np.linalg.norm(q - expected, axis=1)
    size = np.linalg.norm(expected, axis=1)
    assert lack.max() < AMPLIFICATION * residual * size.max()
    if residual <= RESIDUAL_LIMIT:
        assert lack.max() < 0.1 * WRONG_AT_MOST * size.max()
        assert (lack < WRONG_AT_MOST * size).all()


@pytest.mark.long
@extended
@pytest.mark.parametrize("hertz", [0.0, 100.0])
def test_the_thinnest_cells_there_are(hertz):
    """0.0036 degrees, 0.017 mm around the tread."""
    ring = tyre("hex8i", 100_000, 4)
    dof = driven(ring, R)
    expected = ExtendedRing(ring).sections(HZ * hertz, dof, (0, 50_000)).astype(complex)
    for solver in ("recursive", "cyclic"):
        q, residual = answer(ring, solver, hertz, dof)
        lack, size = np.linalg.norm(q - expected, axis=1), np.linalg.norm(expected, axis=1)
        assert residual < RESIDUAL_LIMIT
        assert lack.max() < AMPLIFICATION * residual * size.max()
        assert (lack < WRONG_AT_MOST * size).all()


@extended
@pytest.mark.parametrize("name", [name for name in MADE if "24000" not in name])
def test_what_rounding_moves_is_known_before_a_line_is_solved(name):
    """From above, by up to two orders of magnitude."""
    ring = made(name)
    dof = driven(ring, R)
    problem = ring.problem(ring.columns({dof: 1.0}))
    q = SOLVERS["cyclic"](problem).field(0.0).q[0, :, 0]
    expected = truth(name, 0.0, dof)[0]
    error = np.linalg.norm(q - expected) / np.linalg.norm(expected)
    assert 1.0 < rounding_moves(problem) / error < 300.0
    assert bool(too_few_digits(problem)) == (rounding_moves(problem) > MANY)
    if name in LOSES_TOO_MUCH - {"walls of 10 um"}:
        assert too_few_digits(problem)


AROUND = 60
CUTS = [1, 2, 3, 12, 30, 60]


@pytest.mark.parametrize("hertz", [0.0, 30.0, 300.0])
@pytest.mark.parametrize("n_cells", CUTS)
@pytest.mark.parametrize("steel", [False, True], ids=["homogeneous", "steel belt"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_same_ring_in_one_cell_or_in_many(solver, steel, n_cells, hertz):
    """From 360 degrees with all elements around in one cell to 6 degrees with one in each."""
    fields = []
    for n in (AROUND, n_cells):
        ring = tyre("hex8i", n, 4, AROUND // n)
        ring = with_steel_belt(ring) if steel else ring
        problem = ring.problem(ring.columns({driven(ring, R): 1.0}))
        name = "direct" if n == AROUND else solver
        field = solve_field(problem, SOLVERS[name](problem), HZ * hertz)
        fields.append(field.q[:, : ring.cell.n_face, 0])
    expected, q = fields[0][:: AROUND // n_cells], fields[1]
    lack = np.linalg.norm(q - expected, axis=1) / np.linalg.norm(expected, axis=1)
    assert lack.max() < (1e-8 if steel else 1e-10)


def test_a_line_with_too_few_digits_says_why():
    ring = made("steel, 10 Pa")
    problem = ring.problem(ring.columns({driven(ring, R): 1.0}))
    message = (
        r"^0 Hz: no trustworthy solution \(residual .*\); too few digits are left: rounding alone "
        r"may move the answer at 0 Hz by 1e-03 of it: cells \(.* mm around the tread\) or walls "
        "are too thin, or materials too unlike"
    )
    with pytest.raises(SolveError, match=message):
        solve_line(problem, SOLVERS["recursive"](problem), 0.0)


def test_check_says_of_thin_walls_what_they_cost():
    thin = "\n".join(f"thickness.{region} = 1e-6" for region in REGIONS)
    thin = ("[geometry]\n", f"[geometry]\n{thin}\n")
    found = estimate(case_with(thin), 1).warnings
    assert any("rounding alone may move the answer at 0 Hz by" in warning for warning in found)
    assert not any("rounding" in warning for warning in estimate(case_with(), 1).warnings)


def test_a_free_tyre_has_no_static_answer_to_move():
    ring = tyre("hex8i", 12, 4).with_free_rim()
    problem = ring.problem(ring.columns({driven(ring, R): 1.0}))
    assert np.isnan(rounding_moves(problem))
    assert too_few_digits(problem) == ()
