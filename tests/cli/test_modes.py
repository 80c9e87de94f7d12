"""`tyrefrf modes` as a user types it: what it prints, writes, and exits with."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from small import TEXT, text_with

import tyrefrf
from tyrefrf.cli.main import main
from tyrefrf.errors import SolveError

INFLATED = text_with(("[cell]", '[inflation]\npressure = "0.5 bar"\n\n[cell]'))


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    """Where a case lies, and one that is inflated."""
    directory = tmp_path_factory.mktemp("modes")
    (directory / "small.toml").write_text(TEXT)
    (directory / "blown.toml").write_text(INFLATED)
    return directory


@pytest.fixture
def command(directory, monkeypatch, capsys):
    """Runs `tyrefrf modes ...` in that directory: exit status, stdout, stderr."""
    monkeypatch.chdir(directory)

    def call(*arguments):
        monkeypatch.setattr("sys.argv", ["tyrefrf", *arguments])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        return left.value.code or 0, said.out, said.err

    return call


@pytest.fixture
def unplotted(monkeypatch):
    """Plots are tests/plots's matter, and take the most time."""
    monkeypatch.setattr("tyrefrf.plots.draw_plots", lambda *_: [])


def test_modes_writes_a_file_and_plots_and_prints_the_lowest(command, directory):
    status, said, _ = command("modes", "small.toml", "--count", "60")
    assert status == 0
    home = directory / "results/small_modes"
    found = tyrefrf.load_modes(home / "small_modes.h5")
    assert found.provenance.case_text == TEXT
    assert found.n_modes in (60, 61)
    assert sorted(p.name for p in (home / "plots").iterdir()) == [
        "frequency_by_order.png",
        "mode_shapes.png",
    ]
    rows = re.findall(r"^ +(\d+) +([\d.]+) +(\d+) +([12]) +([\d.]+)  ([a-z-]+)$", said, re.M)
    assert len(rows) == 30
    for number, hertz, order, members, loss, kind in rows:
        i = int(number) - 1
        assert float(hertz) == pytest.approx(found.frequency[i], abs=0.005)
        assert (int(order), int(members)) == (found.order[i], found.members[i])
        assert float(loss) == pytest.approx(0.1)
        assert kind == found.kind[i]
    assert f"... and {len(found.frequency) - 30} more in the file" in said
    assert "h of 15 cells: n = h, 15 - h, 15 + h, ..." in said
    assert "the inertia of every order counts as many" in said


def test_nothing_is_replaced_without_force(command, unplotted):
    assert command("modes", "small.toml", "--output", "twice", "--count", "3")[0] == 0
    status, _, why = command("modes", "small.toml", "--output", "twice", "--count", "3")
    assert status == 2
    assert "--force replaces it" in why
    again = command("modes", "small.toml", "--output", "twice", "--count", "3", "--force")
    assert again[0] == 0


def test_json_is_one_object_with_every_mode(command):
    status, said, _ = command("modes", "blown.toml", "--below", "200", "--json", "--format", "svg")
    assert status == 0
    facts = json.loads(said)
    assert facts["pressure"] == 0.5e5
    assert facts["modes"] == sum(facts["members"]) > 5
    assert max(facts["frequency"]) < facts["cutoff"] == pytest.approx(200.0)
    assert np.bincount(facts["order"], minlength=8).tolist() == facts["counted"]
    assert [path.rpartition(".")[2] for path in facts["files"]] == ["h5", "svg", "svg"]


def test_at_rest_leaves_the_pressure_away(command, unplotted):
    status, said, _ = command("modes", "blown.toml", "--count", "3", "--at-rest", "--output", "r")
    assert status == 0
    assert "at rest" in said
    assert "at 0.5 bar" not in said


def test_moduli_may_be_taken_at_a_frequency(command, directory, unplotted):
    law = "modulus = { kind = 'zener', E_0 = 80e6, E_inf = 8e8, tau = 1e-4, alpha = 0.5 }"
    text = text_with(('E = "80 MPa"\n', law + "\n"), ("eta = 0.1\n", ""))
    (directory / "law.toml").write_text(text)
    _, own, _ = command("modes", "law.toml", "--count", "3", "--output", "own")
    _, stated, _ = command("modes", "law.toml", "--count", "3", "--output", "at", "--at", "100")
    assert "moduli    of each mode's own frequency" in own
    assert "moduli    of 100 Hz" in stated


def test_info_and_plot_know_a_file_of_modes(command, directory):
    command("modes", "small.toml", "--count", "5", "--output", "known")
    status, said, _ = command("info", "known/small_modes.h5")
    assert status == 0
    assert "the inertia of every order counts as many" in said
    assert "by tyrefrf" in said
    facts = json.loads(command("info", "known/small_modes.h5", "--json")[1])
    assert facts["modes"] in (5, 6)
    status, said, _ = command("plot", "known/small_modes.h5", "--output", "again")
    assert status == 0
    assert sorted(path.name for path in (directory / "again").iterdir()) == [
        "frequency_by_order.png",
        "mode_shapes.png",
    ]


def test_number_and_frequency_together_are_refused(command):
    status, _, why = command("modes", "small.toml", "--count", "3", "--below", "100")
    assert status == 2
    assert "either --count or --below" in why


def test_a_wrong_case_exits_with_2(command, directory):
    (directory / "wrong.toml").write_text(text_with(("nu = 0.42", "nu = 0.7")))
    status, _, why = command("modes", "wrong.toml")
    assert status == 2
    assert "wrong.toml:" in why


def test_modes_that_cannot_be_counted_exit_with_1(command, monkeypatch):
    def lost(*_):
        raise SolveError("circumferential order 3: not as many as counted")

    monkeypatch.setattr("tyrefrf.study.modes.modes_below", lost)
    status, _, why = command("modes", "small.toml", "--output", "lost")
    assert status == 1
    assert "circumferential order 3" in why
