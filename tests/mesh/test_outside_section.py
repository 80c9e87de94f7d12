"""Meshes that are no section are refused, with the element or node and what to do about it.

Two columns of two elements each stand between the rims, as an arch over the axle.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tyrefrf.case import SectionFile
from tyrefrf.errors import CaseError, MeshError
from tyrefrf.mesh.grid import grid_section
from tyrefrf.mesh.outside import Elements, OutsideMesh
from tyrefrf.mesh.outside_section import outside_section

SOURCE = SectionFile(
    file="arch.inp", kind="section", unit="m", rim="RIM", materials={"A": "a", "B": "b"}
)
N_COLUMNS, N_ROWS = 4, 2


def arch(step=1):
    """A half ring of four columns and two rows; nodes numbered from 101, elements from 11."""
    angle = np.linspace(-2.0, 2.0, step * N_COLUMNS + 1)
    radius = np.linspace(0.05, 0.07, step * N_ROWS + 1)
    grid = np.stack(
        [0.2 + np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius)], axis=-1
    )
    rows = np.full(N_COLUMNS, N_ROWS)
    return grid_section(grid, rows, step, np.tile([0, 1], (N_COLUMNS, 1)), ("a", "b"))


def outside(section=None, **changes) -> OutsideMesh:
    section = section or arch()
    numbers = 11 + np.arange(section.n_elements)
    kind = "quad" if section.quads.shape[1] == 4 else "quad8"
    mesh = OutsideMesh(
        path="arch.inp",
        points=np.column_stack([section.points, np.zeros(section.n_nodes)]),
        numbers=101 + np.arange(section.n_nodes),
        elements=(Elements(kind, section.quads, numbers),),
        element_sets={
            "A": numbers[section.material == 0],
            "B": numbers[section.material == 1],
            "ROAD": numbers[:1],
        },
        node_sets={"RIM": section.rim, "CORNERS": section.rim[:1], "CROWN": np.array([8, 7])},
        surfaces={},
    )
    return replace(mesh, **changes)


def with_quads(quads, **changes) -> OutsideMesh:
    return outside(replace(arch(), quads=quads), **changes)


def with_points(node, r, y, z=0.0) -> OutsideMesh:
    mesh = outside()
    points = mesh.points.copy()
    points[node] = r, y, z
    return replace(mesh, points=points)


def without(*elements) -> OutsideMesh:
    mesh = outside()
    (block,) = mesh.elements
    kept = np.setdiff1d(np.arange(len(block.numbers)), elements)
    left = Elements(block.kind, block.nodes[kept], block.numbers[kept])
    sets = {name: np.intersect1d(found, left.numbers) for name, found in mesh.element_sets.items()}
    return replace(mesh, elements=(left,), element_sets=sets)


def cracked() -> OutsideMesh:
    """The crown's nodes twice, for the columns on either side of it."""
    section = arch()
    quads, n = section.quads.copy(), section.n_nodes
    at_crown = np.arange(6, 9)
    right = quads[4:]
    right[np.isin(right, at_crown)] += n - 6
    points = np.vstack([section.points, section.points[at_crown]])
    return outside(replace(section, points=points, quads=quads))


def also(kind, nodes, *names) -> OutsideMesh:
    """One more element, number 99, in these sets."""
    mesh = outside()
    sets = {
        n: np.append(found, 99) if n in names else found for n, found in mesh.element_sets.items()
    }
    more = Elements(kind, np.array([nodes]), np.array([99]))
    return replace(mesh, elements=(*mesh.elements, more), element_sets=sets)


def in_sets(**sets) -> OutsideMesh:
    mesh = outside()
    return replace(mesh, element_sets={**mesh.element_sets, **sets})


def test_the_arch_itself_is_a_section():
    section = arch()
    read = outside_section(outside(), SOURCE, ["a", "b"])
    assert np.array_equal(read.points, section.points)
    assert np.array_equal(read.quads, section.quads)
    assert np.array_equal(read.outer, section.outer)
    assert np.array_equal(read.inner, section.inner)
    assert np.array_equal(read.numbers, 101 + np.arange(section.n_nodes))


Q = arch().quads
FAULTS = {
    "triangle": (also("triangle", [0, 1, 2], "A"), "element 99 is a triangle.*RecombineAll"),
    "quad9": (also("quad9", [0] * 9, "A"), "element 99 is a quad9.*SecondOrderIncomplete"),
    "brick": (also("hexahedron", [0] * 8, "A"), "element 99 is a hexahedron, which is not read"),
    "mixed": (also("quad8", [0] * 8, "A"), "element 11 is a quad, element 99 is a quad8.* mix"),
    "no material": (also("quad", [0, 1, 2, 3]), r"element 99 \(quad\) has no material"),
    "rebar": (also("SFMGAX1", [0, 1]), r"element 99 \(SFMGAX1\) has no material.*leave_out"),
    "two sets": (in_sets(B=np.arange(11, 19)), "element 11 is in two sets .* 'A' and 'B'"),
    "empty set": (in_sets(A=np.empty(0, int)), "element 11 .* and 3 more have no material"),
    "collapsed": (
        with_quads(np.vstack([Q[:1, [0, 1, 1, 3]], Q[1:]])),
        "element 11 is collapsed to a triangle",
    ),
    "bow tie": (
        with_quads(np.vstack([Q[:1, [0, 2, 1, 3]], Q[1:]])),
        "element 11 is inverted|no area",
    ),
    "no area": (with_points(0, *(arch().points[[1, 3]].mean(axis=0))), "element 11 is inverted"),
    "crack": (cracked(), r"nodes 109 and 118 are at the same place \(3 such pair"),
    "apart": (
        without(2, 3),
        "the section is in 2 parts: element 15 is not connected to element 11",
    ),
    "twice": (with_quads(np.vstack([Q[:-1], Q[:1]])), "lie on one another|more than two"),
    "off the plane": (with_points(4, 0.25, 0.0, 0.01), "node 105 is 10 mm off the section's plane"),
    "beyond the axle": (with_points(0, -0.01, -0.05), "node 101 is at r = -10 mm"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_what_is_no_section_is_refused(fault):
    mesh, words = FAULTS[fault]
    with pytest.raises((MeshError, CaseError), match=words):
        outside_section(mesh, SOURCE)


def test_parts_that_touch_in_a_corner_only_are_refused():
    with pytest.raises(MeshError, match=r"touch in a corner only, at node 10[58]"):
        outside_section(without(2, 5), SOURCE)


def test_elements_that_lie_on_one_another_are_refused():
    mesh = outside()
    section = arch()
    a, b = section.outer[0]  # an edge of element 12, with another element on the same side of it
    n, inwards = section.n_nodes, 0.9 * section.points[[b, a]] + [0.02, 0.0]
    points = np.vstack([mesh.points, np.column_stack([inwards, [0.0, 0.0]])])
    more = Elements("quad", np.array([[a, b, n, n + 1]]), np.array([99]))
    folded = replace(
        mesh,
        points=points,
        numbers=101 + np.arange(n + 2),
        elements=(*mesh.elements, more),
        element_sets={**mesh.element_sets, "A": np.append(mesh.element_sets["A"], 99)},
    )
    with pytest.raises(MeshError, match="elements 12 and 99 lie on one another"):
        outside_section(folded, SOURCE)


def test_a_hole_is_refused():
    angle = np.linspace(-2.0, 2.0, 5)
    radius = np.linspace(0.04, 0.07, 4)
    grid = np.stack([0.2 + np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius)], -1)
    section = grid_section(grid, np.full(4, 3), 1, np.tile([0, 1, 0], (4, 1)), ("a", "b"))
    kept = np.setdiff1d(np.arange(12), [4])
    holed = replace(section, quads=section.quads[kept], material=section.material[kept])
    with pytest.raises(MeshError, match="the section has a hole, at node 1"):
        outside_section(outside(holed), SOURCE)


def test_elements_that_are_left_out_are_no_part_of_the_tyre():
    mesh = also("R2D2", [0, 1], "ROAD")
    source = SOURCE.model_copy(update={"leave_out": ("ROADS",)})
    sets = {**mesh.element_sets, "ROADS": np.array([99])}
    read = outside_section(replace(mesh, element_sets=sets), source)
    assert read.n_elements == 8


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        ({"rim": "RIMM"}, "mesh.rim", "has no node set 'RIMM'; .*; did you mean 'RIM'?"),
        ({"rim": "EMPTY"}, "mesh.rim", "node set 'EMPTY' of arch.inp holds nothing: empty"),
        ({"inner": "LINER"}, "mesh.inner", "has no surface or node set 'LINER'"),
        ({"leave_out": ("X",)}, r"mesh.leave_out\[0\]", "has no element set 'X'"),
        ({"materials": {"C": "a"}}, "mesh.materials.C", "has no element set 'C'"),
    ],
)
def test_sets_that_are_not_there_are_said_at_the_key(change, key, words):
    mesh = outside()
    mesh = replace(mesh, node_sets={**mesh.node_sets, "EMPTY": np.empty(0, int)})
    with pytest.raises(CaseError, match=f"case: {key}: .*{words}"):
        outside_section(mesh, SOURCE.model_copy(update=change))


def test_names_of_sets_need_no_capital_letters():
    source = SOURCE.model_copy(update={"rim": "rim", "materials": {"a": "a", "b": "b"}})
    assert outside_section(outside(), source).n_elements == 8


@pytest.mark.parametrize(
    ("nodes", "words"),
    [
        ([7], "the rim is not on the section's boundary: none of its 1 nodes, such as node 108"),
        ([0, 1, 2], "must hold the section at two places"),
        ([0, 2, 12, 14, 6], "must hold the section at two places"),
    ],
)
def test_a_rim_that_does_not_hold_both_sides_is_refused(nodes, words):
    mesh = replace(outside(), node_sets={"RIM": np.array(nodes)})
    with pytest.raises(MeshError, match=words):
        outside_section(mesh, SOURCE)


def test_a_rim_without_its_mid_sides_is_refused():
    section = arch(step=2)
    corners = np.intersect1d(section.rim, section.quads[:, :4])
    mesh = replace(outside(section), node_sets={"RIM": corners})
    with pytest.raises(MeshError, match="the mid-side between the rim's nodes 101 and 103"):
        outside_section(mesh, SOURCE)


def test_two_mid_sides_on_one_edge_are_refused():
    section = arch(step=2)
    quads, n = section.quads.copy(), section.n_nodes
    shared = quads[0, 6]  # between columns 0 and 1
    quads[0, 6] = n
    aside = section.points[shared] + [0.0, 2e-3]
    split = replace(section, quads=quads, points=np.vstack([section.points, aside]))
    with pytest.raises(MeshError, match=f"has two mid-sides, ({101 + n}|{101 + shared}) and"):
        outside_section(outside(split), SOURCE)


def test_the_inner_surface_may_be_named_and_has_to_be_whole():
    section = arch()
    inside = np.unique(section.inner)
    whole, part = {"IN": inside}, {"IN": inside[1:]}
    source = SOURCE.model_copy(update={"inner": "IN"})
    rim = outside().node_sets
    read = outside_section(replace(outside(), node_sets={**rim, **whole}), source)
    assert np.array_equal(read.inner, section.inner)
    with pytest.raises(MeshError, match="from node 101 to 104 is not in it"):
        outside_section(replace(outside(), node_sets={**rim, **part}), source)
    faces = np.array([[number, 4] for number in (11, 13, 15, 17)])
    for named in (faces, faces * [1, 0]):
        mesh = replace(outside(), surfaces={"IN": named})
        assert np.array_equal(outside_section(mesh, source).inner, section.inner)
    with pytest.raises(MeshError, match="from node 101 to 104 is not in it"):
        outside_section(replace(outside(), surfaces={"IN": faces[1:]}), source)


def test_layers_askew_need_to_be_told():
    diagonal = 0.5 + np.pi / 4.0  # the third column stands at an angle of 0.5
    told = {"A": {"material": "a", "through": [np.cos(diagonal), np.sin(diagonal)]}, "B": "b"}
    source = SectionFile.model_validate(SOURCE.model_dump() | {"materials": told})
    assert outside_section(outside(), source, ["b"]).n_elements == 8
    with pytest.raises(
        CaseError, match=r"mesh.materials.A: .*layers of element 15 lie is not clear"
    ):
        outside_section(outside(), source, ["a", "not in the mesh"])


def test_through_turns_the_elements_of_a_set():
    told = {"A": {"material": "a", "through": [0.0, 1.0]}, "B": "b"}
    source = SectionFile.model_validate(SOURCE.model_dump() | {"materials": told})
    read, found = outside_section(outside(), source), arch()
    quarter = np.roll(np.arange(4), -1)
    at_crown = found.quads[2 * 2]  # of A, in the third column: its own direction is mostly r
    assert np.array_equal(read.quads[4], at_crown[quarter])
    assert np.array_equal(read.quads[5], found.quads[5])  # of B
