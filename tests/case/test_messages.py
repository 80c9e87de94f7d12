"""Every message, word for word: where, what was found, what is expected, what to try."""

from __future__ import annotations

import pytest

from tyrefrf.case import parse_case
from tyrefrf.errors import CaseError

LOAD = 'name = "radial"\ns = 0.5\ndirection = "r"\n'
RANGE = "stop = 2000\nstep = 5\n"
PROBE = '[[probes]]\nname = "p"\ndirection = "r"\ns = 0.1\n'


def messages(text: str, name: str = "small") -> list[str]:
    with pytest.raises(CaseError) as caught:
        parse_case(text, "t.toml", name)
    return str(caught.value).splitlines()


# what is changed in the small case: old text, new text, then every line that is reported
ONE_CHANGE = {
    "unknown key": (
        "rho = 1200\n",
        "rho = 1200\netha = 0.1\n",
        "7: materials.rubber.etha: unknown key for kind 'isotropic'; did you mean 'eta'?",
    ),
    "unknown key like nothing": (
        "rho = 1200\n",
        "rho = 1200\ncolour = 'black'\n",
        "7: materials.rubber.colour: unknown key for kind 'isotropic'; "
        "the keys here are E, nu, rho, eta, modulus, E_static, kind",
    ),
    "unknown table": (
        "[cell]\n",
        "[sell]\n[cell]\n",
        "7: sell: unknown key; did you mean 'cell'?",
    ),
    "unknown key of a load": (
        LOAD,
        LOAD + "diameter = 1\n",
        "16: loads[0].diameter: unknown key for kind 'node'; "
        "the keys here are name, angle, direction, node, surface, s, kind",
    ),
    "missing key": (
        'E = "80 MPa"\n',
        "",
        "3: materials.rubber.E: missing: Young's modulus [Pa]",
    ),
    "missing key of a load": (
        'name = "radial"\n',
        "",
        "12: loads[0].name: missing: name, unique among the loads or the probes; "
        "one line of up to 100 characters",
    ),
    "missing table": (
        "[cell]\nsector_angle = 8\n",
        "",
        "1: cell: missing: the angular cell that repeats around the axle",
    ),
    "text for a number": (
        "nu = 0.42",
        "nu = '0.42'",
        "5: materials.rubber.nu: '0.42' is not a number",
    ),
    "boolean for a quantity": (
        "rho = 1200",
        "rho = true",
        "6: materials.rubber.rho: true is not a number [kg/m3] "
        "or text with a unit (kg/m3, g/cm3, kg/dm3, t/m3)",
    ),
    "fraction for a count": (
        "[cell]\n",
        "[cell]\nelements_around = 1.0\n",
        "8: cell.elements_around: 1.0 is not a whole number",
    ),
    "number for a table": (
        "[cell]\nsector_angle = 8\n",
        "cell = 8\n",
        "1: cell: missing: the angular cell that repeats around the axle",
        "7: materials.rubber.cell: unknown key for kind 'isotropic'; "
        "the keys here are E, nu, rho, eta, modulus, E_static, kind",
    ),
    "number for a load": (
        "[[loads]]\n" + LOAD,
        "[output]\n",
        "1: loads: missing: the loads, each as [[loads]]",
    ),
    "number for text": (
        'name = "radial"',
        "name = 3",
        "13: loads[0].name: 3 is not text in quotes",
    ),
    "date": (
        "sector_angle = 8",
        "sector_angle = 1979-05-27",
        "8: cell.sector_angle: the date or time 1979-05-27 is not a number [deg] "
        "or text with a unit (deg, rad)",
    ),
    "infinity": ("rho = 1200", "rho = inf", "6: materials.rubber.rho: inf is not a finite number"),
    "nan": ("nu = 0.42", "nu = nan", "5: materials.rubber.nu: nan is not a finite number"),
    # units and ranges
    "unknown unit": (
        '"80 MPa"',
        '"80 barr"',
        "4: materials.rubber.E: unknown unit 'barr'; use one of Pa, kPa, MPa, GPa, bar; "
        "did you mean 'bar'?",
    ),
    "no unit": (
        '"80 MPa"',
        '"80"',
        "4: materials.rubber.E: '80' has no unit; use one of Pa, kPa, MPa, GPa, bar",
    ),
    "no number": (
        '"80 MPa"',
        '"soft"',
        "4: materials.rubber.E: 'soft' is not a number with a unit; "
        "use one of Pa, kPa, MPa, GPa, bar",
    ),
    "quantity out of range": (
        '"80 MPa"',
        '"0 MPa"',
        "4: materials.rubber.E: 0 MPa is out of range; must be at least 1 Pa",
    ),
    "number out of range": (
        "nu = 0.42",
        "nu = 0.5",
        "5: materials.rubber.nu: 0.5 is out of range; must be below 0.5",
    ),
    "unknown choice": (
        "[cell]\n",
        "[cell]\nelement = 'hex20i'\n",
        "8: cell.element: 'hex20i' is not one of hex8i, hex8, hex20, hex20r; did you mean 'hex20'?",
    ),
    "unknown kind": (
        "s = 0.5",
        "kind = 'pach'",
        "14: loads[0].kind: 'pach' is not one of node, patch; did you mean 'patch'?",
    ),
    # the cell
    "angle that does not divide the turn": (
        "sector_angle = 8",
        "sector_angle = 7",
        "8: cell.sector_angle: 7 deg does not divide 360 deg; nearest: 7.2 deg (50 cells)",
    ),
    "angle near the whole turn": (
        "sector_angle = 8",
        "sector_angle = 350",
        "8: cell.sector_angle: 350 deg does not divide 360 deg; nearest: 360 deg (1 cell)",
    ),
    "angle of a million cells": (
        "sector_angle = 8",
        "sector_angle = 0.00036",
        "8: cell.sector_angle: 0.00036 deg is too small; "
        "must be at least 0.0036 deg (100000 cells)",
    ),
    "ring without volume": (
        "sector_angle = 8",
        "sector_angle = 180",
        "7: cell.elements_around: 2 elements around the tyre enclose no volume; "
        "must be at least 2 with 2 cell(s)",
    ),
    # frequency lines
    "no range": (
        RANGE,
        "",
        "9: frequency: has no lines; give values = [...], or stop with step or count",
    ),
    "no step": ("step = 5\n", "", "9: frequency: has no step; give step [Hz] or count"),
    "step and count": (
        "step = 5\n",
        "step = 5\ncount = 3\n",
        "12: frequency.count: not together with step; give one of the two",
    ),
    "stop before start": (
        "stop = 2000",
        "stop = 2000\nstart = '3 kHz'",
        "10: frequency.stop: 2000 Hz is too small; must be above start = 3000 Hz",
    ),
    "step beyond the range": (
        "step = 5",
        "step = 5000",
        "11: frequency.step: 5000 Hz is too large; must be at most stop - start = 2000 Hz",
    ),
    "too many lines": (
        "step = 5",
        "step = 0.001",
        "11: frequency.step: makes 2000001 lines; must make at most 1000000",
    ),
    "lines too close": (
        RANGE,
        "stop = 1\ncount = 100000\n",
        "11: frequency.count: puts lines closer than 0.001 Hz; use fewer",
    ),
    "list and range": (
        RANGE,
        "values = [1, 2]\nstop = 3\n",
        "11: frequency.stop: belongs to a range; values stands alone",
    ),
    "list out of order": (
        RANGE,
        "values = [1, 3,\n 2, 1]\n",
        "11: frequency.values[2]: 2 Hz after 3 Hz; list the lines in increasing order",
    ),
    "empty list": (RANGE, "values = []\n", "10: frequency.values: is empty; must have at least 1"),
    "negative line": (
        RANGE,
        "values = [-1]\n",
        "10: frequency.values[0]: -1 Hz is out of range; must be at least 0 Hz",
    ),
    "log from zero by step": (
        RANGE,
        RANGE + "spacing = 'log'\n",
        "9: frequency.start: 0 Hz has no logarithm; must be above 0 Hz",
        "11: frequency.step: belongs to linear spacing; a log range takes count",
    ),
    # geometry
    "odd number of elements": (
        "[geometry]\n",
        "[geometry]\nelements_along = 27\n",
        "2: geometry.elements_along: 27 is odd; must be even, for a node at mid-tread; nearest: 28",
    ),
    "radii out of order": (
        "[geometry]\n",
        "[geometry]\nwidest_radius = 0.1\n",
        "1: geometry.inner_radius: 0.168 m is too large; must be below widest_radius = 0.1 m",
    ),
    "crown too round": (
        "[geometry]\n",
        "[geometry]\ncrown_radius = '50 mm'\n",
        "2: geometry.crown_radius: 0.05 m is too small; must be above tread_width/2 = 0.0625 m",
    ),
    "crown too thick": (
        "[geometry]\n",
        "[geometry]\nthickness.crown = '60 mm'\n",
        "2: geometry.thickness.crown: 0.06 m is too large; "
        "must be below outer_radius - widest_radius = 0.053 m",
    ),
    "tread too wide": (
        "[geometry]\n",
        "[geometry]\ntread_width = 0.17\n",
        "2: geometry.tread_width: 0.17 m is too large; must be below section_width = 0.17 m",
    ),
    "layer that is no table": (
        "[geometry]\n",
        "[geometry]\nbead = 'steel'\n",
        "2: geometry.bead: 'steel' is not a table",
    ),
    # places
    "angle beyond the turn": (
        "s = 0.5",
        "s = 0.5\nangle = 370",
        "15: loads[0].angle: 370 deg is not in 0 <= angle < 360; the same: 10 deg",
    ),
    "angle a hair below zero": (
        "s = 0.5",
        "s = 0.5\nangle = -1e-20",
        "15: loads[0].angle: -1e-20 deg is not in 0 <= angle < 360; the same: 0 deg",
    ),
    "no place": (
        "s = 0.5\n",
        "",
        "12: loads[0]: has no place; give s (0 to 1 along the surface) or node",
    ),
    "two places": (
        "s = 0.5",
        "s = 0.5\nnode = 3",
        "15: loads[0].node: not together with s; give one of the two",
    ),
    "surface of a node": (
        "s = 0.5",
        "node = 3\nsurface = 'inner'",
        "15: loads[0].surface: not together with node; node has a surface of its own",
    ),
    "s off the tyre": (
        "s = 0.5",
        "s = 1.5",
        "14: loads[0].s: 1.5 is out of range; must be at most 1",
    ),
    # between tables
    "undefined material": (
        'material = "rubber"',
        'material = "ruber"',
        "2: geometry.material: undefined material 'ruber'; [materials] has 'rubber'; "
        "did you mean 'rubber'?",
    ),
    "unused material": (
        "[cell]",
        "[materials.steel]\nE = '200 GPa'\nnu = 0.3\nrho = 7800\n[cell]",
        "7: materials.steel: no region uses this material; "
        "remove it, or name it in geometry.material",
    ),
    "no material": (
        '[materials.rubber]\nE = "80 MPa"\nnu = 0.42\nrho = 1200\n',
        "[materials]\n",
        "3: materials: is empty; must have at least 1",
    ),
    "load named twice": (
        LOAD,
        f"{LOAD}[[loads]]\n{LOAD}",
        "17: loads[1].name: 'radial' is the name of loads[0] already; must be unique",
    ),
    "probe named twice": (
        LOAD,
        LOAD + PROBE * 2,
        "21: probes[1].name: 'p' is the name of probes[0] already; must be unique",
    ),
    "reserved name": (
        LOAD,
        LOAD + PROBE.replace('"p"', '"radial.drive"'),
        "17: probes[0].name: 'radial.drive' is reserved for the driving point of load 'radial'",
    ),
    "two hubs": (
        LOAD,
        LOAD + "[[probes]]\nkind = 'hub'\n" * 2,
        "19: probes[1].kind: a second hub probe; one gives all six components",
    ),
    # names and output
    "name of a path": (
        "[geometry]\n",
        "name = 'a/b'\n[geometry]\n",
        "1: name: 'a/b' is not valid; expected: name of the case and its results (default: the "
        "file's); up to 100 letters, digits, '.', '_' and '-', beginning with a letter or digit",
    ),
    "material without a name": (
        "[cell]",
        '[materials.""]\nE = 1\nnu = 0\nrho = 1\n[cell]',
        "7: materials.'': '' is not valid; expected: one line of 1 to 100 characters",
        "7: materials.'': no region uses this material; remove it, or name it in geometry.material",
    ),
    "unknown plot format": (
        "[cell]",
        "[output]\nplots = ['png',\n'PDF']\n[cell]",
        "9: output.plots[1]: 'PDF' is not one of png, pdf, svg; did you mean 'pdf'?",
    ),
    "plot format twice": (
        "[cell]",
        "[output]\nplots = ['png',\n'png']\n[cell]",
        "9: output.plots[1]: 'png' is listed twice",
    ),
}


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [(old, new, expected) for old, new, *expected in ONE_CHANGE.values()],
    ids=ONE_CHANGE,
)
def test_one_change_gives_exactly_this_message(small, old, new, expected):
    assert old in small
    assert messages(small.replace(old, new, 1)) == [f"t.toml:{line}" for line in expected]


LAYERS = """\
[geometry]
elements_along = 40
elements_through = 2
material = "rubber"
[geometry.tread]
material = "rubber"
[geometry.belt]
material = "rubber"
[geometry.bead]
material = "rubber"
"""

# what is changed in the small case with layers: old text, new text, every line reported
ONE_LAYER = {
    "layer without a material": (
        '[geometry.tread]\nmaterial = "rubber"\n',
        "[geometry.tread]\n",
        "5: geometry.tread.material: missing: name of the tread's material, one of [materials]",
    ),
    "unknown key": (
        "[geometry.belt]\n",
        "[geometry.belt]\nwide = 0.1\n",
        "8: geometry.belt.wide: unknown key; did you mean 'width'?",
    ),
    "unknown layer": (
        "[geometry.belt]\n",
        "[geometry.belts]\n",
        "7: geometry.belts: unknown key; did you mean 'belt'?",
    ),
    "undefined material": (
        '[geometry.belt]\nmaterial = "rubber"',
        '[geometry.belt]\nmaterial = "ruber"',
        "8: geometry.belt.material: undefined material 'ruber'; [materials] has 'rubber'; "
        "did you mean 'rubber'?",
    ),
    "undefined materials": (
        'material = "rubber"\n[geometry.tread]\nmaterial = "rubber"',
        'material = "rbber"\n[geometry.tread]\nmaterial = "tread"',
        "4: geometry.material: undefined material 'rbber'; [materials] has 'rubber'; "
        "did you mean 'rubber'?",
        "6: geometry.tread.material: undefined material 'tread'; [materials] has 'rubber'",
    ),
    "unused material": (
        "[cell]",
        "[materials.steel]\nE = '200 GPa'\nnu = 0.3\nrho = 7800\n[cell]",
        "15: materials.steel: no region uses this material; remove it, or name it in "
        "geometry.material, geometry.tread.material, geometry.belt.material, "
        "geometry.bead.material",
    ),
    "tread of an odd number of elements": (
        "[geometry.tread]\n",
        "[geometry.tread]\nelements_along = 23\n",
        "6: geometry.tread.elements_along: 23 is odd; must be even, for a node at mid-tread; "
        "nearest: 24",
    ),
    "tread of no elements": (
        "[geometry.tread]\n",
        "[geometry.tread]\nelements_along = 0\n",
        "6: geometry.tread.elements_along: 0 is out of range; must be at least 2",
    ),
    "tread longer than the section": (
        "[geometry.tread]\n",
        "[geometry.tread]\nelements_along = 40\n",
        "6: geometry.tread.elements_along: 40 leaves too few for the sidewalls and beads; "
        "must be at most 36 with elements_along = 40",
    ),
    "tread as thick as the wall": (
        "[geometry.tread]\n",
        "[geometry.tread]\nthickness = '14 mm'\n",
        "6: geometry.tread.thickness: 0.014 m is too large; must be below thickness.crown = "
        "0.014 m",
    ),
    "tread's edge as thick as the wall": (
        "[geometry.tread]\n",
        "[geometry.tread]\nedge_thickness = '17 mm'\n",
        "6: geometry.tread.edge_thickness: 0.017 m is too large; must be below "
        "thickness.shoulder = 0.016 m",
    ),
    "belt as thick as what is under the tread": (
        "[geometry.belt]\n",
        "[geometry.belt]\nthickness = '6 mm'\n",
        "8: geometry.belt.thickness: 0.006 m is too large; must be below thickness.crown - "
        "tread.thickness = 0.006 m",
    ),
    "belt of all elements": (
        "[geometry.belt]\n",
        "[geometry.belt]\nelements_through = 2\n",
        "3: geometry.elements_through: 2 leaves no element for the carcass under the belt; "
        "must be at least 3, one more than belt.elements_through",
    ),
    "core as thick as the bead": (
        "[geometry.bead]\n",
        "[geometry.bead]\nthickness = '12 mm'\n",
        "10: geometry.bead.thickness: 0.012 m is too large; must be below thickness.bead = 0.012 m",
    ),
    "core as high as the widest place": (
        "[geometry.bead]\n",
        "[geometry.bead]\nheight = '60 mm'\n",
        "10: geometry.bead.height: 0.06 m is too large; must be below widest_radius - "
        "inner_radius = 0.057 m",
    ),
    "core of all elements": (
        "elements_through = 2",
        "elements_through = 1",
        "3: geometry.elements_through: 1 leaves no element for the carcass under the belt; "
        "must be at least 2, one more than belt.elements_through",
        "3: geometry.elements_through: 1 leaves no element for the carcass outside the bead's "
        "core; must be at least 2, one more than bead.elements_through",
    ),
}


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [(old, new, expected) for old, new, *expected in ONE_LAYER.values()],
    ids=ONE_LAYER,
)
def test_one_change_of_a_layer_gives_exactly_this_message(small, old, new, expected):
    text = small.replace('[geometry]\nmaterial = "rubber"\n', LAYERS)
    assert old in text
    parse_case(text, "t.toml", "small")
    assert messages(text.replace(old, new, 1)) == [f"t.toml:{line}" for line in expected]


MANY = """\
titel = "x"
[geometry]
materal = "rubber"
outer_radius = "278 mmm"
[materials.tread]
etha = 0.1
E = "28 Mpa"
nu = 0.5
[cell]
sector_angle = 7
[frequency]
stop = 100
[[loads]]
name = "a"
direction = "x"
s = 0.5
[[loads]]
name = "a"
s = 2
direction = "r"
[[probes]]
name = "a.drive"
direction = "r"
s = 0.5
[output]
plots = ["png",
  3]
"""


def test_all_problems_of_a_file_are_reported_at_once_in_its_order():
    assert messages(MANY) == [
        "t.toml:1: titel: unknown key; did you mean 'title'?",
        "t.toml:2: geometry.material: missing: name of the section's material, one of [materials]",
        "t.toml:3: geometry.materal: unknown key; did you mean 'material'?",
        "t.toml:4: geometry.outer_radius: unknown unit 'mmm'; use one of m, cm, mm, um; "
        "did you mean 'mm'?",
        "t.toml:5: materials.tread.rho: missing: density [kg/m3]",
        "t.toml:6: materials.tread.etha: unknown key for kind 'isotropic'; did you mean 'eta'?",
        "t.toml:7: materials.tread.E: unknown unit 'Mpa'; use one of Pa, kPa, MPa, GPa, bar; "
        "did you mean 'MPa'?",
        "t.toml:8: materials.tread.nu: 0.5 is out of range; must be below 0.5",
        "t.toml:10: cell.sector_angle: 7 deg does not divide 360 deg; nearest: 7.2 deg (50 cells)",
        "t.toml:11: frequency: has no step; give step [Hz] or count",
        "t.toml:15: loads[0].direction: 'x' is not one of r, y, theta",
        "t.toml:18: loads[1].name: 'a' is the name of loads[0] already; must be unique",
        "t.toml:19: loads[1].s: 2 is out of range; must be at most 1",
        "t.toml:22: probes[0].name: 'a.drive' is reserved for the driving point of load 'a'",
        "t.toml:27: output.plots[1]: 3 is not one of png, pdf, svg",
    ]


def test_several_faults_between_the_keys_of_one_table_are_reported_together(small):
    text = small.replace("[geometry]", "[geometry]\ntread_width = 1\nrim_width = 1")
    assert messages(text) == [
        "t.toml:1: geometry.crown_radius: 0.4 m is too small; must be above tread_width/2 = 0.5 m",
        "t.toml:2: geometry.tread_width: 1 m is too large; must be below section_width = 0.17 m",
        "t.toml:3: geometry.rim_width: 1 m is too large; must be below section_width = 0.17 m",
    ]


def test_an_array_that_is_too_long_is_refused(small):
    load = '[[loads]]\nname = "{}"\ns = 0.5\ndirection = "r"\n'
    text = small + "".join(load.format(i) for i in range(1000))
    assert messages(text) == ["t.toml:12: loads: 1001 entries are too many; must be at most 1000"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "a = 1\nb 2\n",
            "2: not valid TOML: Expected '=' after a key in a key/value pair (column 3)",
        ),
        ("a = 1\na = 2\n", "2: not valid TOML: Cannot overwrite a value (column 6)"),
        ("a = [1,\n\n", "1: not valid TOML: Invalid value (at the end of the file)"),
    ],
)
def test_syntax_error(text, expected):
    assert messages(text) == [f"t.toml:{expected}"]


def test_number_of_five_thousand_digits():
    [message] = messages("a = " + "9" * 5000)
    assert message.startswith("t.toml:1: not valid TOML: Exceeds the limit (4300 digits)")


def test_toml_nested_too_deeply():
    assert messages("a = " + "[" * 5000) == ["t.toml:1: not valid TOML: nested too deeply"]


def test_a_huge_number_is_refused_and_not_printed(small):
    text = small.replace("rho = 1200", "rho = 0x" + "f" * 5000)
    assert messages(text) == [
        "t.toml:6: materials.rubber.rho: a huge number is not a finite number"
    ]


def test_long_text_is_shortened(small):
    [message] = messages(small.replace('direction = "r"', f'direction = "{"r" * 1000}"'))
    assert message == f"t.toml:15: loads[0].direction: '{'r' * 40}...' is not one of r, y, theta"


def test_a_file_name_that_is_no_case_name_asks_for_one(small):
    [message] = messages(small, name="my tyre")
    assert message.startswith("t.toml:1: name: 'my tyre' is not valid; expected: name of the case")
