"""`tyrefrf run` with measured responses: on the screen, as JSON, in the file and in the plots."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
from command import tyrefrf_command
from small import TEXT

import tyrefrf
from tyrefrf.cli.main import main

CASE = f"""{TEXT}
[[measured]]
name = "run 7"
file = "lab/run.csv"
load = "radial"
probe = "sidewall"
quantity = "receptance"

[[measured]]
file = "lab/run.csv"
load = "radial"
probe = "radial.drive"
quantity = "mobility"
columns = {{ frequency = 4, real = 2, imag = 3 }}
"""
MESSAGE = "small.toml:45: measured[0].file: lab/run.csv:3: 30 Hz after 40 Hz; frequencies have to"
LINES = np.array([40.0, 150.0, 420.0])


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A case beside which lies half of what is computed, as if it had been measured."""
    directory = tmp_path_factory.mktemp("measured")
    (directory / "small.toml").write_text(TEXT)
    H = tyrefrf.run(directory / "small.toml", jobs=1).response("radial", "sidewall", "receptance")
    (directory / "lab").mkdir()
    rows = zip(LINES, 0.5 * H[1:], LINES + 600.0, strict=True)
    text = "\n".join(f"{f},{h.real:.12e},{h.imag:.12e},{g}" for f, h, g in rows)
    (directory / "lab" / "run.csv").write_text(text)
    (directory / "small.toml").write_text(CASE)
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    done = tyrefrf_command("run", directory / "small.toml", "--jobs", 1, cwd=elsewhere)
    return directory, elsewhere, done


def test_the_summary_says_how_far_they_agree(finished):
    _, _, done = finished
    assert done.returncode == 0, done.stderr
    said = [line for line in done.stdout.splitlines() if line.startswith("  measured")]
    assert said == [
        "  measured  run 7, radial to sidewall: FRAC 1.000 of receptance, level +6.0 dB computed "
        "over measured (3 lines, 40 to 420 Hz)",
        "  measured  run, radial to radial.drive: no FRAC, with 0 of its lines within those "
        "computed",
    ]


def in_process(monkeypatch, capsys, directory, *arguments):
    """The same command without a new process; its status, stdout and stderr."""
    monkeypatch.chdir(directory)
    monkeypatch.setattr(sys, "argv", ["tyrefrf", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr()
    return ended.value.code or 0, said.out, said.err


@pytest.fixture
def gone(finished):
    """The results, while the file with what was measured is not there."""
    directory, elsewhere, _ = finished
    lab = directory / "lab"
    lab.rename(directory / "gone")
    yield elsewhere
    (directory / "gone").rename(lab)


def test_the_results_file_tells_the_same_by_itself(gone, monkeypatch, capsys):
    _, out, _ = in_process(monkeypatch, capsys, gone, "info", "results/small/small.h5", "--json")
    first, second = json.loads(out)["measured"]
    assert first["frac"] == pytest.approx(1.0, abs=1e-9)
    assert first["level"] == pytest.approx(20.0 * np.log10(2.0), abs=1e-9)
    assert (first["quantity"], first["n_lines"]) == ("receptance", 3)
    assert (second["frac"], second["n_lines"]) == (None, 0)


def test_the_results_file_draws_the_same_by_itself(gone, monkeypatch, capsys):
    in_process(monkeypatch, capsys, gone, "plot", "results/small/small.h5", "--output", "again")
    made, again = (gone / name for name in ("results/small/plots", "again"))
    name = "mobility_radial.png"
    assert (made / name).read_bytes() == (again / name).read_bytes()


@pytest.fixture
def wrong(tmp_path):
    """A case with a measured file whose frequencies fall."""
    (tmp_path / "small.toml").write_text(CASE)
    (tmp_path / "lab").mkdir()
    (tmp_path / "lab" / "run.csv").write_text("10,1,2\n40,1,2\n30,1,2\n")
    return tmp_path


@pytest.mark.parametrize("command", ["run", "check", "sweep --param E_rubber=80e6"])
def test_a_wrong_file_ends_the_command_with_nothing_written(wrong, monkeypatch, capsys, command):
    status, _, err = in_process(
        monkeypatch, capsys, wrong, *command.split()[:1], "small.toml", *command.split()[1:]
    )
    assert status == 2
    assert MESSAGE.partition(": ")[2] in err
    assert not list(wrong.rglob("*.h5"))


@pytest.mark.parametrize("command", ["modes", "dispersion", "compare"])
def test_a_missing_file_ends_every_command_at_once(wrong, monkeypatch, capsys, command):
    (wrong / "lab" / "run.csv").unlink()
    status, out, err = in_process(monkeypatch, capsys, wrong, command, "small.toml")
    assert (status, out) == (2, "")
    assert "small.toml:45: measured[0].file: lab/run.csv cannot be read: No such file" in err
    assert not list(wrong.rglob("*.h5"))


def test_the_message_names_the_line_of_the_case_and_that_of_the_file(wrong, monkeypatch, capsys):
    _, _, err = in_process(monkeypatch, capsys, wrong, "run", "small.toml")
    assert err.startswith(MESSAGE)
