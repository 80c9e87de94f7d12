"""Where memory runs out or is short: a message of one line, status 1, and no traceback."""

from __future__ import annotations

import sys

import pytest
from command import tyrefrf_command
from small import TEXT, text_with

from tyrefrf.cli.main import main
from tyrefrf.study import memory

resource = pytest.importorskip("resource")
NONE_DRAWN = "[output]\nplots = []\n"


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(TEXT + NONE_DRAWN)
    return path


def limited(size: int):
    return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size))}


def told(monkeypatch, capsys, directory, *words):
    """Status and stderr of a command in this process."""
    monkeypatch.chdir(directory)
    monkeypatch.setattr(sys, "argv", ["tyrefrf", *map(str, words)])
    with pytest.raises(SystemExit) as exit_:
        main()
    return exit_.value.code, capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "sweep", "modes", "dispersion", "compare"])
def test_too_little_memory_is_refused_with_the_numbers(
    command, case, monkeypatch, capsys, tmp_path
):
    monkeypatch.setattr(memory, "available_memory", lambda: 1e6)
    monkeypatch.setattr(memory, "resident_now", lambda: 0)
    more = ["--param", "E_rubber=4e7,8e7"] if command == "sweep" else []
    status, said = told(monkeypatch, capsys, tmp_path, command, case, *more)
    assert status == 1
    assert "GB of memory" in said
    assert "0.001 GB are available" in said
    assert "Traceback" not in said
    assert not list(tmp_path.rglob("*.h5"))


def test_a_limit_of_the_shell_counts(case):
    large = text_with(("elements_along = 8", "elements_along = 200\nelements_through = 4"))
    case.write_text(large + NONE_DRAWN)
    done = tyrefrf_command("run", case, "--jobs", 1, cwd=case.parent, **limited(900_000_000))
    assert done.returncode == 1
    assert "are left by the limit on a process (ulimit -v): the most is the solver" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_limit_below_what_every_command_needs_is_said_at_once(case):
    done = tyrefrf_command("run", case, cwd=case.parent, **limited(200_000_000))
    assert done.returncode == 1
    assert done.stderr.startswith("needs 600 MB of memory to begin with, and ")


@pytest.mark.parametrize("size", [400, 630, 680, 760])
def test_whatever_the_limit_there_is_no_traceback(case, size):
    done = tyrefrf_command("run", case, "--jobs", 2, cwd=case.parent, **limited(size * 1_000_000))
    assert done.returncode in (0, 1)
    assert "Traceback" not in done.stderr


def test_memory_that_runs_out_is_one_message(case, monkeypatch, capsys, tmp_path):
    def greedy(*arguments, **more):
        raise MemoryError("Unable to allocate 8. GiB for an array")

    monkeypatch.setattr("tyrefrf.study.run.results_of", greedy)
    status, said = told(monkeypatch, capsys, tmp_path, "run", case, "--jobs", 1)
    assert status == 1
    assert said.splitlines()[-1] == (
        "memory ran out: Unable to allocate 8. GiB for an array; fewer --jobs, frequency lines, "
        "loads or probes, or a coarser mesh take less (`tyrefrf check` says how much a case needs)"
    )
