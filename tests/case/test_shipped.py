"""The shipped cases are the paper's tyres; the starter case is its homogeneous one."""

from __future__ import annotations

import pytest

from tyrefrf.case import (
    Bead,
    Belt,
    Geometry,
    Output,
    Tread,
    builtin_text,
    load_case,
    parse_case,
    starter_text,
)
from tyrefrf.case.geometry import Grooves


@pytest.fixture(params=["starter", "shipped"])
def case(request, shipped):
    if request.param == "starter":
        return parse_case(starter_text(), "starter.toml", "homogeneous")
    return load_case(shipped / "homogeneous.toml")


def test_it_is_the_papers_tyre(case):
    rubber = case.materials["rubber"].model_dump(exclude_none=True)
    assert rubber == {"E": 80e6, "nu": 0.42, "rho": 1200, "eta": 0.1}
    assert (case.cell.n_cells, case.cell.elements_around, case.cell.element) == (45, 1, "hex8i")
    assert (case.geometry.elements_along, case.geometry.elements_through) == (28, 1)


def test_its_geometry_is_the_default_one(case):
    assert case.geometry == Geometry(material="rubber")


def test_it_has_the_loads_and_lines_of_figure_5(case):
    places = [(load.name, load.kind, load.s, load.angle, load.direction) for load in case.loads]
    assert places == [
        ("radial", "node", 0.5, 0.0, "r"),
        ("tangential", "node", 0.5, 0.0, "theta"),
    ]
    assert case.frequency.lines() == [5.0 * k for k in range(401)]


def test_it_has_probes_along_the_section_and_the_hub(case):
    names = ["mid-tread opposite", "tread edge", "shoulder", "sidewall", "bead", "hub"]
    assert [probe.name for probe in case.probes] == names
    assert case.output == Output()


def test_the_layered_case_has_the_materials_of_table_1(shipped):
    case = load_case(shipped / "paper" / "layered.toml")
    table = {name: (m.rho, m.E, m.nu, m.eta) for name, m in case.materials.items()}
    assert table == {
        "rubber": (1000.0, 28e6, 0.48, 0.1),
        "reinforced": (2500.0, 400e6, 0.4, 0.1),
        "steel": (7850.0, 2e11, 0.33, 0.0),
    }
    assert (case.cell.n_cells, case.cell.element) == (60, "hex8i")


def test_a_short_layered_case_is_the_papers(shipped):
    case = load_case(shipped / "paper" / "layered.toml")
    short = Geometry(
        material="rubber",
        elements_along=40,
        elements_through=2,
        tread=Tread(material="rubber", elements_along=24),
        belt=Belt(material="reinforced"),
        bead=Bead(material="steel"),
    )
    assert case.geometry == short


def test_the_treaded_case_has_a_pitch_to_a_cell(shipped):
    case = load_case(shipped / "treaded.toml")
    assert case.geometry.tread.grooves == Grooves(width=0.006, depth=0.0065, rib=0.020)
    assert case.cell.n_cells == 60
    assert case.sweep == {"depth": ("2 mm", "4 mm", "6.5 mm")}


def test_every_case_names_the_schema_on_its_first_line(shipped):
    for file in shipped.rglob("*.toml"):
        up = "../" * (len(file.relative_to(shipped).parts) - 1) or "./"
        assert file.read_text().splitlines()[0] == f"#:schema {up}tyrefrf.schema.json", file


@pytest.mark.parametrize("name", ["homogeneous.toml"])
def test_it_names_the_schema_on_its_first_line(shipped, name):
    first = "#:schema ./tyrefrf.schema.json"
    assert (shipped / name).read_text().splitlines()[0] == first
    assert starter_text().splitlines()[0] == first
    assert builtin_text().splitlines()[0] == first


def test_the_builtin_tyre_is_the_paper_s_layered_one(shipped):
    builtin = parse_case(builtin_text(), "builtin.toml", "tyre")
    layered = load_case(shipped / "paper" / "layered.toml")
    for table in ("geometry", "materials", "cell", "frequency", "loads", "probes", "inflation"):
        assert getattr(builtin, table) == getattr(layered, table), table
    assert "E_rubber" in builtin.sweep
