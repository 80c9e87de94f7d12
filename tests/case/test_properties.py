"""Any data gives a case or a CaseError; any case survives being written and read again."""

from __future__ import annotations

import copy
import pickle
import tomllib
from pathlib import Path

import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from tyrefrf.case import (
    Case,
    build_case,
    case_hash,
    load_case,
    parse_case,
    resolved,
    resolved_toml,
    starter_text,
)
from tyrefrf.errors import CaseError

STARTER = tomllib.loads(starter_text())
SHIPPED = Path(__file__).parents[2] / "cases"
MESHED = tomllib.loads((SHIPPED / "mesh_section.toml").read_text())
LAYERED = tomllib.loads((SHIPPED / "paper" / "layered.toml").read_text())

words = st.sampled_from(
    ["rubber", "7 deg", "node", "hub", "radial", "r", "log", "png", "14 mm", "1 kHz", "", "a/b"]
)
numbers = st.sampled_from([0, 1, 2, -1, 7, 360, 0.5, 1e300, 10**400, float("nan"), float("inf")])
leaves = (
    words | numbers | st.booleans() | st.text(max_size=5) | st.dates() | st.datetimes() | st.times()
)
keys = st.sampled_from(
    ["E", "nu", "name", "kind", "s", "node", "angle", "values", "start", "stop", "step", "count"]
) | st.text(max_size=3)
junk = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=4),
    max_leaves=8,
)


def places(data, key=()):
    """Return the keys of all values in nested data."""
    items = data.items() if isinstance(data, dict) else enumerate(data)
    here = [(*key, part) for part, _ in items]
    inner = [
        p for k in here if isinstance(data[k[-1]], dict | list) for p in places(data[k[-1]], k)
    ]
    return here + inner


@st.composite
def spoilt(draw):
    """Draw a shipped case with a few values replaced, added or removed."""
    data = copy.deepcopy(draw(st.sampled_from([STARTER, LAYERED, MESHED])))
    for key in draw(st.lists(st.sampled_from(places(data)), min_size=1, max_size=3)):
        here = data
        for part in key[:-1]:
            here = here[part] if isinstance(here, dict | list) and part in _parts(here) else {}
        if isinstance(here, dict) and draw(st.booleans()):
            here.pop(key[-1], None)
            here[draw(keys)] = draw(junk)
        elif key[-1] in _parts(here):
            here[key[-1]] = draw(junk)
    return data


def _parts(data):
    return data if isinstance(data, dict) else range(len(data) if isinstance(data, list) else 0)


def outcome(text: str) -> Case | CaseError:
    try:
        return parse_case(text, "t.toml", "tyre")
    except CaseError as error:
        return error


def assert_helpful(error: CaseError, text: str) -> None:
    assert error.problems
    assert all(problem.message for problem in error.problems)
    assert not any("Input should" in problem.message for problem in error.problems)
    assert all(0 <= problem.line <= text.count("\n") + 1 for problem in error.problems)


@settings(deadline=None, max_examples=300)
@given(spoilt() | st.dictionaries(keys | st.sampled_from(list(STARTER)), junk, max_size=5))
def test_any_toml_gives_a_case_or_a_case_error_and_a_case_survives_a_round_trip(data):
    text = tomli_w.dumps(data)
    found = outcome(text)
    if isinstance(found, CaseError):
        assert_helpful(found, text)
    else:
        assert parse_case(resolved_toml(found), "t.toml", "other") == found


lengths = st.floats(0.001, 0.004) | st.integers(1, 4).map("{} mm".format)
labels = st.text(st.characters(codec="utf-8", exclude_categories=["Cc"]), min_size=1, max_size=9)
points = st.fixed_dictionaries(
    {"name": labels, "direction": st.sampled_from(["r", "y", "theta"]), "s": st.floats(0, 1)},
    optional={"angle": st.floats(0, 359) | st.just("1 rad"), "kind": st.just("point")},
)


@given(
    st.fixed_dictionaries({}, optional=dict.fromkeys(STARTER["geometry"]["thickness"], lengths)),
    st.floats(1.0, 1e15) | st.floats(1e-6, 1e9).map("{!r} MPa".format),
    labels,
    st.lists(points, max_size=4, unique_by=lambda point: point["name"]),
)
def test_a_case_survives_being_written_and_read_again(thickness, E, material, probes):
    data = copy.deepcopy(STARTER) | {"probes": probes}
    data["materials"] = {material: {"E": E, "nu": -0.5, "rho": "1.2 g/cm3"}}
    data["geometry"] |= {"thickness": thickness, "material": material}
    data["sweep"] = {
        f"materials.{material}.E": [E],
        f"eta_{material}": {"range": [0, 1], "count": 3},
    }
    case = build_case(data, "tyre")
    assert parse_case(resolved_toml(case), "t.toml", "other") == case


@given(st.text() | st.text("[]{}=.,'\"\n #ab1-"))
def test_any_text_gives_a_case_error(text):
    found = outcome(text)
    assert isinstance(found, CaseError)
    assert_helpful(found, text)


@pytest.fixture
def case(shipped: Path) -> Case:
    return load_case(shipped / "homogeneous.toml")


def test_a_hash_does_not_depend_on_how_the_file_is_written(case, small):
    in_mm = small.replace("[geometry]", "[geometry]\nouter_radius = '278 mm'")
    a, b = parse_case(small, "a", "x"), parse_case(in_mm, "b", "x")
    assert case_hash(a) == case_hash(b) == case_hash(parse_case(resolved_toml(a), "c", "x"))
    assert len(case_hash(a)) == 64


def test_a_hash_depends_on_every_number(small):
    changed = small.replace("nu = 0.42", "nu = 0.4200000000000001")
    assert case_hash(parse_case(small, "a", "x")) != case_hash(parse_case(changed, "a", "x"))


def test_the_resolved_case_writes_every_default_out(small):
    data = tomllib.loads(resolved_toml(parse_case(small, "a", "x")))
    assert data["geometry"]["thickness"]["crown"] == 0.014
    assert data["solver"] == {"name": "recursive"}
    assert data["loads"][0]["surface"] == "outer"


def test_one_key_of_the_resolved_case_can_be_changed_and_built_again(case):
    data = resolved(case)
    data["materials"]["rubber"]["E"] = "90 MPa"
    assert build_case(data, "x").materials["rubber"].E == 90e6


def test_a_case_cannot_be_changed(case):
    with pytest.raises(ValidationError):
        case.cell.sector_angle = 6.0
    assert isinstance(case.loads, tuple)
    assert isinstance(case.output.plots, tuple)


def test_a_case_travels_to_another_process(case):
    assert pickle.loads(pickle.dumps(case)) == case


def test_rules_between_tables_hold_for_cases_built_in_python(case):
    with pytest.raises(ValidationError, match="undefined material"):
        Case(**{**dict(case), "materials": {"steel": case.materials["rubber"]}})
