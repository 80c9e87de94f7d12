"""Every command as a user types it: what it prints, writes, and exits with."""

import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest
from command import tyrefrf_command
from small import TEXT, text_with

import tyrefrf
from tyrefrf.cli.main import main
from tyrefrf.errors import SingularError
from tyrefrf.solvers import SOLVERS, Recursive


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(TEXT)
    return path


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A directory with a case that was run, and what the run said."""
    directory = tmp_path_factory.mktemp("run")
    (directory / "small.toml").write_text(TEXT)
    return directory, tyrefrf_command("run", "small.toml", cwd=directory)


def test_run_writes_results_and_plots_and_says_so(finished):
    directory, done = finished
    assert done.returncode == 0, done.stderr
    results = tyrefrf.load_results(directory / "results/small/small.h5")
    assert results.provenance.case_text == TEXT
    assert results.frequency.tolist() == [0.0, 40.0, 150.0, 420.0]
    plots = sorted(path.name for path in (directory / "results/small/plots").iterdir())
    assert plots == [
        "blocked_force.png",
        "driving_points.png",
        "mobility_patch.png",
        "mobility_radial.png",
        "section.png",
    ]
    for name in plots:
        assert f"results/small/plots/{name}" in done.stdout
    assert re.search(r"lines +4, 0 to 420 Hz", done.stdout)
    residual = float(re.search(r"residual +(\S+) at most", done.stdout)[1])
    assert residual == pytest.approx(results.residual.max(), rel=0.1)


def test_progress_goes_to_stderr_in_plain_lines(finished):
    _, done = finished
    assert re.search(r"small: 4/4 lines, [\d.]+ lines/s, 0 s left", done.stderr)
    assert "\x1b" not in done.stderr


def test_nothing_is_overwritten_without_force(finished):
    directory, _ = finished
    target = directory / "results/small/small.h5"
    before = target.stat().st_mtime_ns
    refused = tyrefrf_command("run", "small.toml", cwd=directory)
    assert refused.returncode == 2
    assert "--force" in refused.stderr
    assert target.stat().st_mtime_ns == before
    assert tyrefrf_command("run", "small.toml", "--force", cwd=directory).returncode == 0
    assert target.stat().st_mtime_ns > before


def test_json_is_one_object_on_stdout_and_nothing_else(case):
    done = tyrefrf_command("run", case, "--json", "--output", "out", cwd=case.parent)
    facts = json.loads(done.stdout)
    assert done.returncode == 0
    assert facts["lines"] == 4
    assert facts["largest_residual"] < 1e-10
    assert facts["failed"] == []
    assert "out/small.h5" in facts["files"]


def test_solver_and_format_can_be_named(case):
    done = tyrefrf_command(
        "run", case, "--solver", "cyclic", "--format", "svg", "--jobs", 1, "--json",
        cwd=case.parent,
    )  # fmt: skip
    facts = json.loads(done.stdout)
    assert facts["solver"] == "cyclic"
    assert all(name.endswith((".svg", ".h5")) for name in facts["files"])


def test_failed_lines_are_named_and_the_run_exits_1(case, monkeypatch, capsys):
    """A solver that refuses one line: the others are kept, the file has a gap there."""

    class Refusing(Recursive):
        def field(self, omega):
            if omega > 2 * np.pi * 400:
                raise SingularError("not today")
            return super().field(omega)

    monkeypatch.setitem(SOLVERS, "recursive", Refusing)
    monkeypatch.chdir(case.parent)
    monkeypatch.setattr(sys, "argv", ["tyrefrf", "run", str(case), "--jobs", "1", "--json"])
    with pytest.raises(SystemExit) as exit_:
        main()
    said = capsys.readouterr()
    assert exit_.value.code == 1
    (failed,) = json.loads(said.out)["failed"]
    assert failed.startswith("420 Hz: not today; ")
    assert failed in said.err
    results = tyrefrf.load_results(case.parent / "results/small/small.h5")
    assert results.failed.tolist() == [False, False, False, True]


def test_check_counts_and_computes_nothing(case):
    done = tyrefrf_command("check", case, "--json", cwd=case.parent)
    facts = json.loads(done.stdout)
    assert done.returncode == 0
    assert (facts["section_nodes"], facts["n_cells"], facts["n_lines"]) == (18, 15, 4)
    assert facts["ring_dofs"] == 3 * 18 * 15
    assert facts["resolution"][0]["material"] == "rubber"
    assert facts["seconds"] > 0
    assert [path.name for path in case.parent.iterdir()] == ["small.toml"]


def test_check_knows_the_paper_s_sizes(tmp_path):
    init = tyrefrf_command("init", cwd=tmp_path)
    assert init.returncode == 0
    facts = json.loads(tyrefrf_command("check", "case.toml", "--json", cwd=tmp_path).stdout)
    sizes = {name: facts[name] for name in SIZES}
    assert sizes == SIZES


SIZES = {
    "section_nodes": 58,
    "section_elements": 28,
    "cell_nodes": 116,
    "cell_dofs": 348,
    "n_cells": 45,
    "ring_nodes": 2610,
    "ring_dofs": 7830,
    "free_section_dofs": 162,
}  # section 3.2 of the paper; four nodes of a section on the rim


def test_check_warns_of_coarse_elements_and_small_discs(case):
    done = tyrefrf_command("check", case, cwd=case.parent)
    assert re.search(r"rubber: [\d.]+ elements per wavelength", done.stdout)
    assert re.search(r"patch: elements of up to [\d.]+ mm are larger than the disc", done.stdout)


def test_all_problems_of_a_case_come_with_their_lines(case):
    case.write_text(
        text_with(("sector_angle = 24.0", "sector_angle = 7.0"), ("eta = 0.1", "etha = 0.1"))
    )
    done = tyrefrf_command("run", case, cwd=case.parent)
    assert done.returncode == 2
    assert re.search(r"small.toml:11: materials.rubber.etha: .*did you mean 'eta'", done.stderr)
    assert re.search(r"small.toml:14: cell.sector_angle: .*7.2 deg \(50 cells\)", done.stderr)
    assert not (case.parent / "results").exists()


def test_places_off_the_mesh_come_with_their_lines(case):
    case.write_text(text_with(("s = 0.5\n", "node = 18\n"), ("s = 0.31", "s = 0.01")))
    done = tyrefrf_command("check", case, cwd=case.parent)
    assert done.returncode == 2
    assert re.search(r"small.toml:22: loads\[0\].node: node 18 .* 18 nodes", done.stderr)
    assert re.search(r"small.toml:28: loads\[1\].s: .* reaches over the rim", done.stderr)


def test_a_probe_on_the_fixed_rim_is_refused(case):
    case.write_text(text_with(("s = 0.8", "s = 1.0")))
    done = tyrefrf_command("check", case, cwd=case.parent)
    assert done.returncode == 2
    assert re.search(r"small.toml:\d+: probes\[0\].s: 'sidewall' lies on the rim", done.stderr)


def test_plot_draws_the_same_again(finished, tmp_path):
    directory, _ = finished
    done = tyrefrf_command(
        "plot", "results/small/small.h5", "--output", tmp_path, "--format", "pdf", cwd=directory
    )
    assert done.returncode == 0
    assert len(list(tmp_path.glob("*.pdf"))) == len(done.stdout.splitlines()) == 5


def test_info_says_what_a_file_holds(finished):
    directory, _ = finished
    done = tyrefrf_command("info", "results/small/small.h5", cwd=directory)
    assert "Small tyre" in done.stdout
    assert "sidewall: y at outer 0.800" in done.stdout
    facts = json.loads(
        tyrefrf_command("info", "results/small/small.h5", "--json", cwd=directory).stdout
    )
    assert facts["blocked_force"] == ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]


def test_init_writes_a_case_that_runs_and_keeps_what_is_there(tmp_path):
    assert tyrefrf_command("init", "my.toml", cwd=tmp_path).returncode == 0
    assert (tmp_path / "tyrefrf.schema.json").exists()
    assert (tmp_path / "my.toml").read_text().startswith("#:schema ./tyrefrf.schema.json")
    again = tyrefrf_command("init", "my.toml", cwd=tmp_path)
    assert again.returncode == 2
    assert "exists" in again.stderr


def test_schema_is_json(tmp_path):
    done = tyrefrf_command("schema", cwd=tmp_path)
    assert "geometry" in json.loads(done.stdout)["properties"]


@pytest.mark.parametrize(
    "arguments", [("run", "nowhere.toml"), ("run", "--nonsense"), ("dance",), ("check", ".")]
)
def test_a_wrong_command_line_exits_2_without_a_traceback(tmp_path, arguments):
    done = tyrefrf_command(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr
    assert "Traceback" not in done.stderr


def test_something_else_than_results_is_refused(case):
    done = tyrefrf_command("plot", case, cwd=case.parent)
    assert done.returncode == 1
    assert "not an HDF5 file" in done.stderr


def test_unwritable_output_is_one_message(case):
    (case.parent / "taken").write_text("a file where the directory should be")
    done = tyrefrf_command("run", case, "--output", "taken", cwd=case.parent)
    assert done.returncode == 1
    assert "taken" in done.stderr
    assert "Traceback" not in done.stderr


COMMANDS = [
    "run",
    "sweep",
    "compare",
    "modes",
    "dispersion",
    "check",
    "plot",
    "export",
    "info",
    "init",
    "schema",
]


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_teaches(tmp_path, command):
    done = tyrefrf_command(
        *command.split(), "--help", cwd=tmp_path, env=os.environ | {"COLUMNS": "100"}
    )
    assert done.returncode == 0
    assert "Usage" in done.stdout


def test_version(tmp_path):
    assert re.fullmatch(r"\d+\.\d+\.\d+\n", tyrefrf_command("--version", cwd=tmp_path).stdout)


def test_help_imports_nothing_heavy(tmp_path):
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "tyrefrf", "--help"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=True,
    )
    for package in ("numpy", "scipy", "h5py", "matplotlib", "pydantic", "joblib", "distributed"):
        assert not re.search(rf"\| +{package}\b", done.stderr), package


def test_run_reports_the_inflation_and_how_it_converged(case):
    case.write_text(text_with(("[cell]", '[inflation]\npressure = "1 bar"\n\n[cell]')))
    done = tyrefrf_command("run", case, "--output", "out", "--jobs", 1, cwd=case.parent)
    assert re.search(
        r"pressure +1 bar moves the section by up to [\d.]+ mm .*outwards by [\d.]+ N .*residual",
        done.stdout,
    )
    assert (case.parent / "out/plots/inflation.png").exists()
    facts = json.loads(tyrefrf_command("info", "out/small.h5", "--json", cwd=case.parent).stdout)
    assert facts["inflation"]["pressure"] == 1e5
    assert facts["inflation"]["resultant"][0] > 0.0
    assert 0.0 < facts["inflation_strain"] < 0.15
    assert facts["remarks"] == []


def test_a_linear_inflation_with_large_strains_is_remarked(case):
    case.write_text(text_with(("[cell]", '[inflation]\npressure = "30 bar"\n\n[cell]')))
    done = tyrefrf_command("run", case, "--jobs", 1, cwd=case.parent)
    assert "  remark    the linear inflation strains the tyre by up to " in done.stdout
    assert done.returncode == 0
