"""`tyrefrf compare` as a user types it: what it prints, writes, and exits with."""

from __future__ import annotations

import json
import re
import sys

import command
import numpy as np
import pytest
import xarray
from small import TEXT

import tyrefrf
from tyrefrf.cli.comparing import aligned
from tyrefrf.cli.main import main
from tyrefrf.errors import SingularError, SolveError
from tyrefrf.solvers import SOLVERS, Cyclic
from tyrefrf.study import compare as study

NO_PLOTS = TEXT + "\n[output]\nplots = []\n"
ONE_LOAD = TEXT[: TEXT.index('[[loads]]\nname = "patch"')] + TEXT[TEXT.index("[[probes]]") :]
FILE = "results/small/small_comparison.h5"


@pytest.fixture
def here(tmp_path, monkeypatch):
    (tmp_path / "small.toml").write_text(NO_PLOTS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def in_this_process(work, listen):
    """Spares the tests a new interpreter for every solver; `finished` has them."""
    return work(listen)


@pytest.fixture
def tyrefrf_command(here, monkeypatch, capsys):
    """Run a command in this process: exit status, stdout, stderr."""
    monkeypatch.setattr(study, "in_own_process", in_this_process)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["tyrefrf", *map(str, arguments)])
        try:
            main()
            status = 0
        except SystemExit as exit_:
            status = exit_.code or 0
        said = capsys.readouterr()
        return status, said.out, said.err

    return run


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A directory with a comparison in real processes, and what it said."""
    directory = tmp_path_factory.mktemp("compare")
    (directory / "small.toml").write_text(ONE_LOAD)
    arguments = ["compare", "small.toml", "--solvers", "recursive, cyclic", "--format", "svg"]
    done = command.tyrefrf_command(*arguments, cwd=directory)
    return directory, done


def test_a_comparison_writes_its_files_and_says_so(finished):
    directory, done = finished
    assert done.returncode == 0, done.stderr
    written = re.findall(r"wrote +(\S+)", done.stdout)
    assert written[:2] == [FILE, FILE.replace(".h5", ".md")]
    assert "results/small/plots/comparison_difference.svg" in written
    assert all((directory / name).stat().st_size > 500 for name in written)
    assert tyrefrf.load_comparison(directory / FILE).provenance.case_text == ONE_LOAD


def test_the_table_says_what_the_file_holds(finished):
    directory, done = finished
    found = tyrefrf.load_comparison(directory / FILE)
    row = re.search(
        r"cyclic +([\d.]+) ms \(([\d.]+) ms to ([\d.]+) ms\) +[\d.]+ ms +(\d+) MB \((-?\d+) MB\) "
        r"+([\d.]+) MB +(\S+) +(\S+)",
        done.stdout,
    )
    median, low, high, peak, added, disk, residual, difference = map(float, row.groups())
    times = 1e3 * np.quantile(found.seconds[1], [0.5, 0.1, 0.9])
    assert [median, low, high] == pytest.approx(times, rel=0.01)
    assert peak == round(found.peak_memory[1] / 1e6)
    assert added == round((found.peak_memory - found.base_memory)[1] / 1e6)
    assert disk == pytest.approx(found.disk[1] / 1e6, abs=0.005)
    assert residual == pytest.approx(found.residual[1].max(), rel=0.06)
    assert difference == pytest.approx(found.error[1], rel=0.06)
    assert "largest difference to recursive" in done.stdout


def test_cost_and_progress_are_said_on_stderr(finished):
    _, done = finished
    cost, *progress = done.stderr.splitlines()
    assert re.match(r"small: 4 lines, about \d+ s in all \(recursive \d+ s, \d+ MB; cyclic", cost)
    said = [line.split("lines, ")[0] for line in progress]
    assert [line for line in said if "4/4" in line] == [  # a slow machine says more
        "small, recursive: 4/4 ",
        "small, cyclic: 4/4 ",
    ]


def test_the_markdown_has_table_pairs_machine_and_limits(finished):
    directory, _ = finished
    text = (directory / FILE).with_suffix(".md").read_text()
    tables = [line.split(" | ") for line in text.splitlines() if line.startswith("|")]
    assert [len(row) for row in tables] == [7, 7, 7, 7, 3, 3, 3, 3]
    assert tables[7][2] == "0 |"
    machine = tyrefrf.load_comparison(directory / FILE).machine
    for word in (*machine.values(), "Not shown:", "table 2", "4 lines"):
        assert word in text


def test_xarray_opens_the_file(finished):
    directory, _ = finished
    with xarray.open_dataset(directory / FILE, engine="h5netcdf") as data:
        assert data["mobility"].sel(solver="cyclic").shape == (1, 2, 4)


def test_info_understands_a_comparison(finished, tyrefrf_command):
    directory, done = finished
    status, said, _ = tyrefrf_command("info", directory / FILE)
    assert status == 0
    assert next(row for row in said.splitlines() if "cyclic" in row) in done.stdout
    facts = json.loads(tyrefrf_command("info", directory / FILE, "--json")[1])
    assert [row["solver"] for row in facts["solvers"]] == ["recursive", "cyclic"]


def test_json_is_one_object_on_stdout(tyrefrf_command):
    status, out, _ = tyrefrf_command("compare", "small.toml", "--solvers=cyclic,direct", "--json")
    facts = json.loads(out)
    assert (status, facts["reference"], facts["lines"]) == (0, "direct", 4)
    cyclic, direct = facts["solvers"]
    assert 0.0 < cyclic["largest_difference"] == facts["differences"]["cyclic"]["direct"] < 1e-9
    assert direct["largest_difference"] == 0.0
    assert facts["failed"] == []
    assert facts["files"] == [FILE, FILE.replace(".h5", ".md")]


def test_fewer_lines_and_another_directory(tyrefrf_command, here):
    status, out, err = tyrefrf_command(
        "compare", "small.toml", "--solvers", "cyclic", "--lines", 2, "--output", "out", "--json"
    )
    assert (status, json.loads(out)["lines"]) == (0, 2)
    assert tyrefrf.load_comparison(here / "out/small_comparison.h5").frequency.tolist() == [0, 420]
    assert err.startswith("small: 2 lines")


def test_a_solver_that_refuses_has_a_row_that_says_why(tyrefrf_command, monkeypatch, here):
    def refusing(work, listen):
        if work.args[0].case.solver.name == "direct":
            raise SolveError("its process was killed (SIGKILL)")
        return work(listen)

    monkeypatch.setattr(study, "in_own_process", refusing)
    status, out, err = tyrefrf_command("compare", "small.toml", "--solvers", "direct,cyclic")
    assert status == 1
    assert err.splitlines()[-1] == "direct: its process was killed (SIGKILL)"
    assert re.search(r"direct +no answer +- +- +- +- +-\n", out)
    assert out.count("direct: its process was killed") == 1
    assert "FAILED" not in out
    text = (here / FILE).with_suffix(".md").read_text()
    assert "- direct: its process was killed (SIGKILL)" in text


def test_failed_lines_are_named_and_the_exit_is_1(tyrefrf_command, monkeypatch):
    class Refusing(Cyclic):
        def field(self, omega):
            if omega > 2 * np.pi * 400:
                raise SingularError("an undamped resonance lies on this line")
            return super().field(omega)

    monkeypatch.setitem(SOLVERS, "cyclic", Refusing)
    status, out, err = tyrefrf_command("compare", "small.toml", "--solvers", "cyclic,recursive")
    failed = "cyclic: 420 Hz: an undamped resonance lies on this line"
    assert status == 1
    assert failed in err
    assert f"failed    {failed}" in out
    assert "4, 0 to 420 Hz, 1 FAILED" in out


BAD = {
    "unknown": ("cyclc,direct", r"no solver 'cyclc'; did you mean 'cyclic'\?"),
    "twice": ("cyclic,cyclic", "solver 'cyclic' is named twice"),
    "none": (",", "no solvers to compare; name some of: recursive, cyclic, direct, modal"),
}


@pytest.mark.parametrize(("solvers", "message"), BAD.values(), ids=BAD)
def test_a_wrong_command_line_exits_2_and_says_why(tyrefrf_command, here, solvers, message):
    status, out, err = tyrefrf_command("compare", "small.toml", "--solvers", solvers)
    assert (status, out) == (2, "")
    assert re.search(message, err)
    assert not (here / "results").exists()


def test_a_wrong_case_exits_2_with_its_line(tyrefrf_command, here):
    (here / "small.toml").write_text(NO_PLOTS.replace("s = 0.5", "s = 0.0"))
    status, _, err = tyrefrf_command("compare", "small.toml", "--solvers", "cyclic")
    assert status == 2
    assert re.search(r"small.toml:\d+: loads\[0\].*rim", err)


def test_nothing_is_overwritten_without_force(tyrefrf_command, here):
    (here / "results/small").mkdir(parents=True)
    (here / FILE).write_bytes(b"kept")
    status, _, err = tyrefrf_command("compare", "small.toml", "--solvers", "cyclic")
    assert (status, "--force" in err, (here / FILE).read_bytes()) == (2, True, b"kept")
    status, *_ = tyrefrf_command("compare", "small.toml", "--solvers", "cyclic", "--force")
    assert (status, tyrefrf.load_comparison(here / FILE).solvers) == (0, ("cyclic",))


def test_a_table_s_columns_are_aligned():
    assert aligned([["a", "long"], ["longer", "b"]]) == [
        "a       long",
        "------  ----",
        "longer  b",
    ]


def test_help_teaches(tyrefrf_command):
    status, out, _ = tyrefrf_command("compare", "--help")
    assert status == 0
    for word in ("--solvers", "--lines", "table 2", "modal", "For example"):
        assert word in " ".join(out.split())
