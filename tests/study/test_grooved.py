"""A grooved tyre answers alike however its cell is cut, counted or solved.

Angle 0 of the ring is where a cell begins. Turned by the groove's offset, with its loads and
probes, the tyre is the same one, though sections now stand in blocks, in walls or in grooves: the
strongest check of what is missing where, of layers that are not equally thick and of places.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from rings import UNDAMPED, Ring
from small import case_with

from tyrefrf.case import parse_case
from tyrefrf.errors import CaseError
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.mesh.cell import revolve_between
from tyrefrf.mesh.surface import Surface
from tyrefrf.solvers import Recursive, solve_line
from tyrefrf.solvers.symmetry import shares
from tyrefrf.study.certify import refined_case
from tyrefrf.study.estimate import estimate
from tyrefrf.study.model import build_mesh, build_model
from tyrefrf.study.modes import modes_of_case, nodal_diameters
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import sweep

ROUND_OFF = 1e-9

TEXT = """\
[geometry]
elements_along = 8
material = "rubber"

[geometry.tread]
material = "rubber"
elements_along = 4

[geometry.tread.grooves]
width = "{width} mm"
depth = "6 mm"
offset = {offset!r}
number = {number}

[materials.rubber]
E = "80 MPa"
nu = 0.42
rho = 1200.0
eta = 0.1

[cell]
sector_angle = {sector_angle!r}
elements_around = {around}
element = "{element}"

[inflation]
pressure = "{pressure} bar"
kind = "{kind}"

[solver]
name = "{solver}"

[frequency]
values = [150.0, 420.0]

[[loads]]
name = "block"
kind = "patch"
s = 0.45
angle = {offset!r}
direction = "r"

[[loads]]
name = "wall"
s = 0.5
angle = {wall!r}
direction = "theta"

[[probes]]
name = "under a groove"
surface = "inner"
s = 0.41
angle = {under!r}
direction = "y"
"""

USUAL = {
    "width": 28, "offset": 0.0, "number": 1, "sector_angle": 24.0, "around": 6, "element": "hex8i",
    "pressure": 0, "kind": "linear", "solver": "recursive",
}  # fmt: skip
WALL = 12.0 - np.rad2deg(0.014 / 0.278)  # where the groove begins [deg], with no offset


def grooved(**changes):
    """A coarse tyre with 15 grooves; loads and probes are turned by the offset with them."""
    values = {**USUAL, **changes}
    middle = values["sector_angle"] / values["number"] / 2.0
    wall = middle - 12.0 + WALL + values["offset"]
    places = {"wall": float(wall), "under": float(middle + 24.0 + values["offset"])}
    return parse_case(TEXT.format(**values, **places), "grooved.toml", "grooved")


@cache
def receptances(**changes):
    return run_case(grooved(**changes), jobs=1).receptance


def layer_angles(**changes):
    """Angles [deg] by which the grooves may be turned for a cut at each layer right of them."""
    mesh = build_mesh(grooved(**changes))
    planes = mesh.plane_angles[:: 2 if mesh.bricks.shape[1] == 20 else 1]
    return [float(np.rad2deg(mesh.sector_angle - planes[-1 - k])) for k in range(1, 6)]


def worst(found, expected):
    return abs(found - expected).max() / abs(expected).max()


BLOCK, AT_WALL, THROUGH, AT_OTHER_WALL = range(4)
"""Layers from the cell's boundary to the groove's middle and on: where the tyre is cut."""


@pytest.mark.parametrize(
    ("element", "cut", "solver"),
    [
        ("hex8i", BLOCK, "recursive"),
        ("hex8i", AT_WALL, "recursive"),
        ("hex8i", AT_WALL, "cyclic"),
        ("hex8i", THROUGH, "recursive"),
        ("hex8i", THROUGH, "cyclic"),
        ("hex8i", AT_OTHER_WALL, "recursive"),
        ("hex20r", THROUGH, "recursive"),
    ],
)
def test_the_answer_does_not_depend_on_where_the_cell_is_cut(element, cut, solver):
    offset = layer_angles(element=element)[cut]
    turned = receptances(element=element, offset=offset, solver=solver)
    assert worst(turned, receptances(element=element)) < ROUND_OFF


@pytest.mark.parametrize("cut", [pytest.param(AT_WALL, marks=pytest.mark.long), THROUGH])
def test_an_inflated_tyre_does_not_depend_on_it_either(cut):
    inflated = {"pressure": 1, "kind": "nonlinear", "element": "hex20r"}
    offset = layer_angles(element="hex20r")[cut]
    found = run_case(grooved(offset=offset, **inflated), jobs=1)
    assert worst(found.receptance, receptances(**inflated)) < ROUND_OFF
    state = found.inflation
    assert len(state.stress) == found.section.n_elements == (12 if cut == THROUGH else 16)
    assert len(state.displacement) == found.section.n_nodes


def test_cells_of_two_grooves_are_half_as_many_of_one():
    one = receptances(sector_angle=30.0)
    two = grooved(sector_angle=60.0, number=2, around=12)
    assert worst(run_case(two, jobs=1).receptance, one) < ROUND_OFF


@pytest.mark.parametrize("solver", ["cyclic", "direct"])
def test_solvers_agree(solver):
    assert worst(receptances(solver=solver), receptances()) < ROUND_OFF


@pytest.mark.parametrize(
    "element", ["hex8", "hex20r", pytest.param("hex20", marks=pytest.mark.long)]
)
def test_solvers_agree_on_every_element(element):
    cyclic = receptances(element=element, solver="cyclic")
    assert worst(cyclic, receptances(element=element)) < ROUND_OFF


def test_both_mirrors_are_found_where_the_groove_is_central():
    found = shares(build_model(grooved()).problem.cell)
    assert len(found) == 2
    assert all(share.n_even is not None for share in found)
    turned = shares(build_model(grooved(offset=layer_angles()[BLOCK])).problem.cell)
    assert [share.n_even for share in turned] == [None, None]


def test_grooves_are_as_if_filled_with_next_to_nothing():
    """The same layers with every brick there, those in the grooves 1e9 times softer and lighter."""
    mesh = build_mesh(grooved())
    filled = revolve_between(mesh.section, mesh.plane_angles, np.ones_like(mesh.present))
    void = np.where(mesh.present.ravel(), 0, 1)
    filled = replace(filled, material=void, materials=("rubber", "void"))
    rubber = grooved().materials["rubber"]
    void = rubber.model_copy(update={"E": 1e-9 * rubber.E, "rho": 1e-9 * rubber.rho})
    found = []
    for cell in (mesh, filled):
        ring = Ring(cell, {"rubber": rubber, "void": void}, ELEMENTS["hex8i"], 15, UNDAMPED)
        top = int(np.argmax(cell.section.points[:, 0]))
        problem = ring.problem(ring.point_loads((0, top, 0), (4, top, 2), (7, 3, 1)))
        found.append(solve_line(problem, Recursive(problem), 2.0 * np.pi * 420.0).receptance)
    assert worst(found[1], found[0]) < 1e-7


def test_the_lighter_tread_shows():
    plain = grooved().model_copy(
        update={"geometry": grooved().geometry.model_copy(update={"tread": PLAIN})}
    )
    change = worst(run_case(plain, jobs=1).receptance, receptances())
    assert 0.01 < change < 1.0


PLAIN = grooved().geometry.tread.model_copy(update={"grooves": None})


def split_of(case):
    """Relative gap of the two modes with half as many diameters as there are cells."""
    modes = modes_of_case(case, count=80)
    pair = modes.frequency[modes.diameters == 6]
    assert modes.order[modes.diameters == 6].tolist() == [6] * len(pair)
    return abs(pair[1] - pair[0]) / pair[0]


def test_grooves_split_the_pair_with_half_as_many_diameters_as_grooves():
    """cos(n theta) has its crests on blocks, sin its own on grooves; 12 grooves, n = 6."""
    third = {"sector_angle": 30.0}  # 12 cells
    case = grooved(**third)
    width = 0.278 * np.deg2rad(10.0)  # layers all of 5 degrees: the plain mesh splits nothing
    equal = case.geometry.tread.grooves.model_copy(update={"width": float(width)})
    tread = case.geometry.tread.model_copy(update={"grooves": equal})
    with_, without = (
        case.model_copy(update={"geometry": case.geometry.model_copy(update={"tread": t})})
        for t in (tread, PLAIN)
    )
    assert split_of(without) < ROUND_OFF
    assert split_of(with_) > 1e-3


@pytest.mark.parametrize("n", range(45))  # half of 15 cells of 6 planes
def test_diameters_are_told_apart_on_planes_that_are_not_evenly_spaced(n):
    mesh = build_mesh(grooved(width=8))
    order = min(n % 15, -n % 15)
    wave = np.exp(1j * n * mesh.points[: mesh.n_own, 2])[None, :, None] * np.ones((1, 1, 3))
    shape = wave if order == n % 15 else wave.conj()
    assert nodal_diameters(mesh, 15, order, shape).tolist() == [n]


@pytest.mark.parametrize("offset", [0.0, 6.0, 12.0])
@pytest.mark.parametrize("element", ["hex8i", "hex20"])
def test_places_are_where_the_case_says(element, offset):
    """On blocks the surface is the plain tyre's; all round, next to either wall."""
    case = grooved(element=element, offset=offset)
    mesh = build_mesh(case)
    half = 12.0 - WALL
    angle = np.concatenate([np.linspace(half, 24.0 - half, 7) + 24.0 * k for k in range(15)])
    angle = np.deg2rad(angle + 12.0 + offset)
    spots = Surface(mesh, "outer").spots(np.full(len(angle), 0.5), angle)
    np.testing.assert_allclose(np.exp(1j * spots.angle), np.exp(1j * angle), atol=1e-12)
    assert spots.r.max() == pytest.approx(0.278, abs=1e-12)
    ring = spots.cell[:, None] * mesh.sector_angle + mesh.points[spots.nodes, 2]
    assert np.ptp(np.unwrap(ring, axis=1), axis=1).max() < np.deg2rad(5.1)  # one layer of bricks
    x = np.einsum("ma,ma->m", spots.weights, mesh.points[spots.nodes, 1])
    np.testing.assert_allclose(x, 0.0, atol=1e-12)


def at(text):
    """Where the place of a load is refused: the case error's text."""
    with pytest.raises(CaseError) as refused:
        build_model(parse_case(text, "grooved.toml", "grooved"))
    return str(refused.value)


def test_a_place_over_a_groove_is_refused_with_the_nearest_on_a_block():
    text = grooved_text(wall=0.0, under=36.0)
    point = text.replace('surface = "inner"\ns = 0.41\nangle = 36.0', "s = 0.41\nangle = 34.0")
    assert "probes[0].s: at 34 deg there is a groove; the nearest angle on a block is 33.11" in at(
        point
    )
    patch = text.replace(
        'kind = "patch"\ns = 0.45\nangle = 0.0', 'kind = "patch"\ns = 0.45\nangle = 14.0'
    )
    found = at(patch)
    nearest = float(found.split("on a block is ")[1].split(" deg")[0])
    assert nearest == pytest.approx(24.0 - WALL + np.rad2deg(0.005 / 0.277), abs=0.05)
    parse_and_build = patch.replace("angle = 14.0", f"angle = {nearest}")
    build_model(parse_case(parse_and_build, "grooved.toml", "grooved"))


def test_a_disc_larger_than_every_block_is_refused():
    text = grooved_text(wall=0.0, under=36.0).replace(
        'kind = "patch"\ns = 0.45', 'kind = "patch"\ndiameter = 0.095\ns = 0.45'
    )
    assert "no block that is long enough; take a point or a smaller disc" in at(text)


def test_a_node_over_a_groove_snaps_to_the_wall():
    text = grooved_text(wall=11.0, under=36.0)
    place = build_model(parse_case(text, "grooved.toml", "grooved")).loads[1]
    assert np.rad2deg(place.angle) == pytest.approx(WALL)
    assert place.r == pytest.approx(0.278)


def test_a_node_in_the_cell_before_is_found():
    """The groove is cut through: no node of the tread stands at angle 0, nor in the first layer."""
    text = grooved_text(offset=12.0, wall=359.0, under=36.0).replace("angle = 12.0", "angle = 9.0")
    place = build_model(parse_case(text, "grooved.toml", "grooved")).loads[1]
    assert np.rad2deg(place.angle) == pytest.approx(348.0 + WALL)


def grooved_text(**changes):
    return TEXT.format(**{**USUAL, **changes})


def test_a_grooved_cell_is_refined_by_twice_its_elements_around():
    case = grooved(around=5)
    model = build_model(case)
    finer = build_model(refined_case(case, model))
    assert finer.problem.n_cells == 15
    assert finer.mesh.plane_angles[::2] == pytest.approx(model.mesh.plane_angles, abs=1e-15)
    for a, b in zip(model.loads + model.probes, finer.loads + finer.probes, strict=True):
        assert (b.s, b.y, b.angle) == pytest.approx((a.s, a.y, a.angle), abs=1e-12)


def test_check_says_what_the_grooves_are_meshed_as():
    found = estimate(grooved(), jobs=1)
    assert found.grooves == (
        "15 grooves, 28 mm wide (2 of 6 elements around a cell) and 6 mm deep (1 of 2 rows), "
        "between blocks of 88.45 mm"
    )
    assert estimate(case_with(), jobs=1).grooves == ""


def test_the_depth_can_be_swept():
    study = sweep(grooved(solver="cyclic"), {"depth": ["2 mm", "6 mm"]}, jobs=1)
    assert study.axes[0].place == "geometry.tread.grooves.depth"
    np.testing.assert_array_equal(study.receptance[1], receptances(solver="cyclic"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('depth = "6 mm"', 'depth = "9 mm"', "grooved.toml:11: geometry.tread.grooves.depth: "
         "0.009 m is deeper than the tread; must be at most thickness = 0.008 m"),
        ("elements_along = 4", "elements_through = 1", "grooved.toml:7: geometry.tread."
         "elements_through: 1 leaves no element under the grooves; must be at least 2"),
        ("number = 1", 'rib = "125 mm"', "grooved.toml:13: geometry.tread.grooves.rib: 0.125 m is "
         "too large; must be below tread_width = 0.125 m"),
        ('[geometry.tread]\nmaterial = "rubber"\nelements_along = 4\n', "",
         "geometry.tread.material: missing"),
        ("number = 1", "number = 0", "grooved.toml:13: geometry.tread.grooves.number"),
        ("number = 1", 'sides = "left"', "grooved.toml:13: geometry.tread.grooves.sides"),
    ],
)  # fmt: skip
def test_grooves_that_do_not_fit_the_tread_are_refused_at_their_line(old, new, message):
    text = grooved_text(wall=0.0, under=36.0)
    assert old in text
    assert message in at(text.replace(old, new))


def test_a_groove_through_the_whole_tread_needs_no_row_under_it():
    text = grooved_text(wall=0.0, under=36.0).replace('"6 mm"', '"8 mm"')
    case = parse_case(text.replace("elements_along = 4", "elements_through = 1"), "g.toml", "g")
    mesh = build_mesh(case)
    floor = mesh.section.without(~mesh.present[2])
    assert floor.points[:, 0].max() == pytest.approx(0.270, abs=1e-12)
