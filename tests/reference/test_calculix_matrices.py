"""CalculiX's own K and M of one cell, as its MATRIXSTORAGE files, against its own ring.

`frf_direct` of A_C3D8I: ring matrices assembled by ccx 2.20, (K (1 + 0.1 i) - omega^2 M) solved by
scipy. The very same matrices of one cell must give the very same responses: incompatible modes are
unknowns with mass there, that belong to no node. The deck gives nodes and sets; LEFT is at the
larger of our angles.
"""

from __future__ import annotations

import numpy as np
import pytest
from reference.calculix import FOLDER, N_CELLS, arrays, facts, needs_reference

from tyrefrf.case import Solver, load_case
from tyrefrf.solvers import prepare, solve_line
from tyrefrf.study.model import build_model

pytestmark = needs_reference

NAME = "A_C3D8I"
DIGITS = 1e-8  # entries and coordinates have 14 digits; 7e-10 is reached
LINES = slice(0, None, 7)  # 0 to 490 Hz
DIRECTIONS = {"radial": "r", "tangential": "theta", "axial": "y"}
SIGN = {"radial": 1.0, "tangential": -1.0, "axial": 1.0}  # their +theta is our -


def write_as_ccx(directory) -> None:
    """The cell's matrices in the format of ccx 2.20: upper triangle, column by column, from 1."""
    z = arrays(f"{NAME}_cellmat")
    for letter, ending in (("K", "sti"), ("M", "mas")):
        entries = zip(*(z[f"{letter}_{part}"] for part in ("row", "col", "val")), strict=True)
        lines = [f"{i + 1} {j + 1} {value:20.13e}\n" for i, j, value in entries]
        (directory / f"cell.{ending}").write_text("".join(lines))
    dofs = "".join(f"{node}.{direction}\n" for node, direction in z["dof"])
    (directory / "cell.dof").write_text(dofs)
    (directory / "cell.inp").write_text((FOLDER / f"{NAME}_cell.inp").read_text())


def points(kind: str, places) -> str:
    return "\n".join(
        f'[[{kind}]]\nname = "{name}"\nkind = "node"\nnode = {node}\nangle = {angle}\n'
        f'direction = "{direction}"\n'
        for name, node, angle, direction in places
    )


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    """The tyre of their cell, loads as theirs, probes at their nodes along r, y and theta."""
    directory = tmp_path_factory.mktemp("ccx")
    write_as_ccx(directory)
    info, z = facts(NAME)["info"], arrays(NAME)
    drive = info["drive_node"] + 1
    loads = [(name, drive, 0.0, DIRECTIONS[name]) for name in facts(NAME)["frf_direct"]["loads"]]
    cell, local = np.divmod(z["frf_direct_nodes"], info["nodes_left"] + info["nodes_interior"])
    angle = (-cell * 360.0 / N_CELLS) % 360.0
    probes = [
        (f"{k}.{direction}", local[k] + 1, angle[k], direction)
        for k in range(len(cell))
        for direction in ("r", "y", "theta")
    ]
    (directory / "cell.toml").write_text(f"""\
[matrices]
K = {{ file = "cell.sti", eta = 0.1 }}
M = "cell.mas"
dofs = "cell.dof"
nodes = "cell.inp"
units = "SI"
left = "LEFT"
right = "RIGHT"
rim = "RIM"

[cell]
sector_angle = {360.0 / N_CELLS}

[frequency]
values = [1.0]

{points("loads", loads)}
{points("probes", probes)}""")
    return build_model(load_case(directory / "cell.toml"))


@pytest.mark.parametrize("solver", ["recursive", "cyclic"])
def test_calculix_matrices_give_calculix_responses(model, solver):
    z = arrays(NAME)
    loads = facts(NAME)["frf_direct"]["loads"]
    theta = np.array([place.angle for place in model.probes[len(loads) :: 3]])
    c, s, o, i = np.cos(theta), np.sin(theta), 0.0 * theta, 0.0 * theta + 1.0
    local = np.array([[c, o, s], [o, i, o], [-s, o, c]])  # (local, xyz, node)
    sign = np.array([SIGN[load] for load in loads])
    made = prepare(model.problem, Solver.model_validate({"name": solver}))()

    errors = []
    for hertz, expected in zip(z["frf_direct_freq"][LINES], z["frf_direct"][LINES], strict=True):
        line = solve_line(model.problem, made, 2.0 * np.pi * hertz)
        q = line.receptance[len(loads) :].reshape(-1, 3, len(loads))
        u = np.einsum("xin,nxk->kni", local, q) * sign[:, None, None]
        errors.append(np.linalg.norm(u - expected, axis=-1) / np.linalg.norm(expected, axis=-1))

    assert np.max(errors) < DIGITS


def test_what_is_said_of_their_matrices(model):
    sound, facts_said = model.brought.soundness, " ".join(model.brought.facts)
    assert sound.translation < 1e-12
    assert sound.rotation < 1e-11
    assert sound.mass == pytest.approx([sound.mass[0]] * 3)
    assert sound.warnings() == ()
    assert "252 unknowns belong to no node" in facts_said  # 28 bricks, 9 each
    assert "upper triangle made whole" in facts_said
    assert "the other way round" in facts_said
