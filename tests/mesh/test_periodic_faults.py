"""Cells that cannot be: each is refused with the numbers of the file, and what would mend it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from outside import bricks_of, outside, read_back, sets_of
from rings import tyre

from tyrefrf.errors import MeshError
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.cut import Side
from tyrefrf.mesh.free_surface import Surface
from tyrefrf.mesh.outside import OutsideMesh
from tyrefrf.mesh.periodic import CellSets, periodic_cell

N_CELLS = 20
SECTOR = 2.0 * np.pi / N_CELLS
FACES = {"left": "LEFT", "right": "RIGHT"}
faces = pytest.mark.parametrize("names", [{}, FACES], ids=["found", "named"])


@pytest.fixture
def mesh() -> OutsideMesh:
    return outside(tyre("hex8i", N_CELLS, 8, 2).mesh, 1)


@pytest.fixture
def quadratic() -> OutsideMesh:
    return outside(tyre("hex20", N_CELLS, 8, 1).mesh, 1)


def refused(message: str, mesh: OutsideMesh, sector_angle: float = SECTOR, **names: str) -> str:
    with pytest.raises(MeshError, match=message) as caught:
        read_back(mesh, sector_angle, **names)
    assert str(caught.value).startswith("sector.inp: ")
    return str(caught.value)


def with_nodes(mesh: OutsideMesh, e: int, places: dict[int, int]) -> OutsideMesh:
    """One brick with other nodes at some of its places."""
    (block,) = mesh.elements
    nodes = block.nodes.copy()
    for a, node in places.items():
        nodes[e, a] = node
    return replace(mesh, elements=(replace(block, nodes=nodes),))


def numbers(text: str) -> set[int]:
    return {int(word) for word in re.findall(r"\b\d{3,4}\b", text)}


@faces
@pytest.mark.parametrize("n", [19, 40])
def test_another_angle_than_declared(mesh, names, n):
    """Half the angle is refused too, though the surface of an evenly meshed cell matches itself."""
    text = refused("18 deg apart", mesh, 2.0 * np.pi / n, **names)
    assert f"cell.sector_angle is {360.0 / n:.8g} deg" in text
    assert "20 cells would have 18 deg each" in text


def test_the_angle_of_a_finely_cut_tyre():
    """Cells of 8 and of 8.37 deg match almost alike; the better match is advised."""
    cell = tyre("hex8i", 45, 28, 1).mesh
    refused("8 deg apart.*45 cells would have 8 deg", outside(cell, 1), 2.0 * np.pi / 40)


def test_another_axle():
    """About a wrong axis a few small faces match by accident, nearly: no angle is advised."""
    mesh = outside(tyre("hex8i", 45, 28, 1).mesh, 1)
    mesh = replace(mesh, points=mesh.points[:, [1, 2, 0]])
    angle = 2.0 * np.pi / 45
    refused("no faces match by a rotation of 8 deg.*check mesh.axis", mesh, angle)
    refused("have no partner.*check mesh.axis", mesh, angle, **FACES)


def moved(mesh: OutsideMesh, k: int, by: float) -> tuple[OutsideMesh, int]:
    """A node of the right face moved along the axle, and its number."""
    points = mesh.points.copy()
    node = np.setdiff1d(mesh.node_sets["RIGHT"], mesh.node_sets["RIM"])[k]
    points[node, 1] += by
    return replace(mesh, points=points), int(mesh.numbers[node])


@pytest.mark.parametrize("by", [3e-5, 4e-4])
def test_a_node_off_its_place_is_named_with_the_tolerance_that_fits(mesh, by):
    damaged, number = moved(mesh, 3, by)
    text = refused("1 of 18 nodes of 'RIGHT' have no partner on 'LEFT'", damaged, **FACES)
    assert f"{number} ({by:.2g} m from" in text
    fits = float(re.search(r'mesh.tolerance = "(.*) mm" would', text)[1]) / 1e3
    assert by < fits < 1.1 * by
    sets = sets_of(damaged, **FACES)
    again = periodic_cell(damaged, bricks_of(damaged), sets, SECTOR, fits)
    assert again.n_face == 18


def test_a_torn_face_is_noticed_without_its_name(mesh):
    damaged, _ = moved(mesh, 3, 4e-4)
    refused("faces of elements .* meet when the cell is repeated but do not match", damaged)


def test_a_set_with_a_node_too_many(mesh):
    stranger = np.setdiff1d(mesh.elements[0].nodes, np.concatenate(list(mesh.node_sets.values())))
    more = np.append(mesh.node_sets["LEFT"], stranger[0])
    mesh = replace(mesh, node_sets={**mesh.node_sets, "LEFT": more})
    text = refused("1 of 19 nodes of 'LEFT' have no partner", mesh, left="LEFT")
    assert mesh.numbers[stranger[0]] in numbers(text)


def test_a_set_without_mid_sides(quadratic):
    corners = np.unique(quadratic.elements[0].nodes[:, :8])
    left = np.intersect1d(quadratic.node_sets["LEFT"], corners)
    sets = {**quadratic.node_sets, "LEFT": left}
    text = refused(
        "18 of 18 nodes of 'LEFT'", replace(quadratic, node_sets=sets), left="LEFT", right="RIGHT"
    )
    assert "mid-sides included" in text


def test_sets_of_nodes_that_no_brick_has(mesh):
    lonely = np.setdiff1d(np.arange(len(mesh.points)), mesh.elements[0].nodes)
    nodes = {**mesh.node_sets, "LEFT": lonely}
    refused("no node of the set 'LEFT' belongs to a brick", replace(mesh, node_sets=nodes), **FACES)
    nodes = {**mesh.node_sets, "RIM": lonely}
    refused("no node of the rim's set 'RIM'", replace(mesh, node_sets=nodes))


def test_a_rim_on_one_face_only(mesh):
    rim = np.setdiff1d(mesh.node_sets["RIM"], mesh.node_sets["RIGHT"][:1])
    rim = np.setdiff1d(rim, mesh.node_sets["RIGHT"])
    refused("its partner .* on the other is not", replace(mesh, node_sets={"RIM": rim}))


def test_an_inverted_brick(mesh):
    nodes = mesh.elements[0].nodes[5]
    damaged = with_nodes(mesh, 5, {a: nodes[(a + 4) % 8] for a in range(8)})
    text = refused("inverted or flat bricks: elements", damaged)
    assert mesh.elements[0].numbers[5] in numbers(text)


def test_a_mirrored_mesh(mesh):
    mirrored = replace(mesh, points=mesh.points * np.array([1.0, 1.0, -1.0]))
    refused("all are: is the file's frame left-handed", mirrored)


def test_a_collapsed_brick(mesh):
    damaged = with_nodes(mesh, 7, {2: mesh.elements[0].nodes[7, 3]})
    text = refused("collapsed bricks, with a node twice", damaged)
    assert {mesh.elements[0].numbers[7], mesh.numbers[mesh.elements[0].nodes[7, 3]]} <= numbers(
        text
    )


def test_a_brick_without_a_mid_side(quadratic):
    text = refused("nodes are missing in elements", with_nodes(quadratic, 3, {17: -1}))
    assert quadratic.elements[0].numbers[3] in numbers(text)


def test_a_crack(mesh):
    """A node doubled: the bricks about it no longer hang together there."""
    old = mesh.elements[0].nodes[4, 6]
    doubled = replace(
        mesh,
        points=np.vstack([mesh.points, mesh.points[old]]),
        numbers=np.append(mesh.numbers, 9999),
    )
    damaged = with_nodes(doubled, 4, {6: len(mesh.points)})
    text = refused("1 pairs of nodes stand at the same place", damaged)
    assert {9999, mesh.numbers[old]} <= numbers(text)


def test_parts_that_do_not_hang_together():
    whole: CellMesh = tyre("hex8i", N_CELLS, 8, 2).mesh
    gone = np.isin(np.arange(16) % 8, [3, 4, 5])  # a gap in the crown, all around
    refused("the bricks are in 2 parts that share no node", outside(whole, 1, kept=~gone))


def test_a_brick_within_a_brick(mesh):
    (block,) = mesh.elements
    nodes, more = np.vstack([block.nodes, block.nodes[:2], block.nodes[:1]]), [9001, 9002, 9003]
    sets = {"rubber": np.append(block.numbers, more)}
    mesh = replace(
        mesh,
        elements=(replace(block, nodes=nodes, numbers=sets["rubber"]),),
        element_sets=sets,
    )
    text = refused("all share one face", mesh)
    assert numbers(text) & set(more)
    assert numbers(text) & set(block.numbers)


def test_a_rim_that_does_not_close_off_both_beads(mesh):
    y = mesh.points[:, 1]
    one_side = mesh.node_sets["RIM"][y[mesh.node_sets["RIM"]] > 0.0]
    text = refused("not divided from the outer one", replace(mesh, node_sets={"RIM": one_side}))
    assert "mesh.inner" in text


def with_inner(mesh: OutsideMesh, inner: Side | Surface) -> CellSets:
    return replace(sets_of(mesh), inner=inner)


def refused_inner(message: str, mesh: OutsideMesh, inner: Side | Surface) -> str:
    with pytest.raises(MeshError, match=message) as caught:
        periodic_cell(mesh, bricks_of(mesh), with_inner(mesh, inner), SECTOR)
    return str(caught.value)


def test_the_outside_named_as_the_inside(mesh):
    cell = tyre("hex8i", N_CELLS, 8, 2).mesh
    section = cell.section
    outer = replace(cell, inside=cell.planes[:, np.unique(section.outer)])
    nodes = outside(outer, 1).node_sets["INNER"]
    text = refused_inner("would pull the tyre towards the axle", mesh, Side(nodes, "OUTER"))
    assert "16 faces" in text


def test_an_inside_that_ends_within_the_wall(mesh):
    y = mesh.points[:, 1]
    some = mesh.node_sets["INNER"][y[mesh.node_sets["INNER"]] > -0.06]
    text = refused_inner("does not reach from rim to rim", mesh, Side(some, "INNER"))
    assert len(numbers(text) & set(mesh.numbers[some])) == 2


def test_an_inside_without_a_face(mesh):
    refused_inner("no free face", mesh, Side(mesh.node_sets["RIM"], "RIM"))


def test_a_surface_between_bricks_or_of_none(mesh):
    block = mesh.elements[0]
    surfaces = np.array([[e, side] for e in block.numbers for side in range(1, 7)])
    refused_inner("faces that are not free.*S3 of element", mesh, Surface(surfaces, "ALL"))
    text = refused_inner("is none of the bricks", mesh, Surface(np.array([[77777, 1]]), "ALIEN"))
    assert "77777" in text


def test_cords_across_the_mesh():
    """Bricks that run askew would lay the cords askew, so they may only be isotropic."""
    cell = tyre("hex8i", N_CELLS, 8, 2).mesh
    points = cell.points.copy()
    points[:, 1] += np.clip(0.1 * (points[:, 0] - 0.2), 0.0, None) * np.cos(20.0 * points[:, 2]) * 4
    askew = outside(replace(cell, points=points), 1)
    sets = replace(sets_of(askew), oriented=("rubber",))
    with pytest.raises(MeshError, match=r"no edges around the tyre: .* deg off"):
        periodic_cell(askew, bricks_of(askew), sets, SECTOR)
    assert read_back(askew, SECTOR).n_nodes == cell.n_nodes


def test_a_cut_that_steps_by_a_whole_cell():
    """A staircase of one layer: its upper half begins where the lower one ends."""
    double = revolve(tyre("hex8i", N_CELLS, 8, 1).mesh.section, 2.0 * SECTOR, 2)
    layer = np.repeat([0, 1], double.section.n_elements)
    first = np.where(double.points[double.bricks, 1].mean(axis=1) > 0.0, 1, 0)
    text = refused("are on both faces", outside(double, 1, kept=layer == first))
    assert "two cells" in text


def test_the_whole_tyre_is_no_cell(mesh):
    refused("cannot be the whole tyre", mesh, 2.0 * np.pi)
