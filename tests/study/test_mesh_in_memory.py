"""A mesh in memory is the mesh of the file that meshlane writes of it."""

from __future__ import annotations

from types import SimpleNamespace

import meshlane
import numpy as np
import pytest
from small import TEXT, case_with

import tyrefrf
from tyrefrf.case import Case, case_hash, make_grid, parse_case
from tyrefrf.errors import CaseError, MeshError
from tyrefrf.study.certify import plan_certificate
from tyrefrf.study.estimate import estimate
from tyrefrf.study.model import build_mesh
from tyrefrf.study.run import run_case

SAME = 1e-9  # of the largest response: a solve whose condition is some 1e6, in another order
BUILT_IN = '[geometry]\nelements_along = 8\nmaterial = "rubber"\n'
LINES = ("values = [0.0, 40.0, 150.0, 420.0]", "values = [40.0, 150.0]")
FROM_MESH = """\
[mesh]
file = "tyre.vtu"
kind = "section"
unit = "mm"
axis = "z"
rim = "RIM"
materials = { TYRE = "rubber" }
"""


def from_mesh(*changes: tuple[str, str]) -> Case:
    return case_with((BUILT_IN, FROM_MESH), LINES, *changes)


def drawn(**more):
    """The small tyre's section in millimetres with the axle along z, as meshlane has it."""
    section = build_mesh(case_with()).section
    r, y = 1e3 * section.points.T
    parts = {
        "points": np.stack([r, np.zeros_like(r), y], axis=1),
        "cells": [("quad", section.quads)],
        "point_sets": {"RIM": section.rim},
        "cell_sets": {"TYRE": [np.arange(len(section.quads))]},
    }
    return meshlane.Mesh(**(parts | more))


def test_the_built_in_tyre_taken_from_memory_answers_as_it_does():
    held = tyrefrf.run(tyrefrf.with_mesh(from_mesh(), drawn()), jobs=1)
    own = run_case(case_with(LINES), jobs=1)
    error = np.abs(held.receptance - own.receptance).max()
    assert error < SAME * np.abs(own.receptance).max()


def test_a_case_file_is_taken_by_its_path(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(TEXT.replace(BUILT_IN, FROM_MESH))
    case = tyrefrf.with_mesh(path, drawn())
    assert case.directory == tmp_path
    assert build_mesh(case).section.n_elements == 8


def test_neither_library_is_needed():
    mesh = drawn()
    names = ("points", "point_sets", "cell_sets", "cell_data", "field_data")
    plain = SimpleNamespace(
        cells=[SimpleNamespace(type=block.type, data=block.data) for block in mesh.cells],
        **{name: getattr(mesh, name) for name in names},
    )
    one, other = (tyrefrf.with_mesh(from_mesh(), each) for each in (mesh, plain))
    assert case_hash(one) == case_hash(other)


def test_a_sweep_a_certificate_and_an_estimate_take_the_same_mesh():
    case = tyrefrf.with_mesh(from_mesh(), drawn())
    grid = make_grid(case, {"E_rubber": (8e7,)})
    (point,) = tyrefrf.sweep(case, {"E_rubber": [8e7]}, jobs=1).points
    results = tyrefrf.run(case, jobs=1)
    assert case_hash(grid.cases[0]) == case_hash(case)
    assert np.array_equal(point.receptance, results.receptance)
    refined = plan_certificate(case, results).refined
    assert refined is not None
    assert refined.problem.n_cells == 2 * case.cell.n_cells
    assert "tyre.vtu: 18 nodes, 8 quad" in estimate(case, jobs=1).mesh_file[0]


def test_solvers_in_processes_of_their_own_take_it_too():
    case = tyrefrf.with_mesh(from_mesh(), drawn())
    found = tyrefrf.compare(case, ["cyclic", "recursive"], lines=1)
    assert np.nanmax(found.difference) < SAME


def with_moved_point(mesh):
    mesh.points[5, 0] += 1e-6


def with_other_cells(mesh):
    mesh.cells[0].data[[0, 1]] = mesh.cells[0].data[[1, 0]]


def with_other_set(mesh):
    mesh.point_sets["RIM"] = mesh.point_sets["RIM"][:-1]


def with_other_name(mesh):
    mesh.cell_sets["TREAD"] = mesh.cell_sets["TYRE"]


@pytest.mark.parametrize(
    "change", [with_moved_point, with_other_cells, with_other_set, with_other_name]
)
def test_whatever_is_in_the_mesh_counts_in_the_hash(change):
    mesh = drawn()
    case = tyrefrf.with_mesh(from_mesh(), mesh)
    before = case_hash(case)
    change(mesh)
    assert case_hash(case) == before  # it was copied
    assert case_hash(tyrefrf.with_mesh(from_mesh(), mesh)) != before


def test_the_order_of_sets_does_not_count():
    rim = drawn().point_sets["RIM"]
    one, other = {"RIM": rim, "A": rim}, {"A": rim, "RIM": rim}
    hashes = [case_hash(tyrefrf.with_mesh(from_mesh(), drawn(point_sets=s))) for s in (one, other)]
    assert hashes[0] == hashes[1]


def test_a_case_without_a_mesh_table_says_what_it_is_for():
    with pytest.raises(CaseError, match="mesh: missing; it says what the mesh's unit"):
        tyrefrf.with_mesh(case_with(), drawn())


@pytest.mark.parametrize(
    ("mesh", "words"),
    [
        ("section.inp", "tyre.vtu: is no mesh as meshio.Mesh is one: .*'points'"),
        (drawn(cells=[], cell_sets={}), "tyre.vtu: holds no elements"),
        (drawn(points=np.full((18, 3), np.nan)), "tyre.vtu: a point is not finite"),
        (
            drawn(cells=[("quad", np.full((8, 4), 18))]),
            "tyre.vtu: cells of quad: no point is 18; there are 0 to 17",
        ),
        (
            drawn(point_sets={"RIM": np.array([0, -1])}),
            "tyre.vtu: point set 'RIM': no point is -1; there are 0 to 17",
        ),
        (
            drawn(cell_sets={"TYRE": [np.array([8])]}),
            "tyre.vtu: cell set 'TYRE': no quad of its block is 8; there are 0 to 7",
        ),
    ],
)
def test_what_is_no_mesh_is_refused(mesh, words):
    with pytest.raises(MeshError, match=words):
        tyrefrf.with_mesh(from_mesh(), mesh)


def test_what_does_not_fit_the_case_is_said_as_of_a_file():
    case = tyrefrf.with_mesh(from_mesh(('rim = "RIM"', 'rim = "RIMS"')), drawn())
    with pytest.raises(CaseError, match=r"mesh\.rim: tyre\.vtu has no node set 'RIMS'"):
        build_mesh(case)
    with pytest.raises(MeshError, match=r"is the unit mm\?"):
        build_mesh(tyrefrf.with_mesh(from_mesh(('unit = "mm"', 'unit = "m"')), drawn()))


def test_a_file_of_the_same_mesh_is_the_same_tyre(tmp_path):
    mesh = drawn()
    ends = np.array([[node, node] for node in mesh.point_sets["RIM"]])
    tagged = meshlane.Mesh(
        mesh.points,
        [("line", ends), ("quad", mesh.cells[0].data)],
        cell_data={
            "gmsh:physical": [np.full(len(ends), 1), np.full(8, 2)],
            "gmsh:geometrical": [np.full(len(ends), 1), np.full(8, 2)],
        },
        field_data={"RIM": np.array([1, 1]), "TYRE": np.array([2, 2])},
    )
    tagged.write(tmp_path / "tyre.msh", file_format="gmsh22", binary=False)
    text = TEXT.replace(BUILT_IN, FROM_MESH.replace("tyre.vtu", "tyre.msh"))
    of_file = build_mesh(parse_case(text, "small.toml", "small").beside(tmp_path))
    held = build_mesh(tyrefrf.with_mesh(from_mesh(), mesh))
    assert np.array_equal(of_file.points, held.points)
    assert np.array_equal(of_file.bricks, held.bricks)
    assert np.array_equal(of_file.rim, held.rim)
