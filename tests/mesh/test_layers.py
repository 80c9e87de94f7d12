"""The layered section: the paper's counts, and regions that are where the case says.

The paper's tyre (section 3.3) has 60 cells "each with 173 nodes", read as those of a section: 3
nodes through the body at 41 stations and 2 more through the tread at 25 of them.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from tyrefrf.arrays import FloatArray
from tyrefrf.case.geometry import Bead, Belt, Geometry, Thickness, Tread
from tyrefrf.errors import CaseError, MeshError
from tyrefrf.mesh.cell import revolve
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.mesh.shapes import QUAD4, QUAD8, shape
from tyrefrf.mesh.surface import Surface

EXACT = 1e-14  # [m], roundings of sizes below one
ARC = 1e-7  # [m]: a border's place is interpolated between samples 40 um apart
BEND = 0.15  # the core lies on the outside of a bend, its height is the centre line's
CHORDS = 0.02  # a region of straight-sided elements against thickness times width

both = pytest.mark.parametrize("quadratic", [False, True], ids=["four nodes", "eight nodes"])


def geometry(**changes: object) -> Geometry:
    """The paper's layered section with other sizes."""
    sizes: dict[str, object] = {
        "material": "rubber",
        "elements_along": 40,
        "elements_through": 2,
        "tread": Tread(material="tread", elements_along=24),
        "belt": Belt(material="belt"),
        "bead": Bead(material="steel"),
    }
    return Geometry(**(sizes | changes))


def section(quadratic: bool = False, **changes: object) -> SectionMesh:
    return tyre_section(geometry(**changes), quadratic)


def areas(mesh: SectionMesh) -> FloatArray:
    """Areas (e,) of the quadrilaterals between their corners, positive if counter-clockwise."""
    r, y = np.moveaxis(mesh.points[mesh.quads[:, :4]], 2, 0)
    return 0.5 * np.sum(r * np.roll(y, -1, axis=1) - y * np.roll(r, -1, axis=1), axis=1)


def region(mesh: SectionMesh, name: str) -> FloatArray:
    """Corners (e, 4, 2) of a material's quadrilaterals."""
    return mesh.points[mesh.quads[mesh.material == mesh.materials.index(name), :4]]


def area(mesh: SectionMesh, name: str) -> float:
    return float(areas(mesh)[mesh.material == mesh.materials.index(name)].sum())


def determinants(mesh: SectionMesh) -> FloatArray:
    """Jacobian determinants (e, g) at 7 x 7 points, corners included."""
    x = np.linspace(-1.0, 1.0, 7)
    nodes = QUAD4 if mesh.quads.shape[1] == 4 else QUAD8
    dN = shape(nodes, np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2))[1]
    return np.linalg.det(np.einsum("gak,eai->egki", dN, mesh.points[mesh.quads]))


def mirrored(mesh: SectionMesh) -> set[tuple[object, ...]]:
    """Every quadrilateral's nodes and material, mirrored about y = 0."""
    return quadrilaterals(mesh, [1.0, -1.0])


def quadrilaterals(mesh: SectionMesh, factor: object = 1.0) -> set[tuple[object, ...]]:
    points = mesh.points * factor + 0.0  # minus zero is zero
    names = [mesh.materials[index] for index in mesh.material]
    return {
        (frozenset(map(tuple, nodes)), name)
        for nodes, name in zip(points[mesh.quads].tolist(), names, strict=True)
    }


# the paper's counts


def test_the_papers_section_has_173_nodes_and_128_elements():
    mesh = section()
    assert (mesh.n_nodes, mesh.n_elements) == (173, 128)


def test_it_has_3_nodes_at_41_stations_and_2_more_at_25_of_them():
    corners = section().quads
    inner = np.unique(section().inner)
    per_station = np.diff([*inner, corners.max() + 1])
    assert per_station.tolist() == [3] * 8 + [5] * 25 + [3] * 8


def test_its_materials_are_in_the_order_of_the_regions():
    assert section().materials == ("rubber", "tread", "belt", "steel")


def test_a_material_of_two_regions_is_one():
    mesh = section(tread=Tread(material="rubber", elements_along=24))
    assert mesh.materials == ("rubber", "belt", "steel")
    assert np.bincount(mesh.material).tolist() == [128 - 20 - 2, 20, 2]


def test_its_ring_of_60_cells_has_10380_nodes():
    assert 60 * revolve(section(), np.pi / 30.0, 1).n_own == 10380


def test_the_quadratic_section_has_the_same_elements():
    linear, quadratic = section(), section(quadratic=True)
    n_edges = 3 * 40 + 2 * 24 + 2 * 41 + 2 * 25  # along: 3 rows and 2; through: 2 and 2
    assert quadratic.n_nodes == 173 + n_edges
    corners = quadratic.points[quadratic.quads[:, :4]]
    assert np.allclose(corners, linear.points[linear.quads], atol=EXACT, rtol=0.0)
    assert np.array_equal(quadratic.material, linear.material)


# its shape


@both
def test_the_section_is_its_own_mirror_image_with_its_materials(quadratic):
    mesh = section(quadratic)
    assert mirrored(mesh) == quadrilaterals(mesh)


@both
def test_quadrilaterals_turn_counter_clockwise_and_none_is_folded(quadratic):
    mesh = section(quadratic)
    assert areas(mesh).min() > 0.0
    assert determinants(mesh).min() > 0.0


@both
def test_every_node_belongs_to_an_element(quadratic):
    mesh = section(quadratic)
    assert np.array_equal(np.unique(mesh.quads), np.arange(mesh.n_nodes))


@both
def test_radii_and_rim_are_the_given_ones(quadratic):
    mesh = section(quadratic)
    rim = mesh.points[mesh.rim]
    assert mesh.points[:, 0].max() == pytest.approx(0.278, abs=EXACT)
    assert rim[:, 0] == pytest.approx(0.168, abs=EXACT)
    assert np.ptp(rim[:, 1]) == pytest.approx(0.127, abs=EXACT)
    assert len(rim) == (10 if quadratic else 6)
    assert mesh.points[:, 0].min() == rim[:, 0].min()


def test_spacing_along_the_profile_changes_smoothly():
    mesh = section()
    line = mesh.points[mesh.inner[:, 0] + 1]  # between the two rows of the body
    step = np.linalg.norm(np.diff(line, axis=0), axis=1)
    assert np.max(step[1:] / step[:-1]) < 1.5
    assert np.max(step[:-1] / step[1:]) < 1.5


def test_stations_at_other_counts_follow_the_regions():
    mesh = section(elements_along=56, elements_through=3, tread=Tread(material="tread"))
    assert mirrored(mesh) == quadrilaterals(mesh)
    step = np.linalg.norm(np.diff(mesh.points[mesh.inner[:, 0]], axis=0), axis=1)
    assert step.max() < 2.5 * step.min()


# its regions


def test_the_tread_is_as_wide_and_as_thick_as_given():
    tread = region(section(tread=Tread(material="tread", edge_thickness=0.006)), "tread")
    points = tread.reshape(-1, 2)
    hub = 0.278 - 0.4  # centre of the crown's circle
    radius = np.hypot(points[:, 0] - hub, points[:, 1])
    on_top = points[np.abs(radius - 0.4) < 1e-9]
    assert np.ptp(on_top[:, 1]) == pytest.approx(0.125, abs=EXACT)
    middle = points[points[:, 1] == 0.0, 0]
    assert np.ptp(middle) == pytest.approx(0.008, abs=EXACT)


def test_the_wall_under_the_treads_edge_is_the_shoulders_rest():
    # where the tread's foot ends at its edge, both stand on the normal of the crown's circle
    tread = Tread(material="tread", edge_thickness=0.006, buttress=0.0)
    mesh = section(tread=tread)
    first = mesh.outer[mesh.outer[:, 1] - mesh.outer[:, 0] == 1, 0]  # climbing: inner node first
    foot = mesh.points[first[0]]
    top = mesh.points[first[0] + 2]
    inner = mesh.points[first[0] - 2]
    assert np.linalg.norm(top - foot) == pytest.approx(0.006, abs=1e-6)
    assert np.linalg.norm(foot - inner) == pytest.approx(0.010, abs=1e-6)


def test_the_belt_is_as_wide_and_as_thick_as_given():
    belt = region(section(belt=Belt(material="belt", width=0.1, thickness=0.002)), "belt")
    thick = np.linalg.norm(belt[:, [1, 2]] - belt[:, [0, 3]], axis=2)
    assert thick == pytest.approx(0.002, abs=1e-9)
    middle = (belt[:, 0] + belt[:, 1] + belt[:, 2] + belt[:, 3]) / 4.0
    assert len(np.unique(middle[:, 1])) == len(belt)  # one row
    across = np.linalg.norm(belt[:, 3] - belt[:, 0] + belt[:, 2] - belt[:, 1], axis=1) / 2.0
    assert across.sum() == pytest.approx(0.1, rel=CHORDS)


def test_the_core_is_as_high_and_as_thick_as_given():
    mesh = section(elements_along=80, bead=Bead(material="steel", height=0.02, thickness=0.004))
    core = region(mesh, "steel")
    thick = np.linalg.norm(core[:, [1, 2]] - core[:, [0, 3]], axis=2)
    assert thick == pytest.approx(0.004, abs=1e-9)
    ends = mesh.points[mesh.rim]
    assert core[..., 0].min() == ends[0, 0]
    # the height is that of the body's centre line, the middle of the wall
    wall = mesh.points.reshape(-1, 2)
    top = core[..., 0].max()
    station = np.argmin(np.abs(wall[:, 0] - top) + (wall[:, 1] > 0.0))
    across = mesh.points[[station - station % 3, station - station % 3 + 2]]
    assert across[:, 0].mean() == pytest.approx(0.168 + 0.02, abs=ARC)


def test_areas_are_thickness_times_width():
    mesh = section()
    assert area(mesh, "belt") == pytest.approx(0.003 * 0.115, rel=CHORDS)
    assert area(mesh, "steel") == pytest.approx(2 * 0.005 * 0.008, rel=BEND)
    foot = 0.125 + 2 * 0.010
    assert area(mesh, "tread") == pytest.approx(0.008 * (0.125 + foot) / 2.0, rel=2 * CHORDS)


def test_the_layers_are_part_of_the_wall_at_the_crown():
    layered, plain = section().points, section(tread=None, belt=None, bead=None).points
    middle, all_of_it = layered[layered[:, 1] == 0.0, 0], plain[plain[:, 1] == 0.0, 0]
    assert middle == pytest.approx([0.264, 0.267, 0.270, 0.274, 0.278], abs=EXACT)
    assert all_of_it == pytest.approx([0.264, 0.271, 0.278], abs=EXACT)


@pytest.mark.parametrize(
    ("rows", "belt", "core"), [(2, 1, 1), (3, 1, 2), (3, 2, 1), (5, 2, 3)], ids=str
)
def test_belt_and_core_take_their_rows_of_the_body(rows, belt, core):
    mesh = section(
        elements_through=rows,
        belt=Belt(material="belt", elements_through=belt),
        bead=Bead(material="steel", elements_through=core),
    )
    assert np.count_nonzero(mesh.material == 2) == 20 * belt
    assert np.count_nonzero(mesh.material == 3) == 2 * core
    assert region(mesh, "belt")[..., 0].max() == pytest.approx(0.270, abs=EXACT)
    assert area(mesh, "belt") == pytest.approx(0.003 * 0.115, rel=CHORDS)


def test_rows_become_even_from_the_core_to_the_widest_place():
    # the core is thicker than the sidewall: its share of the wall is kept, not its thickness
    thin = Thickness(sidewall=0.004)
    mesh = section(bead=Bead(material="steel", thickness=0.009), thickness=thin, elements_along=80)
    columns = mesh.points[: 3 * 20].reshape(20, 3, 2)
    wall = np.linalg.norm(columns[:, 2] - columns[:, 0], axis=1)
    share = np.linalg.norm(columns[:, 1] - columns[:, 0], axis=1) / wall
    assert share[0] == pytest.approx(0.75, abs=1e-9)
    assert np.all(np.diff(share[2:]) <= 1e-9)
    assert share[-1] == pytest.approx(0.5, abs=0.01)


@both
def test_each_region_may_stand_alone(quadratic):
    tread = section(quadratic, elements_through=1, belt=None, bead=None)
    belt = section(quadratic, tread=None, bead=None)
    core = section(quadratic, tread=None, belt=None)
    assert tread.materials == ("rubber", "tread")
    assert belt.materials == ("rubber", "belt")
    assert core.materials == ("rubber", "steel")
    assert min(determinants(mesh).min() for mesh in (tread, belt, core)) > 0.0


# its surfaces


@both
@pytest.mark.parametrize("name", ["outer", "inner"])
def test_surfaces_are_continuous_from_rim_to_rim(quadratic, name):
    mesh = section(quadratic)
    edges = getattr(mesh, name)
    assert np.array_equal(edges[1:, 0], edges[:-1, 1])
    assert len(np.unique(edges[:, :2])) == len(edges) + 1  # no node twice
    ends = edges[0, 0], edges[-1, 1]
    assert set(ends) <= set(mesh.rim.tolist())
    assert mesh.points[ends[0], 1] < 0.0 < mesh.points[ends[1], 1]


@both
def test_the_surfaces_and_the_rim_are_the_whole_boundary(quadratic):
    mesh = section(quadratic)
    q = mesh.quads[:, :4]
    sides = np.sort(np.stack([q, np.roll(q, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges, count = np.unique(sides, axis=0, return_counts=True)
    rim = np.isin(edges, mesh.rim).all(axis=1)
    boundary = {tuple(edge) for edge in edges[(count == 1) & ~rim].tolist()}
    lines = np.sort(np.vstack([mesh.outer[:, :2], mesh.inner[:, :2]]), axis=1)
    assert boundary == {tuple(edge) for edge in lines.tolist()}
    assert len(mesh.outer) == 40 + 4
    assert len(mesh.inner) == 40


def test_mid_sides_of_surfaces_are_those_of_their_elements():
    mesh = section(quadratic=True)
    q = mesh.quads
    middle = {
        frozenset((a, b)): m
        for k in range(4)
        for a, b, m in zip(q[:, k], q[:, (k + 1) % 4], q[:, 4 + k], strict=True)
    }
    for edges in (mesh.outer, mesh.inner):
        assert [middle[frozenset((a, b))] for a, b, _ in edges] == edges[:, 2].tolist()


@both
def test_half_way_along_the_outer_surface_is_mid_tread(quadratic):
    surface = Surface(revolve(section(quadratic), np.pi / 30.0, 1), "outer")
    spots = surface.spots(np.array([0.5, 0.3, 0.7]), np.zeros(3))
    assert spots.r[0] == pytest.approx(0.278, abs=EXACT)
    assert spots.y == pytest.approx([0.0, spots.y[1], -spots.y[1]], abs=1e-12)
    assert spots.y[1] < 0.0


# what does not fit


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"tread": Tread(material="t", buttress=0.05)},
            "case: geometry.tread.buttress: 0.05 m is too large; must be below 0.04558 m, the "
            "way along the profile from the tread's edge to the widest place",
        ),
        (
            {"belt": Belt(material="b", width=0.15)},
            "case: geometry.belt.width: 0.15 m is too wide; must be at most 0.14192 m, the width "
            "of the tread's foot (tread_width and twice tread.buttress, along the profile)",
        ),
        (
            {"belt": Belt(material="b", width=0.25), "tread": None},
            "case: geometry.belt.width: 0.25 m is too wide; must be at most 0.22128 m, the width "
            "of the profile between the widest places",
        ),
        (
            {"bead": Bead(material="s", height=0.05, thickness=0.01)},
            "case: geometry.bead.thickness: 0.01 m is too large; must be below 0.00608 m, the "
            "body's thickness at the core's top",
        ),
        (
            {"belt": Belt(material="b", width=0.2, thickness=0.01), "tread": None},
            "case: geometry.belt.thickness: 0.01 m is too large; must be below 0.00720 m, the "
            "body's thickness at the belt's edge",
        ),
        (
            {"elements_along": 4, "tread": Tread(material="t"), "bead": Bead(material="s")},
            "case: geometry.elements_along: 4 is too few for the regions of the section; must be "
            "at least 8",
        ),
        (
            {"tread": Tread(material="t", elements_along=2)},
            "case: geometry.tread.elements_along: 2 is too few for a belt narrower than the "
            "tread's foot; must be at least 4",
        ),
    ],
)
def test_a_region_that_does_not_fit_is_refused_with_its_key(changes, message):
    with pytest.raises(CaseError) as caught:
        section(**changes)
    assert str(caught.value) == message


def test_a_region_that_just_fits_is_meshed():
    just = Belt(material="belt", width=0.14192)
    assert section(belt=just, tread=Tread(material="tread")).materials[2] == "belt"


lengths = st.floats(0.002, 0.03)
geometries = st.fixed_dictionaries(
    {},
    optional={
        "outer_radius": st.floats(0.24, 0.36),
        "inner_radius": st.floats(0.12, 0.2),
        "section_width": st.floats(0.12, 0.26),
        "rim_width": st.floats(0.06, 0.2),
        "tread_width": st.floats(0.05, 0.2),
        "crown_radius": st.floats(0.15, 2.0),
        "elements_along": st.integers(2, 30).map(lambda n: 2 * n),
        "elements_through": st.integers(1, 5),
        "thickness": st.builds(
            Thickness, crown=lengths, shoulder=lengths, sidewall=lengths, bead=lengths
        ),
        "tread": st.none()
        | st.builds(
            Tread,
            material=st.sampled_from(["rubber", "tread"]),
            thickness=lengths,
            edge_thickness=lengths,
            buttress=st.floats(0.0, 0.04),
            elements_along=st.none() | st.integers(1, 20).map(lambda n: 2 * n),
            elements_through=st.integers(1, 3),
        ),
        "belt": st.none()
        | st.builds(
            Belt,
            material=st.just("belt"),
            width=st.floats(0.01, 0.3),
            thickness=st.floats(0.001, 0.01),
            elements_through=st.integers(1, 3),
        ),
        "bead": st.none()
        | st.builds(
            Bead,
            material=st.sampled_from(["steel", "rubber"]),
            height=st.floats(0.001, 0.08),
            thickness=st.floats(0.001, 0.01),
            elements_through=st.integers(1, 3),
        ),
    },
)


@settings(max_examples=400)  # most do not fit
@given(changes=geometries, quadratic=st.booleans())
def test_any_sizes_give_a_sound_section_or_an_error(changes, quadratic):
    try:
        mesh = section(quadratic, **changes)
    except (ValidationError, CaseError, MeshError):
        return
    assert determinants(mesh).min() > -1e-12
    assert mirrored(mesh) == quadrilaterals(mesh)
    assert np.array_equal(mesh.outer[1:, 0], mesh.outer[:-1, 1])
    assert np.array_equal(np.unique(mesh.quads), np.arange(mesh.n_nodes))
    assert set(np.unique(mesh.material)) == set(range(len(mesh.materials)))
