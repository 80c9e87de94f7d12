"""Hold every solver against every other and write the page beside this.

    python docs/validation/make_accuracy.py [LINES]

LINES: how many lines, 12 by default. The page, accuracy.md, holds what was computed; nothing in it
is typed.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.sparse import hstack

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.case import Case, Isotropic, Solver, build_case, load_case, resolved
from tyrefrf.fem.assembly import assemble_cell
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.solvers import Cyclic, Field, Recursive, RingProblem, prepare
from tyrefrf.solvers import Solver as AnySolver
from tyrefrf.solvers.modal import Modal
from tyrefrf.solvers.modes import OrderModes, lowest, ring_modes
from tyrefrf.study.machine import machine
from tyrefrf.study.model import build_mesh, build_model

HERE = Path(__file__).parent
CASES = HERE.parents[1] / "cases"
BAND = (5.0, 2000.0)  # Hz
ALL_MODES = 10_000_000
PLAIN = "recursive, plain"
SOLVERS = {
    "recursive": Solver(name="recursive"),
    PLAIN: Solver(name="recursive"),
    "cyclic": Solver(name="cyclic"),
    "direct": Solver(name="direct"),
    "modal, all modes": Solver(name="modal", modes=ALL_MODES),
}
COUNTS = (250, 500, 1000, 2000, 4000)
CONVERGENCE = (100.0, 400.0, 1000.0)  # Hz


def main(n_lines: int) -> None:
    """Compute everything."""
    lines = np.geomspace(*BAND, n_lines)
    problems = {
        "Homogeneous": problem_of("homogeneous.toml"),
        "Layered, with steel": problem_of("paper/layered.toml"),
        "Inflated": problem_of("paper/figure08.toml"),
        "No symmetry, interior nodes": lopsided(),
    }
    page = [HEAD.format(machine=here(), plain=PLAIN, n=n_lines, low=BAND[0], high=BAND[1])]
    for title, (what, problem) in problems.items():
        page.append(f"## {title}\n\n{what}\n\n{proof(problem, lines)}")
    page.append(CONVERGENCE_HEAD)
    for title in ("Homogeneous", "Layered, with steel"):
        page.append(f"### {title}\n\n{convergence(problems[title][1])}")
    page.append(CALCULIX)
    (HERE / "accuracy.md").write_text("\n\n".join(page) + "\n", encoding="utf-8")
    print(HERE / "accuracy.md")


HEAD = """\
# Accuracy of the solvers

Every solver against every other, at every section of the whole tyre: the norm of the difference
of two solutions over a section's displacement (and over a cell's interior), relative to the norm
of that section's displacement at that line; the largest over all sections, loads and {n} lines
from {low:g} to {high:g} Hz. The residual is ||f - D q|| / ||f|| of the ring's equations.
Reciprocity is |H_12 - H_21| / sqrt |H_11 H_22| between the loads' places, passivity the lowest
Re Y / |Y| of all driving points, which is not to be negative. `{plain}` is the recursion as the
paper writes it, without symmetries and with one chain all around. `modal` has all modes of the
ring here, so that nothing is truncated; what fewer do stands below.

Made by `python docs/validation/make_accuracy.py` on {machine}."""

CONVERGENCE_HEAD = """\
## Modes superposed: how many are enough

Error of `modal` at the section that is driven, and at the opposite one, against `cyclic`; with
the modes alone, and with `static_correction`, under the radial load at mid-tread. "to" is the
frequency of the last mode."""

CALCULIX = """\
## Another program

The cell's matrices, static answers, natural frequencies, inflated states and frequency responses
are held against CalculiX's (a finite element program that shares nothing with this one) by
`tests/reference/`: `test_calculix_cell.py`, `test_calculix_static.py`, `test_calculix_modes.py`,
`test_calculix_inflation.py` and `test_calculix_frf.py`, with the tolerances that they assert.
`tests/solvers/test_every_solver.py` crosses every solver with every element, 1 to 64 cells, and
cells with and without symmetry and interior nodes, against a ring assembled in Cartesian
coordinates."""


def here() -> str:
    """Processor, versions and date."""
    known = machine()
    packages = ", ".join(
        f"{name} {known[name]}" for name in ("Python", "numpy", "scipy", "tyrefrf")
    )
    return f"{known['processor']}, {packages}, {datetime.now(UTC):%Y-%m-%d}"


def problem_of(name: str) -> tuple[str, RingProblem]:
    """A shipped case: what it is, and its ring."""
    case = load_case(CASES / name)
    problem = with_another_load(build_model(case).problem)
    return f"`cases/{name}`: {case.title}. {size(problem)}", problem


def with_another_load(problem: RingProblem) -> RingProblem:
    """The first probe that is no driving point is driven as well, for reciprocity."""
    first = problem.probes[:, [problem.n_loads]]
    return replace(problem, loads=hstack([problem.loads, first], format="csc"))


def size(problem: RingProblem) -> str:
    """Cells and dofs that move."""
    moving = problem.n_cells * int(problem.free.sum())
    return f"{problem.n_cells} cells, {moving} dofs that move."


def lopsided(seed: int = 1) -> tuple[str, RingProblem]:
    """The homogeneous tyre with two bricks around a cell, moved at random, of two materials."""
    case = with_interior(load_case(CASES / "homogeneous.toml"))
    model, mesh = build_model(case), build_mesh(case)
    rng = np.random.default_rng(seed)
    points = mesh.points.copy()
    inside = slice(mesh.n_face, mesh.n_own)
    points[inside] += rng.uniform(-1.0, 1.0, points[inside].shape) * [5e-4, 5e-4, 4e-3]
    mesh = replace(
        mesh,
        points=points,
        material=rng.permutation(np.arange(len(mesh.bricks)) % 2),
        materials=("soft", "hard"),
    )
    materials = {
        "soft": Isotropic(E=28e6, nu=0.45, rho=1100.0, eta=0.15),
        "hard": Isotropic(E=400e6, nu=0.3, rho=1500.0, eta=0.03),
    }
    cell = assemble_cell(mesh, materials, ELEMENTS[case.cell.element], case.damping)
    problem = with_another_load(replace(model.problem, cell=cell))
    what = (
        "`cases/homogeneous.toml` with two bricks around a cell, the nodes between them moved at "
        f"random in all directions, and every brick of one of two materials. {size(problem)}"
    )
    return what, problem


def with_interior(case: Case) -> Case:
    """A case with two bricks around a cell."""
    data = resolved(case)
    data["cell"] = {**data["cell"], "elements_around": 2}  # type: ignore[dict-item]
    return build_case(data, case.name)


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What one solver's fields say of themselves: the worst of all lines."""

    residual: float
    reciprocity: float
    passivity: float
    remarks: int

    @classmethod
    def of(cls, problem: RingProblem, omega: FloatArray, fields: list[Field]) -> Proof:
        """From the fields of all lines; omega [rad/s]."""
        H = np.array([driving(problem, field.q) for field in fields])
        drive = np.sqrt(np.abs(np.einsum("faa,fbb->fab", H, H)))
        Y = 1j * omega[:, None] * np.einsum("faa->fa", H)
        return cls(
            residual=max(field.residual for field in fields),
            reciprocity=float((np.abs(H - H.transpose(0, 2, 1)) / drive).max()),
            passivity=float((Y.real / np.abs(Y)).min()),
            remarks=sum(field.remark != "" for field in fields),
        )

    def columns(self) -> list[str]:
        """As they stand in the table."""
        numbers = (self.residual, self.reciprocity, self.passivity)
        return [*(f"{number:.1e}" for number in numbers), str(self.remarks)]


def driving(problem: RingProblem, q: ComplexArray) -> ComplexArray:
    """Receptances (n_loads, n_loads) [m/N] between the loads' own places."""
    return problem.loads.T @ q.reshape(problem.n_ring_dofs, -1)


def proof(problem: RingProblem, lines: FloatArray) -> str:
    """Both tables of one problem."""
    omega = 2.0 * np.pi * lines
    fields = {}
    for name in SOLVERS:
        solver = solver_of(name, problem)
        fields[name] = [solver.field(float(w)) for w in omega]
    pairs = [
        [f"`{a}` - `{b}`", f"{largest_difference(problem, fields[a], fields[b]):.1e}"]
        for a, b in combinations(SOLVERS, 2)
    ]
    own = [
        [f"`{name}`", *Proof.of(problem, omega, found).columns()] for name, found in fields.items()
    ]
    header = ["solver", "residual", "reciprocity", "passivity", "lines with a remark"]
    return table(["pair", "largest section error"], pairs) + "\n\n" + table(header, own)


def solver_of(name: str, problem: RingProblem) -> AnySolver:
    """A solver by its name in the tables."""
    if name == PLAIN:
        return Recursive(problem, symmetries=False, most_chains=1)
    return prepare(problem, SOLVERS[name])()


def largest_difference(problem: RingProblem, a: list[Field], b: list[Field]) -> float:
    """Of all lines, sections (and insides of cells) and loads."""
    n_face = problem.cell.n_face
    parts = [slice(0, n_face)] + ([slice(n_face, None)] if problem.cell.n_own > n_face else [])
    return max(
        float(section_errors(one.q[:, part], other.q[:, part]).max())
        for one, other in zip(a, b, strict=True)
        for part in parts
    )


def section_errors(q: ComplexArray, expected: ComplexArray) -> FloatArray:
    """(n_cells, n_loads): norms of the difference relative to those of what is expected."""
    return np.linalg.norm(q - expected, axis=1) / np.linalg.norm(expected, axis=1)


def convergence(problem: RingProblem) -> str:
    """Errors of truncated modes at the first load's section and opposite it."""
    driven = int(problem.loads[:, [0]].nonzero()[0][0]) // problem.cell.n_own
    sections = [driven, (driven + problem.n_cells // 2) % problem.n_cells]
    exact = Cyclic(problem)
    expected = [exact.field(2.0 * np.pi * hertz).q for hertz in CONVERGENCE]
    modes = ring_modes(problem.cell, problem.n_cells, count=max(COUNTS))
    rows = []
    for count in COUNTS:
        some = lowest(modes, count)
        for corrected in (False, True):
            solver = Modal(problem, some, static_correction=corrected)
            errors = [
                section_errors(solver.field(2.0 * np.pi * hertz).q, q)[sections, 0]
                for hertz, q in zip(CONVERGENCE, expected, strict=True)
            ]
            rows.append(
                [
                    f"{count}, to {last_frequency(some):.0f} Hz",
                    "corrected" if corrected else "alone",
                    *(f"{error:.1e}" for pair in errors for error in pair),
                ]
            )
    places = [f"{f:g} Hz, {where}" for f in CONVERGENCE for where in ("driven", "opposite")]
    return table(["modes", "", *places], rows)


def last_frequency(modes: tuple[OrderModes, ...]) -> float:
    """Of the highest mode [Hz]."""
    return max(float(m.omega[-1]) for m in modes if len(m.omega)) / (2.0 * np.pi)


def table(header: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 12)
