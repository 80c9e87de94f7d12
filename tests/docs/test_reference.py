"""The reference and the theory name all that they have to: keys, datasets, equations, functions."""

from __future__ import annotations

import re

import case_tables
import layout_tables
import pytest
from pages import DOCS

import tyrefrf
from tyrefrf.case import Case, case_schema

CITED = re.compile(r"\[(\d{1,2})\](?:-\[(\d{1,2})\])?")
LAST = 23  # equation of the paper


def test_every_equation_of_the_paper_stands_in_the_theory_once():
    text = "\n".join(page.read_text(encoding="utf-8") for page in DOCS.glob("theory/*.md"))
    numbers = [int(n) for n in re.findall(r"^\$\$ \((\d+)\)$", text, re.MULTILINE)]
    assert sorted(numbers) == list(range(1, LAST + 1))


def test_the_code_cites_no_other_equations():
    package = DOCS.parent / "tyrefrf"
    docstrings = re.compile(r'"""(.*?)"""', re.DOTALL)
    cited = {
        int(number)
        for path in package.rglob("*.py")
        for docstring in docstrings.findall(path.read_text(encoding="utf-8"))
        for pair in CITED.findall(re.sub(r"\w\[\d+\]", "", docstring))
        for number in filter(None, pair)
    }
    assert {3, 18, 22, 23} <= cited <= set(range(1, LAST + 1))


def test_every_public_name_is_in_the_reference():
    text = (DOCS / "reference" / "python.md").read_text(encoding="utf-8")
    named = re.findall(r"^\.\. auto(?:function|class):: tyrefrf\.(\w+)$", text, re.MULTILINE)
    assert sorted(named) == sorted(tyrefrf.__all__)


def test_every_table_and_key_of_the_schema_is_in_the_reference():
    models = case_tables.tables()
    assert models[Case] == [""]
    named = {model.__name__: {*model.model_fields} for model in models}
    for name, definition in case_schema()["$defs"].items():
        if "properties" in definition:
            assert {*definition["properties"]} <= named[name]
    lines = "\n".join(
        line for model, places in models.items() for line in case_tables.section(model, places)
    )
    assert "## `[geometry.tread.grooves]`" in lines
    assert "| `sector_angle` | deg, above 0, at most 360 | required |" in lines


@pytest.mark.parametrize("content", ["run", "modes", "dispersion", "comparison"])
def test_every_dataset_has_a_row(content):
    rows = [layout_tables.row(field) for field in layout_tables.LAYOUTS[content]]
    assert all(row[-1] for row in rows)
    assert len({field.name for field in layout_tables.LAYOUTS[content]}) == len(rows)
