"""The JSON schema is standard, up to date, and understood by tombi."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tyrefrf.case import case_schema, starter_text

STANDARD = {
    *("$schema", "$defs", "$ref", "title", "description", "type", "default", "required"),
    *("properties", "additionalProperties", "items", "anyOf", "oneOf", "enum", "const"),
    *("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum", "pattern", "format"),
    *("minItems", "maxItems", "minProperties", "minLength", "maxLength", "propertyNames"),
    "patternProperties",
}


def test_the_committed_schema_is_up_to_date(shipped):
    assert json.loads((shipped / "tyrefrf.schema.json").read_text()) == case_schema()


def keywords(schema):
    """Yield the keywords of a schema and of the schemas in it."""
    for word, value in schema.items():
        yield word
        if word in ("properties", "$defs", "patternProperties"):
            for inner in value.values():
                yield from keywords(inner)
        elif word in ("items", "additionalProperties", "propertyNames") and value is not False:
            yield from keywords(value)
        elif word in ("anyOf", "oneOf"):
            for inner in value:
                yield from keywords(inner)


def test_every_keyword_is_json_schemas_own():
    assert set(keywords(case_schema())) <= STANDARD


def test_every_field_is_described():
    tables = [case_schema(), *case_schema()["$defs"].values()]
    bare = [
        f"{table['title']}.{name}"
        for table in tables
        for name, field in table["properties"].items()
        if "description" not in field
    ]
    assert bare == []


TOMBI = Path(sys.executable).with_name("tombi")
needs_tombi = pytest.mark.skipif(not TOMBI.exists(), reason="tombi is not installed")


def lint(*files: Path) -> tuple[int, str]:
    command = [TOMBI, "lint", "--offline", *files]
    done = subprocess.run(command, capture_output=True, text=True, env={"NO_COLOR": "1"})
    return done.returncode, done.stdout + done.stderr


@needs_tombi
def test_tombi_accepts_the_shipped_cases(shipped):
    status, words = lint(*shipped.rglob("*.toml"))
    assert status == 0, words


@needs_tombi
def test_tombi_accepts_the_starter(shipped, tmp_path):
    shutil.copy(shipped / "tyrefrf.schema.json", tmp_path)
    (tmp_path / "starter.toml").write_text(starter_text())
    status, words = lint(tmp_path / "starter.toml")
    assert status == 0, words


@needs_tombi
@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("eta = 0.1", "etha = 0.1", "21:1", '"etha" is not allowed'),
        ("sector_angle = 8.0", "sector_angle = '8 degg'", "24:16", "does not match the pattern"),
        ("sector_angle = 8.0", "sector_angle = -8", "24:16", "-8"),
        ('element = "hex8i"', 'element = "hex9"', "25:11", "hex9"),
        ("s = 0.83", "s = 1.83", "60:5", "1.83"),
        ("step = 5.0", "step = true", "30:8", "Boolean"),
    ],
)
def test_tombi_finds_what_is_wrong(shipped, tmp_path, old, new, place, words):
    text = (shipped / "homogeneous.toml").read_text()
    assert old in text
    shutil.copy(shipped / "tyrefrf.schema.json", tmp_path)
    (tmp_path / "bad.toml").write_text(text.replace(old, new, 1))
    status, found = lint(tmp_path / "bad.toml")
    assert status == 1
    assert f"bad.toml:{place}" in found
    assert words in found
