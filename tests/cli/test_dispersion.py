"""`tyrefrf dispersion` as a user types it: what it prints, writes, and exits with."""

from __future__ import annotations

import json
import sys

import pytest
from command import tyrefrf_command
from small import TEXT, text_with

from tyrefrf.cli.dispersion import _broken
from tyrefrf.cli.main import main
from tyrefrf.errors import SolveError
from tyrefrf.results import load_dispersion
from tyrefrf.solvers.waves import FreeWaves


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A directory with a case whose free waves were computed, and what the command said."""
    directory = tmp_path_factory.mktemp("dispersion")
    (directory / "small.toml").write_text(TEXT)
    command = "dispersion small.toml --lines 6 --jobs 1 --format png --format svg"
    return directory, tyrefrf_command(*command.split(), cwd=directory)


def in_process(monkeypatch, capsys, directory, *arguments):
    """Exit status, stdout and stderr of a command in this process."""
    monkeypatch.chdir(directory)
    monkeypatch.setattr(sys, "argv", ["tyrefrf", *map(str, arguments)])
    with pytest.raises(SystemExit) as exit_:
        main()
    captured = capsys.readouterr()
    return exit_.value.code or 0, captured.out, captured.err


def test_it_writes_results_and_plots_and_says_so(finished):
    directory, done = finished
    assert done.returncode == 0
    output = directory / "results" / "small_dispersion"
    files = [
        "small_dispersion.h5",
        "plots/dispersion.png",
        "plots/dispersion.svg",
    ]
    for name in files:
        assert (output / name).is_file()
        assert f"wrote     results/small_dispersion/{name}" in done.stdout


def test_it_says_how_many_waves_and_that_none_is_missing(finished):
    directory, done = finished
    found = load_dispersion(directory / "results/small_dispersion/small_dispersion.h5")
    words = done.stdout.split("\n")
    assert words[0] == "Small tyre"
    assert "all that decay by up to 20 dB/rad, on 6 of 6 lines" in done.stdout
    assert "by the argument principle the same on 6 of 6 lines" in done.stdout
    last = next(line.split() for line in words if line.split()[:1] == ["420"])
    assert last[1:] == [str(found.waves[-1]), str(found.propagating[:, -1].sum())]
    cut_on = next(line for line in words if line.strip().startswith("cut-on"))
    assert f"{min(f for f in found.cut_on if f == f):.4g}" in cut_on


def test_the_file_tells_the_same(finished):
    directory, done = finished
    told = tyrefrf_command("info", "results/small_dispersion/small_dispersion.h5", cwd=directory)
    assert told.returncode == 0
    assert [line for line in done.stdout.splitlines() if "waves " in line] == [
        line for line in told.stdout.splitlines() if "waves " in line
    ]
    assert "by tyrefrf" in told.stdout


@pytest.mark.parametrize(("branches", "warned"), [(2, False), (10, True), (0, False)])
def test_branches_too_short_to_have_been_followed_are_told(branches, warned):
    told = _broken({"waves": [5, 5, 5, 5], "branches": branches})
    assert [text.split()[0] for text in told] == ["warning"] * warned


def test_json_is_one_object_and_nothing_else(finished, monkeypatch, capsys):
    directory, _ = finished
    command = "dispersion small.toml --lines 3 --decay 10 --jobs 1 --output j --json"
    status, out, _ = in_process(monkeypatch, capsys, directory, *command.split())
    facts = json.loads(out)
    assert status == 0
    assert facts["frequency"] == [140.0, 280.0, 420.0]
    assert facts["decay_bound"] == pytest.approx(10.0)
    assert facts["found"] == facts["counted"]
    assert facts["failed"] == []


def test_plots_can_be_drawn_again(finished, monkeypatch, capsys, tmp_path):
    directory, _ = finished
    file = directory / "results/small_dispersion/small_dispersion.h5"
    monkeypatch.chdir(directory)
    monkeypatch.setattr(sys, "argv", ["tyrefrf", "plot", str(file), "--output", str(tmp_path)])
    with pytest.raises(SystemExit) as exit_:
        main()
    assert not exit_.value.code
    assert (tmp_path / "dispersion.png").is_file()


def test_nothing_is_replaced_unasked(finished, monkeypatch, capsys):
    directory, _ = finished
    status, _, err = in_process(monkeypatch, capsys, directory, "dispersion", "small.toml")
    assert status == 2
    assert "small_dispersion.h5 exists; --force replaces it" in err


def test_a_line_without_proof_exits_with_one_and_is_named(finished, monkeypatch, capsys):
    directory, _ = finished

    def fails(self, omega, decay):
        raise SolveError("420 Hz: 3 free waves found of the 4")

    monkeypatch.setattr(FreeWaves, "at", fails)
    command = "dispersion small.toml --lines 1 --jobs 1 --output failed"
    status, out, err = in_process(monkeypatch, capsys, directory, *command.split())
    assert status == 1
    assert "420 Hz: 3 free waves found of the 4" in err
    assert "on 0 of 1 lines; 0 branches" in out


@pytest.mark.parametrize("wrong", ["--lines 0", "--decay 0", "--decay x", "--jobs 0"])
def test_a_wrong_option_exits_with_two(finished, monkeypatch, capsys, wrong):
    directory, _ = finished
    status, _, err = in_process(
        monkeypatch, capsys, directory, "dispersion", "small.toml", *wrong.split()
    )
    assert status == 2
    assert wrong.split()[0] in err


def test_a_wrong_case_exits_with_two_and_names_the_line(monkeypatch, capsys, tmp_path):
    values = ("[0.0, 40.0, 150.0, 420.0]", "[0.0]")
    (tmp_path / "zero.toml").write_text(text_with(values))
    status, _, err = in_process(monkeypatch, capsys, tmp_path, "dispersion", "zero.toml")
    assert status == 2
    assert err.startswith("zero.toml:")
    assert "at 0 Hz alone there are no free waves" in err
