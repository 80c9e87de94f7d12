"""Wrong physics, put in by the doors that users have, and what the program says of it.

    PYTHONPATH=tests:. python -m faults.physics [--json]

A row for each: the fault, what was said, and whether that is right: an error or a warning that
names the fault, or, where there is a right answer, that answer, by a solution that is not the
program's. Exit status 1 where one is not right.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from brought import export, stressed
from command import tyrefrf_command
from rings import R, lossless, tyre
from scipy.io import mmread, mmwrite
from small import TEXT, case_with
from solvers.test_mechanism import hinged

import tyrefrf
from tyrefrf.case import Case
from tyrefrf.errors import TyreFRFError
from tyrefrf.results.proof import breaches
from tyrefrf.study.estimate import estimate

SOLVERS = ("recursive", "cyclic", "direct", "modal")
HZ = 2.0 * np.pi
SAME = 1e-6
"""Of the largest response: up to which an answer is the right one, with all that is lost on the
way of files and meshes. Lines that pass are better (`tyrefrf.results.proof.WRONG_AT_MOST`)."""


@dataclass(frozen=True, slots=True)
class Row:
    """A fault, what the program said, and whether that is right."""

    fault: str
    said: str
    right: bool


Fault = Callable[[], Row]
FAULTS: list[Fault] = []


def fault(make: Fault) -> Fault:
    """One of them."""
    FAULTS.append(make)
    return make


def rows() -> Iterator[Row]:
    """All faults, one after another."""
    return (make() for make in FAULTS)


def refused(what: str, act: Callable[[], object], *words: str) -> Row:
    """A fault that has no answer: all of the words must be in what is said."""
    try:
        act()
    except TyreFRFError as error:
        return Row(what, str(error), all(word in str(error) for word in words))
    return Row(what, "(nothing)", False)


def failed_line(what: str, results, line: int, *words: str) -> Row:
    """A line that has no answer, among others that have: its reason must hold the words."""
    said = results.remark[line]
    others = np.delete(results.solved, line)
    right = not results.solved[line] and others.all() and all(word in said for word in words)
    return Row(what, said or "(nothing)", bool(right))


def answered(what: str, found, expected, said: str = "") -> Row:
    """A line that has an answer, the expected one."""
    found, expected = np.asarray(found), np.asarray(expected)
    error = np.abs(found - expected).max() / np.abs(expected).max()
    said = f"answered, {error:.0e} from the truth" + (f"; {said}" if said else "")
    return Row(what, said, bool(error < SAME))


def warned(what: str, case: Case, *words: str) -> Row:
    """A fault that `check` warns of."""
    found = [w for w in estimate(case, 1).warnings if all(word in w for word in words)]
    return Row(what, "; ".join(found) or "(nothing)", bool(found))


def with_solver(case: Case, name: str) -> Case:
    """The case by another solver."""
    return case.model_copy(update={"solver": case.solver.model_copy(update={"name": name})})


def at(case: Case, *hertz: float) -> Case:
    """The case at other lines."""
    values = case.frequency.model_copy(update={"values": hertz})
    return case.model_copy(update={"frequency": values})


def run(case: Case):
    """Its results, in this process."""
    return tyrefrf.run(case, jobs=1)


def under(pressure: float, *changes: tuple[str, str], kind: str = "linear") -> Case:
    """The small tyre inflated."""
    table = f'[inflation]\npressure = {pressure}\nkind = "{kind}"\n\n[cell]'
    return case_with(("[cell]", table), *changes)


HEX20R = ('element = "hex8i"', 'element = "hex20r"')
SOFT = ('E = "80 MPa"', 'E = "2 MPa"')
UNDAMPED = ("eta = 0.1", "eta = 0.0")
ONE_LOAD = (TEXT[TEXT.index('[[loads]]\nname = "patch"') : TEXT.index("[[probes]]")], "")


# What no tyre stays in


@fault
def buckled_at_run() -> Row:
    return refused(
        "pressure beyond what the tyre bears",
        lambda: run(under(3e7)),
        "inflation.pressure: the tyre buckles",
        "order 0 (2 negative eigenvalues), 1 (2); it bears 2.765e+07 Pa",
    )


@fault
def buckled_at_the_command_line() -> Row:
    with TemporaryDirectory() as folder:
        case = Path(folder) / "tyre.toml"
        case.write_text(TEXT.replace("[cell]", '[inflation]\npressure = "300 bar"\n\n[cell]'))
        done = tyrefrf_command("run", "tyre.toml", cwd=folder)
    right = done.returncode == 2 and "tyre.toml:14: inflation.pressure: the tyre b" in done.stderr
    said = f"exit status {done.returncode}: {done.stderr.strip().splitlines()[-1]}"
    return Row("the same on the command line", said, right)


@fault
def buckled_in_a_sweep() -> Row:
    return refused(
        "a sweep that comes to such a pressure",
        lambda: tyrefrf.sweep(case_with(), {"pressure": [1e5, 3e7]}, jobs=1),
        "the tyre buckles under 3e+07 Pa",
    )


@fault
def buckled_at_its_static_moduli() -> Row:
    return refused(
        "E_static too soft for the pressure, E stiff enough",
        lambda: run(under(1.4e7, ("eta = 0.1", "eta = 0.1\nE_static = 3e7"))),
        "with the moduli for inflation",
    )


@fault
def inside_out() -> Row:
    return refused(
        "nonlinear inflation beyond the limit point (forces balance with bricks inside out)",
        lambda: run(under(1e5, HEX20R, SOFT, kind="nonlinear")),
        "no equilibrium found beyond 9.7",
    )


@fault
def strained() -> Row:
    return warned(
        "linear inflation with strains that are not small",
        under(3e6),
        "the linear inflation strains the tyre",
    )


def _brought(ring, *changes: tuple[str, str], edit=lambda exported: None) -> Case:
    """A ring's matrices from files; the directory is kept as long as this process."""
    folder = TemporaryDirectory()
    _KEPT.append(folder)
    exported = export(ring, Path(folder.name))
    edit(exported)
    return exported.case(*changes)


_KEPT: list[TemporaryDirectory] = []
FREE = (('rim = "rim.txt"\n', ""), ('[[probes]]\nkind = "hub"\n', ""))


def _ring(n_cells: int = 9):
    return lossless(tyre("hex8i", n_cells, 4, 2))


@fault
def compressed() -> Row:
    return refused(
        "brought K_G that compresses the tyre",
        lambda: run(_brought(stressed(replace(_ring()), -1.25))),
        "matrices.K: the static stiffness is indefinite at circumferential order 0",
        "it bears 0.8 of K_G",
    )


@fault
def no_mass() -> Row:
    def edit(exported):
        path = exported.directory / "M.mtx"
        M = mmread(path, spmatrix=False).tolil()
        i, j, k = exported.rows[[14, 15, 12], 0]
        for a, b in ((i, j), (j, k), (i, k)):
            M[a, b] = M[b, a] = -0.9 * np.sqrt(M[a, a] * M[b, b])
        mmwrite(path, M.tocsr())

    return refused(
        "brought M with a negative kinetic energy",
        lambda: run(_brought(_ring(), edit=edit)),
        "matrices.M: M is no mass: some motions of circumferential order",
    )


# What nothing holds


@fault
def free_at_0_hz() -> Row:
    case = at(_brought(_ring(), *FREE), 0.0, 60.0)
    found = [run(with_solver(case, name)) for name in SOLVERS]
    words = ("0 Hz: nothing holds the tyre: 6 rigid motions (translation along x, ",)
    each = [failed_line("a free tyre at 0 Hz, by every solver", r, 0, *words) for r in found]
    return replace(each[0], right=all(row.right for row in each))


@fault
def free_is_said_beforehand() -> Row:
    return warned("the same, before it is run", _brought(_ring(), *FREE), "nothing holds the tyre")


@fault
def free_near_0_hz() -> Row:
    ring = _ring()
    case = at(_brought(ring, *FREE), 1e-3, 0.01)
    results = [run(with_solver(case, name)) for name in SOLVERS]
    found = [r.driving_point("drive", "receptance") for r in results]
    node = ring.mesh.n_face // 2
    free = ring.with_free_rim()
    T, M = free.to_cartesian, free.cartesian.M
    x = np.stack(_places(free), axis=1)
    motions = [np.tile(axis, (len(x), 1)) for axis in np.eye(3)]
    motions += [np.cross(axis, x) for axis in np.eye(3)]
    body = np.array([motion.ravel() for motion in motions]).T
    f = body.T @ (T @ free.columns({free.dof(0, node, R): 1.0}).toarray())
    compliance = float((f.T @ np.linalg.solve(body.T @ (M @ body), f))[0, 0])
    expected = [[-compliance / (HZ * hertz) ** 2 for hertz in (1e-3, 0.01)]] * len(SOLVERS)
    return answered("a free tyre at 0.001 and 0.01 Hz", found, expected, results[0].remark[0])


def _places(ring):
    """x, y, z of all nodes of a ring."""
    own, cells = ring.mesh.points[: ring.mesh.n_own], np.arange(ring.n_cells)
    theta = (own[:, 2] + cells[:, None] * ring.mesh.sector_angle).ravel()
    r, y = (np.tile(own[:, k], ring.n_cells) for k in (0, 1))
    return r * np.cos(theta), y, r * np.sin(theta)


@fault
def hanging_by_an_edge() -> Row:
    ring = hinged(0.1)
    results = run(at(_brought(ring), 0.0, 60.0, 220.0))
    row = failed_line(
        "a block of tread that hangs by one edge, at 0 Hz",
        results,
        0,
        "the tyre is a mechanism: motions of order 0 (1), 1 (1), 2 (1), 3 (1)",
    )
    node = ring.mesh.n_face // 2
    q, _ = ring.cartesian.solve(HZ * 60.0, ring.point_loads((0, node, R)))
    H = results.driving_point("drive", "receptance")[1]
    other = answered("", H, q[0, 3 * node + R, 0])
    return replace(row, said=f"{row.said}; 60 Hz: {other.said}", right=row.right and other.right)


# Zero frequency


@fault
def static() -> Row:
    """E (1 + i eta) at 0 Hz, against the ring in Cartesian coordinates by itself."""
    ring = tyre("hex8i", 15, 8)
    case = at(_brought(ring, ('[[probes]]\nkind = "hub"\n', "")), 0.0)
    node = ring.mesh.n_face // 2
    q, _ = ring.cartesian.solve(0.0, ring.point_loads((0, node, R)))
    results = [run(with_solver(case, name)) for name in SOLVERS[:3]]
    found = [r.driving_point("drive", "receptance")[0] for r in results]
    row = answered("0 Hz, a held tyre", found, [q[0, 3 * node + R, 0]] * 3)
    sound = all(np.all(r.mobility == 0.0) and not breaches(r) for r in results)
    return replace(row, said=f"{row.said}; mobility 0, no breach", right=row.right and sound)


@fault
def below_a_table() -> Row:
    law = '{ kind = "table", frequencies = [1.0, 1e3], E = [4e7, 9e7], eta = [0.2, 0.3] }'
    stuff = 'E = "80 MPa"\nnu = 0.42\nrho = 1200.0\neta = 0.1'
    return refused(
        "0 Hz, below a table of moduli",
        lambda: run(case_with((stuff, f"nu = 0.42\nrho = 1200.0\nmodulus = {law}"))),
        "the frequency line 0 Hz is below the table",
    )


# Undamped resonances


@cache
def _modes():
    return tyrefrf.modes(case_with(UNDAMPED), count=20)


@fault
def on_a_resonance() -> Row:
    """Every one of the lowest modes, to the last digit, by every solver."""
    found = _modes()
    rows = []
    for k in (0, 2, 5):
        f, h = float(found.frequency[k]), int(found.order[k])
        for name in SOLVERS:
            results = run(with_solver(at(case_with(UNDAMPED), f / 2.0, f), name))
            words = (f"order {h} ",) if name == "modal" else (f"circumferential order {h} ",)
            rows.append(failed_line("a line on an undamped resonance", results, 1, *words))
    return replace(rows[0], right=all(row.right for row in rows))


@fault
def on_an_unseen_resonance() -> Row:
    """A radial load in the middle plane does not excite motions that are odd about it."""
    found = _modes()
    rows = []
    for k in range(6):
        results = run(at(case_with(UNDAMPED, ONE_LOAD), 20.0, float(found.frequency[k])))
        words = f"circumferential order {int(found.order[k])} "
        rows.append(failed_line("the same, of a mode that no load excites", results, 1, words))
    return replace(rows[0], right=all(row.right for row in rows))


@fault
def with_a_loss_of_nothing() -> Row:
    f = float(_modes().frequency[0])
    results = run(at(case_with(("eta = 0.1", "eta = 1e-13")), 20.0, f))
    return failed_line("the same with a loss factor of 1e-13", results, 1, "undamped resonance")


@fault
def beside_a_resonance() -> Row:
    """1e-6 beside it, recursion and direct, which share nothing."""
    f = float(_modes().frequency[0]) * (1.0 + 1e-6)
    found = [run(with_solver(at(case_with(UNDAMPED), f), name)) for name in ("recursive", "direct")]
    row = answered("1e-6 beside an undamped resonance", *(r.receptance for r in found))
    return replace(row, right=row.right and all(r.solved.all() for r in found))


@fault
def damped_on_a_resonance() -> Row:
    f = float(_modes().frequency[0])
    found = [run(with_solver(at(case_with(), f), name)) for name in ("recursive", "direct")]
    return answered("the same line with damping", *(r.receptance for r in found))


@fault
def a_chain_resonates() -> Row:
    """Two cells with held ends: natural frequency of a matrix that the recursion factorises."""
    ring = lossless(tyre("hex8i", 15, 8))
    cell, n = ring.cell, ring.cell.n_face
    free = np.flatnonzero(~cell.fixed[:n])
    K, M = (cell.sparse(a).toarray() for a in (sum(cell.K.values()), cell.M))
    middle = [(A[n:, n:] + A[:n, :n])[np.ix_(free, free)] for A in (K, M)]
    squared = np.linalg.eigvals(np.linalg.solve(middle[1], middle[0])).real
    f = float(np.sqrt(np.sort(squared)[0]) / HZ)
    case = at(case_with(UNDAMPED), f)
    found = [run(with_solver(case, name)) for name in ("recursive", "direct")]
    row = answered("a chain of two cells resonates on the line", *(r.receptance for r in found))
    said = found[0].remark[0]
    return replace(row, said=f"{row.said}; {said or 'by the recursion itself'}")


# Digits


@fault
def one_cell() -> Row:
    """The tyre in one cell of 360 degrees, and in 60 of 6."""
    hexes = ("sector_angle = 24.0", "sector_angle = {}\nelements_around = {}")
    cases = [at(case_with((hexes[0], hexes[1].format(360.0 / n, 60 // n))), 40.0) for n in (60, 1)]
    found = [run(case).receptance[0] for case in cases]
    return answered("one cell of 360 degrees", found[1], found[0])


@fault
def thin_cells() -> Row:
    """10000 cells of 0.036 degrees with one element, and 2000 with five: the same ring."""
    coarse = ("elements_along = 8", "elements_along = 4")
    cases = [
        at(
            case_with(
                coarse, ("sector_angle = 24.0", f"sector_angle = {a}\nelements_around = {k}")
            ),
            40.0,
        )
        for a, k in ((0.036, 1), (0.18, 5))
    ]
    found = [run(case) for case in cases]
    row = answered("cells of 0.036 degrees", *(r.receptance[0] for r in found))
    return replace(row, right=row.right and not breaches(found[0]))


THIN = "\n".join(
    f"thickness.{region} = 1e-6" for region in ("crown", "shoulder", "sidewall", "bead")
)


@fault
def thin_walls() -> Row:
    case = case_with(("[geometry]\n", f"[geometry]\n{THIN}\n"))
    return warned("walls of a micrometre, before the run", case, "rounding alone may move")


@fault
def thin_walls_at_run() -> Row:
    results = run(at(case_with(("[geometry]\n", f"[geometry]\n{THIN}\n")), 0.0))
    said = results.remark[0] or "; ".join(breaches(results)) or "(nothing)"
    return Row("walls of a micrometre at 0 Hz", said, "residual" in said)


@fault
def unlike() -> Row:
    belt = 'elements_through = 2\nbelt = { material = "steel", thickness = "3 mm" }\n'
    steel = '[materials.steel]\nE = "200 GPa"\nnu = 0.3\nrho = 7800.0\n\n[cell]'
    case = case_with(
        ("[geometry]\n", f"[geometry]\n{belt}"), ("[cell]", steel), ('E = "80 MPa"', "E = 30.0")
    )
    results = run(at(case, 0.0, 40.0))
    return failed_line("steel in rubber of 30 Pa", results, 0, "too few digits", "too unlike")


def main(arguments: list[str]) -> int:
    """Print all rows, as a table or as JSON; 1 where one is not right."""
    found = list(rows())
    if "--json" in arguments:
        print(json.dumps([asdict(row) for row in found], indent=1))
    else:
        for row in found:
            print(f"{'right' if row.right else 'WRONG':6} {row.fault}\n       {row.said}")
        print(f"{sum(row.right for row in found)} of {len(found)} right")
    return int(not all(row.right for row in found))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
