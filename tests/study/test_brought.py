"""The same tyre from its own matrices, as another program would bring them, is the same tyre.

A cell without any symmetry, of two materials with losses of their own, with viscous damping and a
geometric stiffness, is written to files in every style and read back. Every displacement of the
ring must be that of the ring it came from.
"""

import numpy as np
import pytest
from brought import Style, export, stressed
from rings import lopsided, omegas, section_error, skewed, tyre

from tyrefrf.case import Solver
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers import Cyclic, Direct, Recursive, prepare
from tyrefrf.solvers.symmetry import shares
from tyrefrf.study.model import Workshop, build_model

SAME = 1e-9  # of a section's displacement; 14 digits leave up to 1e-11
LINES = omegas(0.0, 60.0, 700.0)
EXACT = {"recursive": Recursive, "cyclic": Cyclic, "direct": Direct}

STYLES = {
    "CalculiX": Style(ending=".sti"),
    "CalculiX in mm, t, s": Style(ending=".sti", units="mm-t-s"),
    "Matrix Market in kN, mm, ms": Style(units="mm-kg-ms", listed=False),
    "scipy": Style(ending=".npz", axis="z"),
    "axle along x": Style(axis="x", units="mm-t-s", listed=False),
    "cylindrical": Style(directions="cylindrical", ending=".npz", nodes="r y theta"),
    "cylindrical in mm, t, s": Style(directions="cylindrical", units="mm-t-s", nodes="r y theta"),
    "elsewhere around the axle": Style(ending=".npz", start=np.deg2rad(163.0)),
}


@pytest.fixture(scope="module")
def lopsided_ring():
    """With nodes inside the cell, of quadratic bricks."""
    return stressed(lopsided(tyre("hex20", n_cells=12, elements_along=4)))


def displacements(model, numbers, solver, omega):
    """Of the nodes with these numbers in every cell (cells, dofs, loads)."""
    field = EXACT[solver](model.problem).field(omega)
    place = {number: k for k, number in enumerate(model.mesh.numbers)}
    order = [place.get(number, -1) for number in numbers]  # those that are gone are held
    n_cells, _, n_loads = field.q.shape
    q = field.q.reshape(n_cells, -1, 3, n_loads)
    q = np.concatenate([q, np.zeros_like(q[:, :1])], axis=1)
    return q[:, order].reshape(n_cells, -1, n_loads)


def expected(ring, solver, omega):
    load = ring.point_loads((0, ring.mesh.n_face // 2, 0))
    return EXACT[solver](ring.problem(load)).field(omega).q


def worst(ring, exported, solver, *changes):
    model = build_model(exported.case(*changes))
    own = exported.number[: ring.mesh.n_own]
    return max(
        section_error(
            displacements(model, own, solver, omega),
            expected(ring, solver, omega),
            3 * ring.mesh.n_face,
        )
        for omega in LINES
    )


@pytest.mark.parametrize("style", STYLES.values(), ids=STYLES)
def test_same_ring_from_its_matrices_in_every_style(lopsided_ring, style, tmp_path):
    assert worst(lopsided_ring, export(lopsided_ring, tmp_path, style), "cyclic") < SAME


@pytest.mark.parametrize("solver", EXACT)
@pytest.mark.parametrize("deform", [lopsided, skewed])
def test_same_ring_by_every_solver(deform, solver, tmp_path):
    ring = stressed(deform(tyre("hex8i", n_cells=9, elements_along=4, elements_around=2)))
    assert worst(ring, export(ring, tmp_path), solver) < SAME


def test_sections_named_the_other_way_round_are_exchanged_and_said(lopsided_ring, tmp_path):
    exported = export(lopsided_ring, tmp_path)
    (tmp_path / "left.txt").rename(tmp_path / "end.txt")
    (tmp_path / "right.txt").rename(tmp_path / "left.txt")
    (tmp_path / "end.txt").rename(tmp_path / "right.txt")
    assert worst(lopsided_ring, exported, "cyclic") < SAME
    facts = build_model(exported.case()).brought.facts
    assert any("the other way round" in fact for fact in facts)


@pytest.mark.parametrize("start", [0.0, 163.0])
def test_symmetries_are_found_wherever_the_cell_stands(start, tmp_path):
    """A revolved section that mirrors falls into two shares, and each chain mirrors too."""
    style = Style(start=np.deg2rad(start))
    ring = tyre("hex20", n_cells=12, elements_along=4)
    found = shares(build_model(export(ring, tmp_path, style).case()).problem.cell)
    assert [share.Q.shape for share in found] == [s.Q.shape for s in shares(ring.cell)]
    assert [share.n_even for share in found] == [s.n_even for s in shares(ring.cell)]
    assert len(found) == 2


def held(exported, ring):
    """Strike the rim's rows out of the matrices, as programs do that eliminate supports."""
    from scipy.io import mmread, mmwrite

    gone = np.sort(exported.rows[ring.mesh.rim].ravel())
    dofs = (exported.directory / "cell.dof").read_text().split()
    kept = np.setdiff1d(np.arange(len(dofs)), gone)
    (exported.directory / "cell.dof").write_text("\n".join(np.array(dofs)[kept]) + "\n")
    for path in exported.directory.glob("*.mtx"):
        mmwrite(path, mmread(path, spmatrix=False).tocsr()[kept][:, kept])


NO_HUB = ('[[probes]]\nkind = "hub"\n', "")


def test_rows_of_the_rim_may_be_gone_where_its_reaction_is_not_asked(lopsided_ring, tmp_path):
    exported = export(lopsided_ring, tmp_path)
    held(exported, lopsided_ring)
    assert worst(lopsided_ring, exported, "cyclic", NO_HUB) < SAME
    warnings = " ".join(build_model(exported.case(NO_HUB)).brought.warnings)
    assert "no rows for the rim" in warnings
    assert "springs to the ground" in warnings


def nameless(exported, ring, extra):
    """Take the coordinates of the nodes inside from their file; one oscillator more inside."""
    from scipy.io import mmread, mmwrite
    from scipy.sparse import block_diag

    inside = np.setdiff1d(np.arange(ring.mesh.n_face, ring.mesh.n_own), ring.mesh.rim)
    inside = set(exported.number[inside].astype(str))
    nodes = exported.directory / "nodes.csv"
    lines = [line for line in nodes.read_text().splitlines() if line.split(",")[0] not in inside]
    nodes.write_text("\n".join(lines) + "\n")
    if not extra:
        return
    with (exported.directory / "cell.dof").open("a") as file:
        file.write("999999.1\n")
    for path in exported.directory.glob("*.mtx"):
        value = {"K_rubber": 3e4, "M": 0.2}.get(path.stem, 0.0)
        mmwrite(path, block_diag([mmread(path, spmatrix=False), [[value]]]))


@pytest.mark.parametrize("extra", [0, 1])
@pytest.mark.parametrize("solver", EXACT)
def test_unknowns_without_a_node_stay_inside_the_cell(lopsided_ring, solver, extra, tmp_path):
    """What is not known to be a node may be anything: the sections move as before."""
    ring = lopsided_ring
    exported = export(ring, tmp_path)
    nameless(exported, ring, extra)
    model = build_model(exported.case())
    n_face = ring.mesh.n_face
    for omega in LINES:
        q = displacements(model, exported.number[:n_face], solver, omega)
        truth = expected(ring, solver, omega)[:, : 3 * n_face]
        assert section_error(q, truth, 3 * n_face) < SAME


def test_a_part_scaled_by_a_law_is_the_law_times_its_matrix(lopsided_ring, tmp_path):
    """A table of one modulus and one loss factor is that loss factor."""
    case = export(lopsided_ring, tmp_path).case(
        (
            "eta = 0.15 }",
            'modulus = { kind = "table", frequencies = [0.1, 9e3], E = [3e6, 3e6], '
            "eta = [0.15, 0.15], extrapolate = true } }",
        )
    )
    law = build_model(case).problem.cell
    plain = build_model(export(lopsided_ring, tmp_path).case()).problem.cell
    D, D_plain = (cell.dynamic_stiffness(900.0) for cell in (law, plain))
    np.testing.assert_allclose(D, D_plain, rtol=0.0, atol=1e-14 * abs(D).max())


def test_cases_that_differ_in_losses_alone_read_the_files_once(lopsided_ring, tmp_path):
    exported, workshop = export(lopsided_ring, tmp_path), Workshop()
    one, other = (workshop.model(exported.case(*c)) for c in ((), (("eta = 0.15", "eta = 0.2"),)))
    assert one.brought is other.brought
    K, K_lossy = (model.problem.cell.dynamic_stiffness(0.0) for model in (one, other))
    assert np.any(K_lossy != K)


def test_rayleigh_damping_comes_on_top_of_the_brought_one(lopsided_ring, tmp_path):
    exported = export(lopsided_ring, tmp_path)
    more = ("[frequency]", "[damping]\nalpha = 7.0\nbeta = 1e-5\n\n[frequency]")
    cell, damped = (build_model(exported.case(*c)).problem.cell for c in ((), (more,)))
    C = cell.C + 7.0 * cell.M + 1e-5 * sum(cell.K.values())
    np.testing.assert_allclose(damped.C, C, rtol=1e-14)


def test_the_load_acts_in_the_cell_nearest_to_its_angle(lopsided_ring, tmp_path):
    model = build_model(export(lopsided_ring, tmp_path).case())
    drive, far = model.loads[0], model.probes[1]
    assert (drive.kind, drive.surface, drive.angle) == ("node", "", 0.0)
    assert far.angle == pytest.approx(np.pi)
    assert drive.r == pytest.approx(lopsided_ring.mesh.points[lopsided_ring.mesh.n_face // 2, 0])


@pytest.mark.parametrize("wanted", [0.0, 30.0, 200.0])
def test_a_node_of_the_right_section_is_the_next_cells_left_one(lopsided_ring, wanted, tmp_path):
    exported = export(lopsided_ring, tmp_path)
    mesh = lopsided_ring.mesh
    pair = exported.number[[mesh.n_face // 2, mesh.n_own + mesh.n_face // 2]]
    left, right = (
        build_model(exported.case((f"node = {pair[0]}\ndir", f"node = {n}\nangle = {wanted}\ndir")))
        for n in pair
    )
    assert str(left.loads) == str(right.loads)  # their s is NaN
    np.testing.assert_array_equal(left.problem.loads.toarray(), right.problem.loads.toarray())


def test_mass_and_rigid_motions_are_found(lopsided_ring, tmp_path):
    sound = build_model(
        export(lopsided_ring, tmp_path, Style(units="mm-t-s")).case()
    ).brought.soundness
    mesh, cell = lopsided_ring.mesh, lopsided_ring.cell
    along = np.zeros(cell.n_dofs)
    along[1::3] = 1.0
    mass = lopsided_ring.n_cells * (along @ (cell.sparse(cell.M) @ along))
    np.testing.assert_allclose(sound.mass, mass, rtol=1e-12)
    assert max(sound.translation, sound.rotation) < 1e-13
    assert sound.warnings() == ()
    assert mesh.n_own > mesh.n_face


def test_parts_of_the_stiffness_are_the_materials_in_their_order(lopsided_ring, tmp_path):
    model = build_model(export(lopsided_ring, tmp_path).case())
    assert model.mesh.section.materials == tuple(model.problem.cell.K) == ("rubber", "tread")


def test_a_misnumbered_node_strains_under_rotation(lopsided_ring, tmp_path):
    """Translations cannot see that rows belong to other nodes; rotations do."""
    exported = export(lopsided_ring, tmp_path)
    inside = exported.number[lopsided_ring.mesh.n_face :][:2]
    dofs = tmp_path / "cell.dof"
    swap = {f"{inside[0]}": f"{inside[1]}", f"{inside[1]}": f"{inside[0]}"}
    lines = [line.split(".") for line in dofs.read_text().split()]
    dofs.write_text("\n".join(f"{swap.get(node, node)}.{k}" for node, k in lines) + "\n")
    sound = build_model(exported.case()).brought.soundness
    assert sound.translation < 1e-13
    assert sound.rotation > 1e-5
    assert "belong to other nodes" in sound.warnings()[0]


def test_solvers_know_nothing_of_where_matrices_came_from(lopsided_ring, tmp_path):
    case = export(lopsided_ring, tmp_path).case()
    model = build_model(case)
    assert isinstance(model.problem.cell, CellMatrices)
    assert callable(prepare(model.problem, Solver()))
