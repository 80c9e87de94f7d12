"""Parameters by name, their values with units, and the [sweep] table: every message of them."""

from __future__ import annotations

import pytest

from tyrefrf.case import (
    Range,
    build_case,
    case_hash,
    make_grid,
    parse_case,
    resolved,
    resolved_toml,
)
from tyrefrf.case.parameters import find_parameter, parameters
from tyrefrf.errors import CaseError, MeshError

LAYERED = """\
[geometry.tread]
material = "rubber"
[geometry.belt]
material = "rubber"
"""
NAMES = (
    "outer_radius, inner_radius, section_width, rim_width, widest_radius, tread_width, "
    "crown_radius, crown, shoulder, sidewall, bead, elements_along, elements_through, E_rubber, "
    "nu_rubber, rho_rubber, eta_rubber, E_static_rubber, sector_angle, elements_around, alpha, "
    "beta, pressure"
)


@pytest.fixture
def case(small):
    return parse_case(small, "small.toml", "small")


def with_sweep(small: str, entries: str):
    return parse_case(f"{small}[sweep]\n{entries}\n", "t.toml", "small")


def messages(run) -> list[str]:
    with pytest.raises(CaseError) as caught:
        run()
    return str(caught.value).splitlines()


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("E_rubber", "materials.rubber.E"),
        ("eta_rubber", "materials.rubber.eta"),
        ("materials.rubber.rho", "materials.rubber.rho"),
        ("sector_angle", "cell.sector_angle"),
        ("cell.sector_angle", "cell.sector_angle"),
        ("crown", "geometry.thickness.crown"),
        ("sidewall", "geometry.thickness.sidewall"),
        ("tread_width", "geometry.tread_width"),
        ("pressure", "inflation.pressure"),
        ("elements_around", "cell.elements_around"),
    ],
)
def test_a_parameter_has_a_place_and_a_short_name(case, name, place):
    assert find_parameter(case, name).place == place


def test_every_short_name_finds_its_own_parameter(case):
    for parameter in parameters(case):
        assert find_parameter(case, parameter.name) == parameter
        assert find_parameter(case, parameter.place) == parameter


def test_every_parameter_has_a_unit_and_a_meaning(case):
    assert all(p.units and p.meaning for p in parameters(case))
    assert find_parameter(case, "E_rubber").units == "Pa"
    assert find_parameter(case, "eta_rubber").units == "1"


def test_lines_loads_and_switches_are_no_parameters(case):
    tables = {parameter.key[0] for parameter in parameters(case)}
    assert tables == {"geometry", "materials", "cell", "inflation", "damping"}


def test_an_unknown_name_lists_those_that_there_are(case):
    assert messages(lambda: find_parameter(case, "E_ruber")) == [
        f"case: no parameter 'E_ruber' in this case; there are {NAMES}; did you mean 'E_rubber'?"
    ]


def test_an_ambiguous_name_lists_what_it_may_be(small):
    data = small.replace("[materials", f"elements_through = 2\n{LAYERED}[materials", 1)
    layered = parse_case(data, "t.toml", "t")
    assert messages(lambda: find_parameter(layered, "thickness")) == [
        "case: 'thickness' may be geometry.tread.thickness (tread_thickness), "
        "geometry.belt.thickness (belt_thickness); say which"
    ]
    assert find_parameter(layered, "belt_thickness").place == "geometry.belt.thickness"
    assert find_parameter(layered, "belt_width").name == "width"


@pytest.mark.parametrize(
    ("name", "written", "values"),
    [
        ("E_rubber", ("14 MPa", 28e6, "0.056 GPa"), (14e6, 28e6, 56e6)),
        ("crown", ("14 mm", 0.012), (0.014, 0.012)),
        ("sector_angle", (8, "0.1047197551196597746 rad"), (8.0, 6.0)),
        ("elements_around", (1, 2.0), (1.0, 2.0)),
        ("nu_rubber", (0.3,), (0.3,)),
        ("crown", Range(range=("10 mm", "14 mm"), count=3), (0.010, 0.012, 0.014)),
        ("E_rubber", Range(range=(1e6, "4 MPa"), count=3, spacing="log"), (1e6, 2e6, 4e6)),
        ("eta_rubber", Range(range=(0.1, 0.3), count=3), (0.1, 0.2, 0.3)),
    ],
)
def test_values_carry_units_and_come_in_the_order_given(case, name, written, values):
    (axis,) = make_grid(case, {name: written}).axes
    assert axis.values == values


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ((14e6, 28e6), ["14 MPa", "28 MPa"]),
        ((500e3, 2e9), ["0.0005 GPa", "2 GPa"]),
        ((200.0,), ["200 Pa"]),
    ],
)
def test_values_are_written_in_one_short_unit(case, values, texts):
    (axis,) = make_grid(case, {"E_rubber": values}).axes
    assert [axis.text(i) for i in range(len(values))] == texts


def test_a_grid_has_the_last_parameter_fastest(case):
    grid = make_grid(case, {"E_rubber": (1e6, 2e6), "crown": (0.01, 0.012, 0.014)})
    found = [(c.materials["rubber"].E, c.geometry.thickness.crown) for c in grid.cases]
    assert grid.shape == (2, 3)
    assert found == [(E, h) for E in (1e6, 2e6) for h in (0.01, 0.012, 0.014)]


def test_a_point_is_the_case_with_nothing_else_changed(case):
    (point,) = make_grid(case, {"E_rubber": (1e6,)}).cases
    data = resolved(case)
    data["materials"]["rubber"]["E"] = 1e6
    assert point == build_case(data, "small")


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [
        (
            {"sector_angle": (7.0, 8.0, 11.0, -1.0), "E_rubber": ("1 MPaa",)},
            [
                "sector_angle: 7 deg does not divide 360 deg; nearest: 7.2 deg (50 cells)",
                "sector_angle: 11 deg does not divide 360 deg; nearest: 11.25 deg (32 cells)",
                "sector_angle: -1.0 deg is out of range; must be above 0 deg",
                "E_rubber: unknown unit 'MPaa'; use one of Pa, kPa, MPa, GPa, bar; "
                "did you mean 'MPa'?",
            ],
        ),
        (
            {"crown": (0.014, 0.09), "sector_angle": (7.0, 8.0)},
            [
                "sector_angle: 7 deg does not divide 360 deg; nearest: 7.2 deg (50 cells)",
                "crown = 90 mm: geometry.thickness.crown: 0.09 m is too large; "
                "must be below outer_radius - widest_radius = 0.053 m",
            ],
        ),
        (
            {"crown": (0.014, 0.06), "widest_radius": (0.225, 0.226)},
            [
                "crown = 60 mm, widest_radius = 225 mm: geometry.thickness.crown: 0.06 m is too "
                "large; must be below outer_radius - widest_radius = 0.053 m",
                "crown = 60 mm, widest_radius = 226 mm: geometry.thickness.crown: 0.06 m is too "
                "large; must be below outer_radius - widest_radius = 0.052 m",
            ],
        ),
        ({"elements_along": (29.0, 8.5)}, [
            "elements_along: 29 is odd; must be even, for a node at mid-tread; nearest: 30",
            "elements_along: 8.5 is not a whole number",
        ]),
        ({"nu_rubber": (0.3, 0.5)}, ["nu_rubber: 0.5 is out of range; must be below 0.5"]),
        ({"E_rubber": (1e6, "1 MPa")}, ["E_rubber: 1 MPa is there twice"]),
        (
            {"E_rubber": Range(range=(0, 1e6), count=3, spacing="log")},
            ["E_rubber: 0 Pa is out of range; must be at least 1 Pa"],
        ),
        (
            {"eta_rubber": Range(range=(0, 1), count=3, spacing="log")},
            ["eta_rubber: a log range needs both ends above 0"],
        ),
        (
            {"E_rubber": None},
            ["E_rubber: no values; give --values, --range or --log (the case's [sweep] is empty)"],
        ),
        (
            {"E_rubber": (1e6,), "materials.rubber.E": (2e6,)},
            ["E_rubber: named twice; give it once"],
        ),
        (
            {"eta_rubber": tuple(0.001 * k for k in range(200)), "E_rubber": tuple(range(1, 101))},
            ["the grid has more than 10000 points; use fewer"],
        ),
    ],
    ids=lambda value: ", ".join(value) if isinstance(value, dict) else "",
)  # fmt: skip
def test_all_bad_points_are_reported_together(case, wanted, expected):
    assert messages(lambda: make_grid(case, wanted)) == [f"case: {line}" for line in expected]


def test_what_fails_at_some_points_names_the_values_they_share(case):
    grid = make_grid(case, {"E_rubber": (1e6, 2e6), "crown": (0.01, 0.012)})

    def make(point):
        if point.geometry.thickness.crown == 0.01:
            raise MeshError("too thin")

    assert messages(lambda: grid.each(make)) == ["case: crown = 10 mm: too thin"]


def test_the_case_s_own_table_gives_the_values(small):
    case = with_sweep(small, 'E_rubber = ["14 MPa", 28e6]\n"cell.sector_angle" = [8, 4]')
    assert make_grid(case, {"materials.rubber.E": None}).axes[0].values == (14e6, 28e6)
    assert make_grid(case, {"sector_angle": None}).axes[0].values == (8.0, 4.0)


def test_the_table_survives_being_written_and_read(small):
    case = with_sweep(
        small, 'E_rubber = ["14 MPa", 28e6]\ncrown = { range = [0.01, 0.02], count = 3 }'
    )
    assert parse_case(resolved_toml(case), "t.toml", "t") == case


def test_the_table_has_no_part_in_the_case_s_hash(small, case):
    assert case_hash(with_sweep(small, "E_rubber = [1e6]")) == case_hash(case)
    assert "sweep" not in resolved(case)


@pytest.mark.parametrize(
    ("entry", "expected"),
    [
        ("E_rubber = [true]", "sweep.E_rubber[0]: true is not a number or text with a unit"),
        ("E_rubber = [1e6, nan]", "sweep.E_rubber[1]: nan is not a finite number"),
        ("E_rubber = []", "sweep.E_rubber: is empty; must have at least 1"),
        ("E_rubber = 3", "sweep.E_rubber: 3 is not a list"),
        ("E_rubber = [1e6, 0]", "sweep.E_rubber[1]: 0 Pa is out of range; must be at least 1 Pa"),
        ("E_rubber = [1e6, '1 MPa']", "sweep.E_rubber[1]: 1 MPa is there twice"),
        (
            "E_rubber = ['1 mm']",
            "sweep.E_rubber[0]: unknown unit 'mm'; use one of Pa, kPa, MPa, GPa, bar",
        ),
        (
            "sector_angle = [8, 7]",
            "sweep.sector_angle[1]: 7 deg does not divide 360 deg; nearest: 7.2 deg (50 cells)",
        ),
        (
            "E_rubber = { range = [1e6, 2e6] }",
            "sweep.E_rubber.count: missing: number of values, both ends included",
        ),
        (
            "E_rubber = { range = [1e6], count = 2 }",
            "sweep.E_rubber.range: has only 1; must have at least 2",
        ),
        (
            "E_rubber = { range = [1e6, 2e6], count = 3, spacing = 'logg' }",
            "sweep.E_rubber.spacing: 'logg' is not one of linear, log; did you mean 'log'?",
        ),
        (
            "E_rubber = { range = [1e6, 2e6], count = 3, step = 1 }",
            "sweep.E_rubber.step: unknown key; the keys here are range, count, spacing",
        ),
        (
            "crown = { range = [0, 1], count = 3 }",
            "sweep.crown: 0 m is out of range; must be at least 1e-06 m",
        ),
        (
            "E_ruber = [1e6]",
            f"sweep.E_ruber: no parameter 'E_ruber' in this case; there are {NAMES}; "
            "did you mean 'E_rubber'?",
        ),
    ],
)  # fmt: skip
def test_a_wrong_table_is_refused_with_its_line(small, entry, expected):
    line = small.count("\n") + 2
    assert messages(lambda: with_sweep(small, entry)) == [f"t.toml:{line}: {expected}"]


def test_a_parameter_stands_once_in_the_table(small):
    entries = 'E_rubber = [1e6]\n"materials.rubber.E" = [2e6]'
    assert messages(lambda: with_sweep(small, entries)) == [
        "t.toml:18: sweep.materials.rubber.E: is the same parameter as 'E_rubber'; give it once"
    ]
