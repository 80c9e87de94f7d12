"""The shipped case and the starter case are the paper's homogeneous tyre."""

from __future__ import annotations

import pytest

from tyrefrf.case import Geometry, Output, load_case, parse_case, starter_text


@pytest.fixture(params=["starter", "shipped"])
def case(request, shipped):
    if request.param == "starter":
        return parse_case(starter_text(), "starter.toml", "homogeneous")
    return load_case(shipped / "homogeneous.toml")


def test_it_is_the_papers_tyre(case):
    assert case.materials["rubber"].model_dump() == {"E": 80e6, "nu": 0.42, "rho": 1200, "eta": 0.1}
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


@pytest.mark.parametrize("name", ["homogeneous.toml"])
def test_it_names_the_schema_on_its_first_line(shipped, name):
    first = "#:schema ./tyrefrf.schema.json"
    assert (shipped / name).read_text().splitlines()[0] == first
    assert starter_text().splitlines()[0] == first
