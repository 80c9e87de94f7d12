"""What does not fit among brought matrices is refused, and named."""

import re

import numpy as np
import pytest
from brought import export
from rings import lopsided, tyre
from scipy.io import mmread, mmwrite

from tyrefrf.errors import CaseError
from tyrefrf.study.model import build_model

RING = lopsided(tyre("hex8i", n_cells=9, elements_along=4, elements_around=2))

NO_RIM = ('rim = "rim.txt"\n', "")


@pytest.fixture
def exported(tmp_path):
    return export(RING, tmp_path)


def refused(exported, message, *changes):
    with pytest.raises(CaseError, match=message):
        build_model(exported.case(*changes))


def edit(exported, name, change):
    """Replace a text file by what `change` makes of its lines."""
    path = exported.directory / name
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")


def rewrite(exported, name, change):
    """Replace a matrix by what `change` makes of it."""
    path = exported.directory / f"{name}.mtx"
    mmwrite(path, change(mmread(path, spmatrix=False).tocsr()))


def numbers(exported, nodes):
    return exported.number[np.atleast_1d(nodes)].tolist()


def test_every_file_that_is_wrong_is_named_at_once(exported):
    (exported.directory / "M.mtx").write_text("no matrix")
    edit(exported, "left.txt", lambda lines: ["none"])
    with pytest.raises(CaseError) as found:
        build_model(exported.case())
    assert [problem.place for problem in found.value.problems] == ["matrices.M", "matrices.left"]


def test_matrices_of_different_sizes(exported):
    rewrite(exported, "M", lambda M: M[:-3, :-3])
    refused(exported, r"M\.mtx: M has 87 rows, but `dofs` says of 90")


def test_more_rows_than_nodes_have(exported):
    edit(exported, "nodes.csv", lambda lines: lines[:-1])
    message = r"K_rubber\.mtx: K\.rubber has 90 rows, but 29 nodes have 87; or say in `dofs`"
    refused(exported, message, ('dofs = "cell.dof"\n', ""))


def test_a_row_without_stiffness(exported):
    row = int(exported.rows[5, 2])

    def without(K):
        K = K.tolil()
        K[row] = 0.0
        K[:, row] = 0.0
        return K.tocsr()

    rewrite(exported, "K_rubber", without)
    rewrite(exported, "K_tread", without)
    node = exported.number[5]
    refused(exported, rf"row {row + 1} of K \(node {node}, direction 3\) has nothing on its diag")


def test_mass_and_stiffness_exchanged(exported):
    refused(
        exported,
        "M gives a mass of .* kg to a rigid translation; are K and M exchanged",
        ('M = "M.mtx"', 'M = "K_rubber.mtx"'),
    )


def test_a_mass_that_is_none(exported):
    rewrite(exported, "M", lambda M: -M)
    refused(exported, "M is no mass: some motion would have negative kinetic energy")


@pytest.mark.parametrize("units", ["mm-t-s", "mm-kg-ms"])
def test_units_that_no_tyre_has(exported, units):
    message = r"matrices: the tyre's mass .* kg/m3; is `units` that of the matrices"
    refused(exported, message, ('units = "SI"', f'units = "{units}"'))


def test_the_wrong_axle(exported):
    refused(exported, "falls on no node of the other section: .* the axis", ('"y"\n', '"z"\n'))


def test_the_wrong_angle(exported):
    message = r"turned by cell.sector_angle = 36 deg about the axle, falls on no node"
    refused(exported, message, ("sector_angle = 40.0", "sector_angle = 36.0"))


def test_sections_of_different_size(exported):
    edit(exported, "right.txt", lambda lines: lines[1:])
    refused(exported, "the left section has 10 nodes and the right one 9; they must be the same")


def test_a_node_in_both_sections(exported):
    shared = numbers(exported, 0)[0]
    edit(exported, "right.txt", lambda lines: [*lines[1:], str(shared)])
    refused(exported, f"node {shared} is in the left section and in the right one")


def test_a_moved_node(exported):
    number = numbers(exported, RING.mesh.n_own + 4)[0]

    def moved(lines):
        return [re.sub(f"^{number},", f"{number},1", line) for line in lines]  # x 0.2 is 10.2

    edit(exported, "nodes.csv", moved)
    refused(exported, "falls on no node of the other section: .* mm from node")


def test_a_rim_on_one_side_only(exported):
    right = numbers(exported, RING.mesh.rim[RING.mesh.rim >= RING.mesh.n_own])
    edit(exported, "rim.txt", lambda lines: [x for x in lines if int(x) != right[0]])
    refused(exported, rf"is on the rim, but {right[0]}, the same one cell further, is not")


def test_a_set_without_coordinates(exported):
    edit(exported, "rim.txt", lambda lines: [*lines, "5"])
    refused(exported, r"matrices\.rim: node 5 has no coordinates")


def test_rotations_as_unknowns(exported):
    edit(exported, "cell.dof", lambda lines: [lines[0].split(".")[0] + ".5", *lines[1:]])
    refused(exported, "row 1 is direction 5 of node .*; nodes have displacements 1, 2 and 3 only")


def test_rotations_of_the_first_node_of_the_file(exported):
    first = int((exported.directory / "nodes.csv").read_text().splitlines()[2].split(",")[0])
    row = int(exported.rows[np.flatnonzero(exported.number == first)[0], 0])
    edit(exported, "cell.dof", lambda x: [*x[:row], f"{first}.4", *x[row + 1 :]])
    refused(exported, rf"row {row + 1} is direction 4 of node {first}; nodes have displacements")


def test_a_node_held_off_the_rim(exported):
    """Rows may be gone only where the rim holds them."""
    node = 4
    row = int(exported.rows[node, 1])
    edit(exported, "cell.dof", lambda lines: lines[:row] + lines[row + 1 :])
    for name in ("K_rubber", "K_tread", "M", "C"):
        rewrite(exported, name, lambda A: A[np.arange(90) != row][:, np.arange(90) != row])
    number = numbers(exported, node)[0]
    refused(
        exported, f"node {number} has 2 rows of three in the matrices", ('K_G = "K_G.mtx"\n', "")
    )


def test_a_section_without_rows_off_the_rim(exported):
    """All three rows gone is no better."""
    rows = np.sort(exported.rows[4])
    kept = np.setdiff1d(np.arange(90), rows)
    edit(exported, "cell.dof", lambda lines: [lines[k] for k in kept])
    for name in ("K_rubber", "K_tread", "M", "C", "K_G"):
        rewrite(exported, name, lambda A: A[kept][:, kept])
    number = numbers(exported, 4)[0]
    refused(exported, f"node {number} has 0 rows of three in the matrices; only nodes on the rim")


def test_an_indefinite_stiffness(exported):
    rubber = mmread(exported.directory / "K_rubber.mtx", spmatrix=False)
    rewrite(exported, "K_G", lambda K_G: -1.3 * rubber)
    rewrite(exported, "K_tread", lambda K: 1e-3 * K)
    refused(exported, r"matrices\.K: the static stiffness is indefinite at circumferential order 0")


LOAD = "node = {}\ndirection"


@pytest.mark.parametrize(
    ("new", "message"),
    [
        ("node = 3\ndirection", r"loads\[0\]\.node: node 3 is not in the matrices"),
        (
            "s = 0.5\ndirection",
            r"loads\[0\]\.s: brought matrices have no surface; use kind = \"node",
        ),
        ('s = 0.5\nkind = "patch"\ndirection', r"loads\[0\]\.s: brought matrices have no surface"),
    ],
)
def test_places_that_matrices_do_not_have(exported, new, message):
    old = LOAD.format(numbers(exported, RING.mesh.n_face // 2)[0])
    refused(exported, message, (old, new))


def test_a_load_on_the_rim(exported):
    old = LOAD.format(numbers(exported, RING.mesh.n_face // 2)[0])
    new = LOAD.format(numbers(exported, RING.mesh.rim[0])[0])
    refused(exported, "'drive' lies on the rim, which is fixed; move it off the rim", (old, new))


def test_the_reaction_of_no_rim(exported):
    refused(
        exported,
        r"probes\[1\]\.kind: nothing is held; name .* matrices\.rim",
        NO_RIM,
    )


def test_a_free_tyre_is_no_unstable_one(exported):
    """Its rigid motions have no stiffness; that is not a negative one."""
    model = build_model(exported.case(NO_RIM, ('[[probes]]\nkind = "hub"\n', "")))
    assert not model.problem.cell.fixed.any()


def test_a_set_that_the_mesh_file_does_not_have(exported):
    r, y, theta = RING.mesh.points.T
    rows = zip(exported.number, r * np.cos(theta), y, r * np.sin(theta), strict=True)
    text = "*NODE, NSET=ALL\n" + "".join(
        f"{n}, {x:.17g}, {y:.17g}, {z:.17g}\n" for n, x, y, z in rows
    )
    text += "*ELEMENT, TYPE=C3D8\n1, " + ", ".join(map(str, exported.number[RING.mesh.bricks[0]]))
    (exported.directory / "cell.inp").write_text(text + "\n")
    refused(
        exported,
        r"matrices\.left: .*cell\.inp has no node set 'left\.txt'; there are ALL",
        ('nodes = "nodes.csv"', 'nodes = "cell.inp"'),
    )
