"""Files that tyrefrf 0.1.0 wrote open for ever, and give what was in memory when they were written.

tests/data/make_layout1.py made them; each has its passport beside it.
"""

from __future__ import annotations

import gzip
import json
import sys
from pathlib import Path

import h5py
import pandas
import pytest
from golden import told

from tyrefrf.cli.main import main
from tyrefrf.results import load_any

LAYOUT1 = Path(__file__).parents[1] / "data/layout1"
FILES = {path.name.partition(".")[0]: path for path in sorted(LAYOUT1.glob("*.h5.gz"))}
CONTENTS = {
    "first_run": "Results",
    "first_sweep": "SweepResults",
    "run": "Results",
    "everything": "Results",
    "sweep": "SweepResults",
    "comparison": "Comparison",
    "modes": "Modes",
    "dispersion": "Dispersion",
}
RESPONSES = ("first_run", "run", "everything")


@pytest.fixture(params=FILES)
def name(request):
    return request.param


@pytest.fixture
def path(name, tmp_path):
    path = tmp_path / f"{name}.h5"
    path.write_bytes(gzip.decompress(FILES[name].read_bytes()))
    return path


@pytest.fixture
def passport(name):
    return json.loads((LAYOUT1 / f"{name}.json").read_text(encoding="utf-8"))


def test_every_content_has_its_file():
    assert set(FILES) == set(CONTENTS)


def test_what_was_in_memory_comes_back_to_the_last_digit(name, path, passport):
    found = load_any(path)
    assert type(found).__name__ == CONTENTS[name]
    now = told(found)
    assert {key: now.get(key) for key in passport["held"]} == passport["held"]


def test_the_file_says_what_its_passport_says(name, path, passport):
    with h5py.File(path) as file:
        assert file.attrs["layout"] == 1
        assert file.attrs["program"] == passport["program"]
        assert file.attrs["version"] == passport["version"] == "0.1.0"
        assert file.attrs["case_text"] == passport["case"]
        assert file.attrs["created"].startswith(passport["made"])
        assert ("content" in file.attrs) != name.startswith("first")


def test_it_is_told_and_drawn(path, monkeypatch, capsys):
    status, said = answer(monkeypatch, capsys, "info", path)
    assert status == 0, said.err
    assert "Small tyre" in said.out
    status, said = answer(monkeypatch, capsys, "plot", path)
    assert status == 0, said.err
    assert list((path.parent / "plots").glob("*.png"))


@pytest.mark.parametrize("name", RESPONSES, indirect=True)
def test_its_responses_are_exported(path, monkeypatch, capsys):
    status, said = answer(monkeypatch, capsys, "export", path, "--to", "csv")
    assert status == 0, said.err
    table = pandas.read_csv(path.with_suffix(".csv"), comment="#")
    Y = load_any(path).response("radial", "sidewall")
    assert table["mobility radial -> sidewall imag [m/(s N)]"].tolist() == Y.imag.tolist()


def answer(monkeypatch, capsys, *arguments):
    """The exit status of a command, and what it says."""
    monkeypatch.setattr(sys, "argv", ["tyrefrf", *map(str, arguments)])
    with pytest.raises(SystemExit) as exit_:
        main()
    return exit_.value.code, capsys.readouterr()
