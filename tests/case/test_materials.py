"""Materials of every kind: what is read, and every message, word for word."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from tyrefrf.case import (
    Isotropic,
    Orthotropic,
    Ply,
    Transverse,
    case_hash,
    parse_case,
    resolved,
    resolved_toml,
)
from tyrefrf.errors import CaseError

KINDS = {
    "isotropic": """\
E = "80 MPa"
nu = 0.42
rho = 1200
E_static = "60 MPa"
""",
    "orthotropic": """\
kind = "orthotropic"
E_1 = "900 MPa"
E_2 = 2e8
E_3 = 3e7
nu_12 = 0.4
nu_13 = 0.5
nu_23 = 0.6
G_12 = 6e7
G_13 = 4e7
G_23 = 1e7
rho = 800
eta = 0.05
angle = "0.5 rad"
""",
    "transverse": """\
kind = "transverse"
E_1 = 9e8
E_2 = 2e7
nu_12 = 0.4
nu_23 = 0.5
G_12 = 6e6
rho = 1200
angle = -20
""",
    "ply": """\
kind = "ply"
cord = { E = "2 GPa", nu = 0.3, rho = 1400 }
rubber = { E = "6 MPa", nu = 0.48, rho = 1100, eta = 0.1 }
volume_fraction = 0.3
angles = [20, -20]
shares = [1, 2]
""",
    "table": """\
nu = 0.42
rho = 1200
[materials.rubber.modulus]
kind = "table"
frequencies = [1, "1 kHz", 10000]
E = ["10 MPa", 2e7, 3e7]
eta = [0.1, 0.2, 0.3]
extrapolate = true
shift = { C1 = 8.86, C2 = 101.6, T_ref = 20, temperature = "40 degC" }
""",
    "prony": """\
nu = 0.42
rho = 1200
[materials.rubber.modulus]
kind = "prony"
E_inf = 1e7
g = [0.3, 0.2]
tau = ["1 ms", 1e-4]
""",
    "zener": """\
nu = 0.42
rho = 1200
[materials.rubber.modulus]
kind = "zener"
E_0 = 1e7
E_inf = 1e9
tau = "2 us"
alpha = 0.5
""",
}
PLAIN = 'E = "80 MPa"\nnu = 0.42\nrho = 1200\n'


def text(small: str, kind: str, *changes: tuple[str, str]) -> str:
    material = KINDS[kind]
    for old, new in changes:
        assert material.count(old) == 1, old
        material = material.replace(old, new)
    assert PLAIN in small
    return small.replace(PLAIN, material)


def messages(written: str) -> list[str]:
    with pytest.raises(CaseError) as caught:
        parse_case(written, "t.toml", "small")
    return str(caught.value).splitlines()


@pytest.mark.parametrize("kind", KINDS)
def test_a_case_of_every_kind_survives_being_written_and_read_again(small, kind):
    case = parse_case(text(small, kind), "t.toml", "small")
    assert parse_case(resolved_toml(case), "t.toml", "other") == case


def test_what_is_read(small):
    read = {
        kind: parse_case(text(small, kind), "t.toml", "small").materials["rubber"] for kind in KINDS
    }
    assert isinstance(read["isotropic"], Isotropic)
    assert read["isotropic"].E_static == 60e6
    assert isinstance(read["orthotropic"], Orthotropic)
    assert read["orthotropic"].angle == pytest.approx(np.rad2deg(0.5))
    assert isinstance(read["transverse"], Transverse)
    assert isinstance(read["ply"], Ply)
    assert read["ply"].angles == (20.0, -20.0)
    assert read["table"].modulus.frequencies == (1.0, 1000.0, 10000.0)
    assert read["table"].modulus.shift.temperature == 40.0
    assert read["prony"].modulus.tau == (1e-3, 1e-4)
    assert read["zener"].modulus.tau == 2e-6


def test_the_kind_of_an_isotropic_material_is_not_written_out(small):
    """So that cases from before the other kinds keep their text and hash."""
    case = parse_case(small, "t.toml", "small")
    named = parse_case(small.replace(PLAIN, PLAIN + 'kind = "isotropic"\n'), "t.toml", "small")
    rubber = {"E": 80e6, "nu": 0.42, "rho": 1200.0, "eta": 0.0}
    assert resolved(case)["materials"]["rubber"] == rubber
    assert case_hash(named) == case_hash(case)


# the kind, what is changed in it: old text, new text, then every line that is reported
ONE_CHANGE = {
    "unknown kind": (
        "ply",
        'kind = "ply"',
        'kind = "plie"',
        "4: materials.rubber.kind: 'plie' is not one of isotropic, orthotropic, transverse, ply",
    ),
    "unknown key of a kind": (
        "transverse",
        "nu_23 = 0.5",
        "nu_23 = 0.5\nE_3 = 1",
        "9: materials.rubber.E_3: unknown key for kind 'transverse'; did you mean 'E_2'?",
    ),
    "missing key of a kind": (
        "orthotropic",
        "G_13 = 4e7\n",
        "",
        "3: materials.rubber.G_13: missing: shear modulus between axes 1 and 3 [Pa]",
    ),
    "missing cord": (
        "ply",
        "rho = 1400",
        "rhoo = 1400",
        "5: materials.rubber.cord.rho: missing: density [kg/m3]",
        "5: materials.rubber.cord.rhoo: unknown key; did you mean 'rho'?",
    ),
    "no modulus at all": (
        "isotropic",
        'E = "80 MPa"\n',
        "",
        "3: materials.rubber.E: missing: Young's modulus [Pa]",
    ),
    "modulus twice": (
        "zener",
        "nu = 0.42",
        "nu = 0.42\nE = 1e7\neta = 0.1",
        "5: materials.rubber.E: not together with modulus, which gives E",
        "6: materials.rubber.eta: not together with modulus, which gives eta",
    ),
    "no modulus of a ply's rubber": (
        "ply",
        'rubber = { E = "6 MPa", ',
        "rubber = { ",
        "6: materials.rubber.rubber.E: missing: Young's modulus [Pa]",
    ),
    "angle out of range": (
        "transverse",
        "angle = -20",
        "angle = 100",
        "11: materials.rubber.angle: 100 deg is out of range; must be at most 90 deg",
    ),
    "angle of a ply out of range": (
        "ply",
        "[20, -20]",
        "[20, '-2 rad']",
        "8: materials.rubber.angles[1]: -2 rad is out of range; must be at least -90 deg",
    ),
    "no plies": (
        "ply",
        "angles = [20, -20]\nshares = [1, 2]",
        "angles = []",
        "8: materials.rubber.angles: is empty; must have at least 1",
    ),
    "shares of other plies": (
        "ply",
        "[1, 2]",
        "[1, 2, 1]",
        "9: materials.rubber.shares: has 3 entries; must have 2, as many as angles",
    ),
    "nothing but cords": (
        "ply",
        "0.3\n",
        "1.0\n",
        "7: materials.rubber.volume_fraction: 1.0 is out of range; must be below 1",
    ),
    "a modulus that leaves no digits to another": (
        "transverse",
        "E_1 = 9e8\nE_2 = 2e7",
        "E_1 = 9e13\nE_2 = 20",
        "5: materials.rubber.E_1: 9e+13 Pa is too stiff; must be at most 1e+10 times E_2 = 20 Pa",
    ),
    "Poisson's ratio all but a half": (
        "isotropic",
        "nu = 0.42",
        "nu = 0.49999999",
        "5: materials.rubber.nu: 0.49999999 is too near to 0.5; must be from -0.9999999 to "
        "0.4999999",
    ),
    "Poisson's ratio too large for its moduli": (
        "orthotropic",
        "nu_23 = 0.6",
        "nu_23 = -2.6",
        "10: materials.rubber.nu_23: -2.6 is out of range; with these E_2 and E_3 its size must be "
        "below sqrt(E_2/E_3) = 2.581988897",
    ),
    "Poisson's ratio of a transverse material too large": (
        "transverse",
        "nu_12 = 0.4",
        "nu_12 = 7",
        "7: materials.rubber.nu_12: 7 is out of range; with these E_1 and E_2 its size must be "
        "below sqrt(E_1/E_2) = 6.708203932",
    ),
    "Poisson's ratios too large together": (
        "transverse",
        "nu_23 = 0.5",
        "nu_23 = 0.995",
        "3: materials.rubber: the stiffness is not positive definite: 1 - nu_12 nu_21 - nu_23 "
        "nu_32 - nu_13 nu_31 - 2 nu_12 nu_23 nu_31 = -0.00421 must be above 0; "
        "make a Poisson's ratio smaller",
    ),
    "modulus of no kind": (
        "zener",
        'kind = "zener"\n',
        "",
        "6: materials.rubber.modulus.kind: missing: one of table, prony, zener",
    ),
    "modulus of an unknown kind": (
        "zener",
        '"zener"',
        '"zenner"',
        "7: materials.rubber.modulus.kind: 'zenner' is not one of table, prony, zener; "
        "did you mean 'zener'?",
    ),
    "unknown key of a modulus": (
        "zener",
        "alpha",
        "alfa",
        "11: materials.rubber.modulus.alfa: unknown key for kind 'zener'; did you mean 'alpha'?",
    ),
    "modulus that is a number": (
        "isotropic",
        'E = "80 MPa"',
        "modulus = 8e6",
        "4: materials.rubber.modulus: 8000000.0 is not a table",
    ),
    "material that is softer at high frequency": (
        "zener",
        "E_inf = 1e9",
        "E_inf = 1e6",
        "9: materials.rubber.modulus.E_inf: 1e+06 Pa is too small; must be at least "
        "E_0 = 1e+07 Pa: a passive material stiffens with frequency",
    ),
    "derivative of order two": (
        "zener",
        "alpha = 0.5",
        "alpha = 2",
        "11: materials.rubber.modulus.alpha: 2 is out of range; must be at most 1",
    ),
    "series without a modulus": (
        "prony",
        "E_inf = 1e7\n",
        "",
        "6: materials.rubber.modulus: has no modulus; give E_inf (at 0 Hz) or E_0 (instantaneous)",
    ),
    "series with two moduli": (
        "prony",
        "E_inf = 1e7",
        "E_inf = 1e7\nE_0 = 2e7",
        "9: materials.rubber.modulus.E_0: not together with E_inf; g gives one from the other",
    ),
    "series that relaxes everything": (
        "prony",
        "[0.3, 0.2]",
        "[0.3, 0.7]",
        "9: materials.rubber.modulus.g: the terms relax 1 of E_0; their sum must be below 1",
    ),
    "series of unequal lists": (
        "prony",
        '["1 ms", 1e-4]',
        '["1 ms"]',
        "10: materials.rubber.modulus.tau: has 1 entries; must have 2, as many as g",
    ),
    "rows out of order": (
        "table",
        '"1 kHz"',
        '"20 kHz"',
        "8: materials.rubber.modulus.frequencies[2]: 10000 Hz after 20000 Hz; "
        "list the rows in increasing order",
    ),
    "rows of unequal lists": (
        "table",
        "[0.1, 0.2, 0.3]",
        "[0.1, 0.2]",
        "10: materials.rubber.modulus.eta: has 2 entries; must have 3, as many as frequencies",
    ),
    "negative loss": (
        "table",
        "[0.1, 0.2, 0.3]",
        "[0.1, -0.2, 0.3]",
        "10: materials.rubber.modulus.eta[1]: -0.2 is out of range; must be at least 0",
    ),
    "extrapolation by a number": (
        "table",
        "extrapolate = true",
        "extrapolate = 1",
        "11: materials.rubber.modulus.extrapolate: 1 is not true or false",
    ),
    "temperature at the pole of the shift": (
        "table",
        '"40 degC"',
        "-90",
        "12: materials.rubber.modulus.shift.temperature: -90 degC is too cold for the shift; "
        "must be above T_ref - C2 = -81.6 degC",
    ),
    "temperature near the pole of the shift": (
        "table",
        '"40 degC"',
        "-80",
        "12: materials.rubber.modulus.shift.temperature: -80 degC shifts the frequency by 554 "
        "decades; must be at most 30",
    ),
    "line below the table": (
        "table",
        "extrapolate = true\nshift = { C1 = 8.86, C2 = 101.6, T_ref = 20, "
        'temperature = "40 degC" }\n',
        "",
        "8: materials.rubber.modulus.frequencies: the frequency line 0 Hz is below the table, "
        "which goes from 1 to 10000 Hz; add rows, or let extrapolate = true hold the end values",
    ),
}


@pytest.mark.parametrize(
    ("kind", "old", "new", "expected"),
    [(kind, old, new, expected) for kind, old, new, *expected in ONE_CHANGE.values()],
    ids=ONE_CHANGE,
)
def test_one_change_gives_exactly_this_message(small, kind, old, new, expected):
    found = messages(text(small, kind, (old, new)))
    assert found == [f"t.toml:{line}" for line in expected]


def tabled(small: str, first: float, **shift: float) -> str:
    """The case with lines from 5 to 2000 Hz and a table that begins at a frequency."""
    changes = [("[1, ", f"[{first}, "), ("extrapolate = true", "extrapolate = false")]
    if shift:
        changes.append(('temperature = "40 degC"', f"temperature = {shift['temperature']}"))
    return text(small, "table", *changes).replace("stop = 2000", "start = 5\nstop = 2000")


def test_a_table_that_reaches_over_all_shifted_lines_is_accepted(small):
    case = parse_case(tabled(small, 1.0, temperature=20), "t.toml", "small")
    assert case.materials["rubber"].modulus.kind == "table"


def test_a_shift_moves_the_lines_out_of_a_table(small):
    assert messages(tabled(small, 1.0)) == [
        "t.toml:8: materials.rubber.modulus.frequencies: the frequency line 5 Hz, shifted to "
        "0.174474982 Hz, is below the table, which goes from 1 to 10000 Hz; add rows, or let "
        "extrapolate = true hold the end values"
    ]


def test_a_line_above_the_table_is_named(small):
    assert messages(tabled(small, 1.0, temperature=0)) == [
        "t.toml:8: materials.rubber.modulus.frequencies: the frequency line 70 Hz, shifted to "
        "10391.22306 Hz, is above the table, which goes from 1 to 10000 Hz; add rows, or let "
        "extrapolate = true hold the end values"
    ]


def test_tables_in_the_rubber_of_a_ply_are_checked_too(small):
    rubber = "rubber = { nu = 0.48, rho = 1100, modulus = { kind = 'table', "
    rubber += "frequencies = [10, 20], E = [1e6, 1e6], eta = [0, 0] } }"
    changed = ('rubber = { E = "6 MPa", nu = 0.48, rho = 1100, eta = 0.1 }', rubber)
    [message] = messages(text(small, "ply", changed))
    assert message.startswith("t.toml:6: materials.rubber.rubber.modulus.frequencies: the freq")


def test_the_reach_of_a_table_is_told_together_with_other_errors(small):
    changed = text(small, "table", ("extrapolate = true\n", "")).replace("s = 0.5", "s = 1.5")
    assert [message.split(": ")[1] for message in messages(changed)] == [
        "materials.rubber.modulus.frequencies",
        "loads[0].s",
    ]


moduli = st.floats(6.0, 9.0).map(lambda x: 10.0**x)
ratios = st.floats(-2.0, 2.0)


@given(st.tuples(moduli, moduli, moduli), st.tuples(ratios, ratios, ratios))
def test_constants_are_accepted_just_where_the_compliance_is_positive_definite(E, nu):
    S = np.diag(1.0 / np.array(E))
    for (i, j), ratio in zip([(0, 1), (0, 2), (1, 2)], nu, strict=True):
        S[i, j] = S[j, i] = -ratio / E[i]
    scale = np.sqrt(np.diag(S))
    least = np.linalg.eigvalsh(S / np.outer(scale, scale)).min()
    constants = dict(zip(("E_1", "E_2", "E_3", "nu_12", "nu_13", "nu_23"), E + nu, strict=True))
    if abs(least) < 1e-9:
        return  # too close to say
    try:
        Orthotropic(kind="orthotropic", **constants, G_12=1.0, G_13=1.0, G_23=1.0, rho=1.0)
        accepted = True
    except ValidationError:
        accepted = False
    assert accepted == (least > 0.0)


def test_the_shortest_material_reads_as_it_always_did(small):
    data = tomllib.loads(small)["materials"]["rubber"]
    assert data == {"E": "80 MPa", "nu": 0.42, "rho": 1200}
    rubber = parse_case(small, "t.toml", "small").materials["rubber"]
    assert rubber == Isotropic(E=80e6, nu=0.42, rho=1200)
