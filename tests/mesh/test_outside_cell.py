"""Which sets of a file are what in the cell: node sets, surfaces, or flat elements that name them.

The last is how Gmsh writes physical surfaces: quadrilaterals upon the faces of the bricks.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from outside import outside, read_back
from rings import tyre

from tyrefrf.case import CellFile
from tyrefrf.errors import CaseError, MeshError
from tyrefrf.mesh.brick_faces import BrickFaces
from tyrefrf.mesh.cut import turned
from tyrefrf.mesh.outside import Elements, OutsideMesh
from tyrefrf.mesh.outside_cell import outside_cell

SECTOR = 2.0 * np.pi / 20


@pytest.fixture(params=["hex8i", "hex20"])
def mesh(request) -> OutsideMesh:
    return outside(tyre(request.param, 20, 8, 2).mesh, 1)


def source(**named: str) -> CellFile:
    table = {"kind": "cell", "file": "sector.inp", "unit": "m", "rim": "RIM"}
    return CellFile.model_validate({**table, "materials": {"rubber": "rubber"}, **named})


def faces_of(mesh: OutsideMesh, name: str) -> np.ndarray:
    """Numbers of the free faces all of whose nodes are in a node set."""
    (block,) = mesh.elements
    faces = BrickFaces.of(block.nodes, block.numbers, "")
    return np.flatnonzero(faces.free & np.all(np.isin(faces.nodes, mesh.node_sets[name]), axis=1))


def same(mesh: OutsideMesh, **named: str) -> bool:
    """Whether the cell is the one that is found without any names but the rim's."""
    found = outside_cell(mesh, source(**named), SECTOR)
    element = {8: "hex8i", 20: "hex20"}[mesh.elements[0].nodes.shape[1]]
    plain = read_back(outside(tyre(element, 20, 8, 2).mesh, 1), SECTOR)
    return all(
        np.array_equal(getattr(found, name), getattr(plain, name))
        for name in ("points", "bricks", "rim", "numbers")
    ) and np.array_equal(np.unique(found.inside), np.unique(plain.inside))


NAMED = {"left": "LEFT", "right": "RIGHT", "inner": "INNER"}


@pytest.mark.parametrize("named", [{}, NAMED, {"left": "left"}], ids=["found", "named", "case"])
def test_node_sets(mesh, named):
    assert same(mesh, **named)


def test_surfaces_for_all(mesh):
    surfaces = {}
    for name in mesh.node_sets:
        brick, side = np.divmod(faces_of(mesh, name), 6)
        surfaces[name] = np.stack([mesh.elements[0].numbers[brick], side + 1], axis=1)
    assert same(replace(mesh, surfaces=surfaces, node_sets={}), **NAMED)


def with_quads(mesh: OutsideMesh) -> OutsideMesh:
    """Node sets as quadrilaterals upon the bricks' faces, in element sets of their names."""
    (block,) = mesh.elements
    nodes = BrickFaces.of(block.nodes, block.numbers, "").nodes
    kind, quads, sets, first = {4: "quad", 8: "quad8"}[nodes.shape[1]], [], {}, 50_000
    for name in mesh.node_sets:
        faces = nodes[faces_of(mesh, name)]
        numbers = first + np.arange(len(faces))
        quads.append(Elements(kind, faces, numbers))
        sets[name], first = numbers, first + len(faces)
    return replace(
        mesh,
        elements=(block, *quads),
        element_sets={**mesh.element_sets, **sets},
        node_sets={},
    )


def test_physical_surfaces(mesh):
    assert same(with_quads(mesh), **NAMED)


def test_flat_elements_that_name_nothing_are_not_dropped_unsaid(mesh):
    with pytest.raises(CaseError, match=r"element \d+ \(quad8?\) .* LEFT"):
        outside_cell(with_quads(mesh), source(), SECTOR)
    left_out = source().model_copy(update={"leave_out": ("LEFT", "RIGHT", "INNER")})
    assert outside_cell(with_quads(mesh), left_out, SECTOR).n_nodes > 0


def test_the_tolerance_is_the_cases(mesh):
    mesh = replace(mesh, points=turned(mesh.points, 0.7))
    with pytest.raises(MeshError, match=r"within 1e-20 m; .* mesh.tolerance = "):
        outside_cell(mesh, source().model_copy(update={"tolerance": 1e-20}), SECTOR)
    assert outside_cell(mesh, source(), SECTOR).n_nodes > 0


def test_the_way_through_a_sets_layers_is_the_cases(mesh):
    """Told to go along y, the first axis does in every brick, as well as one of two can."""
    given = {"rubber": {"material": "rubber", "through": [0.0, 1.0]}}
    cell = outside_cell(mesh, source(materials=given), SECTOR)
    X = cell.points[cell.bricks[:, :8], :2]
    xi = X[:, [1, 2, 5, 6]].mean(axis=1) - X[:, [0, 3, 4, 7]].mean(axis=1)
    eta = X[:, [2, 3, 6, 7]].mean(axis=1) - X[:, [0, 1, 4, 5]].mean(axis=1)
    xi, eta = (v / np.linalg.norm(v, axis=1)[:, None] for v in (xi, eta))
    assert np.all(xi[:, 1] > abs(eta[:, 1]))
