"""What a run, a sweep and `info` say of their proof, and the exit status of a breach."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace

import pytest
from small import TEXT, text_with

import tyrefrf
from tyrefrf.cli.main import main
from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers import SOLVERS, Recursive

NO_PLOTS = TEXT + "\n[output]\nplots = []\n"


@pytest.fixture
def here(tmp_path, monkeypatch):
    (tmp_path / "small.toml").write_text(NO_PLOTS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def command(here, monkeypatch, capsys):
    """A command in this process: exit status, stdout, stderr."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["tyrefrf", *map(str, arguments)])
        try:
            main()
        except SystemExit as exit_:
            status = exit_.code or 0
        said = capsys.readouterr()
        return status, said.out, said.err

    return run


@pytest.fixture
def giving_power(monkeypatch):
    """Materials whose loss has the wrong sign: every line is solved, and gives power."""
    sound = CellMatrices.dynamic_stiffness
    monkeypatch.setattr(
        CellMatrices, "dynamic_stiffness", lambda cell, omega: sound(cell, omega).conj()
    )


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_run_prints_the_worst_of_every_proof(command, solver):
    status, out, _ = command("run", "small.toml", "--jobs", 1, "--solver", solver)
    assert status == 0
    assert re.search(r"residual  [\d.]+e-1\d at most, .* \(\d+ Hz\)\n", out)
    assert re.search(r"passivity Re Y / \|Y\| 1\.0e-01 at least \(radial, 40 Hz\)\n", out)
    assert re.search(r"of all loads together 3\.1e-02 at least \(40 Hz\)\n", out)
    assert re.search(r"symmetry  \|H_ij - H_ji\| [\d.]+e-1\d at most \(\d+ Hz\)\n", out)
    assert "BREACHED" not in out


def test_json_has_the_worst_of_every_proof(command):
    _, out, _ = command("run", "small.toml", "--jobs", 1, "--json")
    facts = json.loads(out)
    assert facts["breaches"] == []
    assert facts["certificate"] is None
    assert set(facts["proof"]) == {"residual", "passivity", "power", "reciprocity"}
    assert facts["proof"]["residual"]["value"] == facts["largest_residual"]
    assert facts["proof"]["passivity"]["load"] == "radial"
    assert facts["proof"]["passivity"]["frequency"] == 40.0


def test_with_one_load_nothing_is_said_of_pairs(command, here):
    alone = re.sub(r'\[\[loads\]\]\nname = "patch".*?(?=\[\[probes)', "", NO_PLOTS, flags=re.DOTALL)
    (here / "small.toml").write_text(alone)
    _, out, _ = command("run", "small.toml", "--jobs", 1)
    assert "passivity" in out
    assert "together" not in out
    assert "symmetry" not in out


def test_power_that_comes_out_exits_1_and_names_the_lines(command, giving_power):
    status, out, err = command("run", "small.toml", "--jobs", 1)
    assert status == 1
    assert "BREACHED  on 3 line(s)" in out
    for frequency in ("40", "150", "420"):
        assert re.search(rf"^{frequency} Hz: Re Y is -.* at radial: power comes out", err, re.M)
    assert not re.search(r"^0 Hz", err, re.M)  # nothing moves there
    status, out, _ = command("info", "results/small/small.h5")
    assert status == 0
    assert re.search(r"breach    40 Hz: Re Y is -", out)


def test_many_breaches_are_cut_on_the_screen_and_whole_in_json(command, here, giving_power):
    (here / "small.toml").write_text(
        text_with(("values = [0.0, 40.0, 150.0, 420.0]", "stop = 130.0\nstep = 10.0"))
        + "\n[output]\nplots = []\n"
    )
    status, out, err = command("run", "small.toml", "--jobs", 1, "--json")
    assert status == 1
    assert len(json.loads(out)["breaches"]) == 13
    assert len(re.findall("power comes out", err)) == 20  # two loads on ten lines
    assert re.search(r"^and 3 more$", err, re.M)


def test_a_sweep_names_point_and_line(command, giving_power):
    status, out, err = command(
        "sweep", "small.toml", "--param", "E_rubber=40e6,80e6", "--jobs", 1
    )  # fmt: skip
    assert status == 1
    assert "BREACHED  on 6 line(s)" in out
    assert re.search(r"^E_rubber = 80 MPa: 150 Hz: Re Y is -.*power comes out", err, re.M)
    assert re.search(r"passivity Re Y / \|Y\| -.* at least \(\w+, E_rubber = \d+ MPa, \d+ Hz", out)


def test_a_sound_sweep_prints_the_worst_of_all_points(command):
    status, out, _ = command(
        "sweep", "small.toml", "--param", "E_rubber=40e6,80e6", "--jobs", 1, "--json"
    )  # fmt: skip
    facts = json.loads(out)
    assert status == 0
    assert facts["breaches"] == []
    swept = tyrefrf.load_sweep("results/small_sweep/small_sweep.h5")
    worst = int(swept.residual.max(axis=-1).argmax())
    assert facts["proof"]["residual"]["value"] == swept.residual.max()
    assert facts["proof"]["residual"]["point"] == swept.labels[worst]


def test_certify_says_its_cost_before_and_what_it_found(command):
    status, out, err = command("run", "small.toml", "--jobs", 1, "--certify")
    assert status == 0
    plan = err.index("certify: 4 lines again by `cyclic`, 4 lines of 30 cells; about ")
    assert plan < err.index("small, certify: 8/8 lines")
    assert re.search(r"certified by `cyclic` on 4 lines: responses differ by [\d.]+e-1\d at", out)
    assert re.search(
        r"refined   30 cells instead of 15, on 4 lines: levels change by [\d.]+ dB", out
    )
    assert re.search(r"radial to sidewall: [\d.]+ dB, [\d.]+ dB at most", out)
    assert "no bound of the error" in out
    told = command("info", "results/small/small.h5")[1]
    assert "certified by `cyclic` on 4 lines" in told
    assert "refined   30 cells" in told
    facts = json.loads(command("info", "results/small/small.h5", "--json")[1])["certificate"]
    assert (facts["solver"], facts["lines"], facts["refined_cells"]) == ("cyclic", 4, 30)
    assert facts["difference"] < 1e-10
    assert len(facts["level_change"]) == 6


def test_a_second_solver_that_differs_exits_1(command, monkeypatch):
    class Lying(Recursive):
        def field(self, omega):
            field = super().field(omega)
            return replace(field, q=field.q * (1.0 + 1e-6))

    monkeypatch.setitem(SOLVERS, "recursive", Lying)
    assert command("run", "small.toml", "--jobs", 1)[0] == 0
    status, out, err = command("run", "small.toml", "--jobs", 1, "--certify", "--force")
    assert status == 1
    assert "BREACHED  on 4 line(s)" in out
    assert "150 Hz: cyclic differs by 1.0e-06" in err
