"""`tyrefrf sweep` as a user types it: what it prints, writes, and exits with."""

from __future__ import annotations

import json
import os
import re
import sys

import numpy as np
import pytest
import xarray
from command import tyrefrf_command
from small import TEXT

import tyrefrf
from tyrefrf.case import Range
from tyrefrf.cli.main import main
from tyrefrf.cli.sweeping import parameters_of
from tyrefrf.errors import CommandError, SingularError
from tyrefrf.solvers import SOLVERS, Recursive
from tyrefrf.study.run import run_case

OWN = '\n[sweep]\nE_rubber = ["40 MPa", "80 MPa"]\n'


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A directory with two cases, one of them with values of its own."""
    (tmp_path / "small.toml").write_text(TEXT)
    (tmp_path / "own.toml").write_text(TEXT + OWN)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def sweep(here, monkeypatch, capsys):
    """Run `tyrefrf sweep` in this process: exit status, stdout, stderr."""

    def run(*arguments, command="sweep"):
        monkeypatch.setattr(sys, "argv", ["tyrefrf", command, *map(str, arguments)])
        with pytest.raises(SystemExit) as exit_:
            main()
        said = capsys.readouterr()
        return exit_.value.code or 0, said.out, said.err

    return run


NO_PLOTS = TEXT + "\n[output]\nplots = []\n"


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A directory with a sweep that was run, and what it said."""
    directory = tmp_path_factory.mktemp("sweep")
    (directory / "small.toml").write_text(TEXT)
    arguments = ("sweep", "small.toml", "--param", "E_rubber", "--values", "40,80 MPa")
    return directory, tyrefrf_command(*arguments, cwd=directory)


def test_a_sweep_writes_one_file_and_plots_and_says_so(finished):
    directory, done = finished
    assert done.returncode == 0, done.stderr
    file = directory / "results/small_sweep/small_sweep.h5"
    swept = tyrefrf.load_sweep(file)
    assert swept.axes[0].values == (40e6, 80e6)
    assert swept.provenance.case_text == TEXT
    plots = [path.name for path in (directory / "results/small_sweep/plots").iterdir()]
    assert "mobility_radial_drive.png" in plots
    for name in ("small_sweep.h5", *(f"plots/{plot}" for plot in plots)):
        assert f"results/small_sweep/{name}" in done.stdout
    assert re.search(r"lines +2 x 4, 0 to 420 Hz", done.stdout)
    assert "parameter E_rubber (Young's modulus): 40 MPa, 80 MPa" in done.stdout
    level = float(re.search(r"E_rubber = 80 MPa: radial (-[\d.]+)", done.stdout)[1])
    assert level == pytest.approx(swept.level("radial")[1], abs=0.006)
    with xarray.open_dataset(file, engine="h5netcdf") as data:
        assert data["mobility"].sel(E_rubber=80e6).shape == (2, 3, 4)


def test_a_sweep_s_point_is_the_run_of_that_case(finished):
    directory, _ = finished
    swept = tyrefrf.load_sweep(directory / "results/small_sweep/small_sweep.h5")
    alone = run_case(tyrefrf.load_case(directory / "small.toml"), jobs=1)
    np.testing.assert_array_equal(swept.point(E_rubber=80e6).mobility, alone.mobility)


def test_progress_counts_the_lines_of_all_points(finished):
    _, done = finished
    assert re.search(r"small, 2 points: 8/8 lines, [\d.]+ lines/s, 0 s left", done.stderr)


def test_nothing_is_overwritten_without_force(finished):
    directory, _ = finished
    target = directory / "results/small_sweep/small_sweep.h5"
    before = target.stat().st_mtime_ns
    arguments = ("sweep", "small.toml", "--param", "E_rubber=50e6", "--format", "svg")
    refused = tyrefrf_command(*arguments, cwd=directory)
    assert refused.returncode == 2
    assert "--force" in refused.stderr
    assert target.stat().st_mtime_ns == before
    (directory / "keep.h5").write_bytes(target.read_bytes())
    assert tyrefrf_command(*arguments, "--force", cwd=directory).returncode == 0
    assert tyrefrf.load_sweep(target).shape == (1,)
    (directory / "keep.h5").replace(target)


def test_info_and_plot_understand_a_sweep(finished, tmp_path):
    directory, _ = finished
    file = "results/small_sweep/small_sweep.h5"
    said = tyrefrf_command("info", file, cwd=directory)
    assert said.returncode == 0
    assert "parameter E_rubber (Young's modulus): 40 MPa, 80 MPa" in said.stdout
    facts = json.loads(tyrefrf_command("info", file, "--json", cwd=directory).stdout)
    assert facts["parameters"][0]["values"] == [40e6, 80e6]
    drawn = tyrefrf_command("plot", file, "--output", tmp_path, "--format", "pdf", cwd=directory)
    assert drawn.returncode == 0
    assert len(list(tmp_path.glob("*.pdf"))) == len(drawn.stdout.splitlines()) > 5


def test_json_is_one_object_on_stdout(sweep, here):
    (here / "small.toml").write_text(NO_PLOTS)
    status, out, _ = sweep(
        "small.toml", "--param", "E_rubber", "--values", "40,80 MPa", "--param", "crown",
        "--range", "12:14 mm:3", "--json", "--jobs", 1, "--output", "out",
    )  # fmt: skip
    facts = json.loads(out)
    assert status == 0
    assert [p["place"] for p in facts["parameters"]] == [
        "materials.rubber.E",
        "geometry.thickness.crown",
    ]
    assert facts["points"] == 6
    assert facts["lines"] == 4
    assert len(facts["levels"]["radial"]) == 6
    assert facts["labels"][5] == "E_rubber = 80 MPa, crown = 14 mm"
    assert facts["files"] == ["out/small_sweep.h5"]
    assert facts["failed"] == []
    assert facts["largest_residual"] < 1e-10


def test_solver_and_format_can_be_named(sweep):
    status, out, _ = sweep(
        "own.toml", "--param", "E_rubber", "--solver", "cyclic", "--format", "svg", "--jobs", 1,
        "--json",
    )  # fmt: skip
    facts = json.loads(out)
    assert (status, facts["solver"]) == (0, "cyclic")
    assert all(name.endswith((".svg", ".h5")) for name in facts["files"])


@pytest.mark.parametrize("named", [("--param", "materials.rubber.E"), ()], ids=["place", "nothing"])
def test_the_case_s_own_values_serve(sweep, here, named):
    (here / "own.toml").write_text(NO_PLOTS + OWN)
    status, out, _ = sweep("own.toml", *named, "--json", "--jobs", 1)
    assert status == 0
    assert json.loads(out)["parameters"][0]["values"] == [40e6, 80e6]


def test_without_a_case_it_takes_case_toml_here(sweep, here):
    (here / "case.toml").write_text(NO_PLOTS + OWN)
    status, out, _ = sweep("--param", "E_rubber", "--json", "--jobs", 1)
    assert (status, json.loads(out)["case"]) == (0, "case")
    assert (here / "results/case_sweep/case_sweep.h5").exists()


def test_without_any_case_it_takes_the_built_in_tyre(sweep, monkeypatch):
    from tyrefrf.study import sweep as study

    seen = []

    def remembered(grid, **_):
        seen.append(grid)
        raise CommandError("enough")

    monkeypatch.setattr(study, "run_sweep", remembered)
    status, _, err = sweep("--param", "E_rubber")
    assert (status, "enough" in err) == (2, True)
    assert seen[0].axes[0].place == "materials.rubber.E"
    assert len(seen[0].cases) >= 3


def test_failed_lines_are_named_and_the_sweep_exits_1(sweep, here, monkeypatch):
    class Refusing(Recursive):
        def field(self, omega):
            if omega > 2 * np.pi * 400:
                raise SingularError("not today")
            return super().field(omega)

    (here / "small.toml").write_text(NO_PLOTS)
    monkeypatch.setitem(SOLVERS, "recursive", Refusing)
    status, out, err = sweep(
        "small.toml", "--param", "E_rubber", "--values", "40e6,80e6", "--jobs", 1, "--json"
    )
    failed = json.loads(out)["failed"]
    assert status == 1
    assert [line.partition("; ")[0] for line in failed] == [
        f"E_rubber = {E} MPa: 420 Hz: not today" for E in (40, 80)
    ]
    assert all(line in err for line in failed)
    assert tyrefrf.load_sweep(here / "results/small_sweep/small_sweep.h5").n_failed == 2


BAD = {
    "unknown parameter": (
        ("--param", "E_ruber", "--values", "1"),
        r"sweep of small.toml: no parameter 'E_ruber' .*; did you mean 'E_rubber'\?",
    ),
    "no values": (("--param", "E_rubber"), r"E_rubber: no values; give --values.*\[sweep\] is emp"),
    "no parameter": ((), r"no --param; name one"),
    "values without a parameter": (("--values", "1,2"), r"--values '1,2' belongs to no --param"),
    "values twice": (
        ("--param", "E_rubber", "--values", "1", "--log", "1:2:3"),
        r"--log '1:2:3': E_rubber has values already",
    ),
    "named twice": (("--param", "crown=1", "--param", "crown=2"), r"--param crown is given twice"),
    "no range": (("--param", "crown", "--range", "1:2"), r"--range '1:2' is not a range; give"),
    "empty value": (("--param", "crown", "--values", "1,,2"), r"a value is empty"),
    "no number": (
        ("--param", "E_rubber", "--values", "soft"),
        r"sweep of small.toml: E_rubber: 'soft' is not a number with a unit",
    ),
}


@pytest.mark.parametrize(("arguments", "message"), BAD.values(), ids=BAD)
def test_a_wrong_command_line_exits_2_and_says_why(sweep, here, arguments, message):
    status, out, err = sweep("small.toml", *arguments)
    assert (status, out) == (2, "")
    assert re.search(message, err), err
    assert not (here / "results").exists()


def test_all_bad_points_are_said_together_before_anything_is_computed(sweep, here):
    status, _, err = sweep(
        "small.toml", "--param", "sector_angle", "--values", "7,24,11", "--param", "crown=14,90 mm"
    )
    assert status == 2
    assert err.splitlines() == [
        "sweep of small.toml: sector_angle: 7 deg does not divide 360 deg; "
        "nearest: 7.2 deg (50 cells)",
        "sweep of small.toml: sector_angle: 11 deg does not divide 360 deg; "
        "nearest: 11.25 deg (32 cells)",
        "sweep of small.toml:3: crown = 90 mm: geometry.thickness.crown: 0.09 m is too large; "
        "must be below outer_radius - widest_radius = 0.053 m",
    ]
    assert not (here / "results").exists()


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        ([("param", "E_rubber")], {"E_rubber": None}),
        ([("param", "a=1,2")], {"a": (1.0, 2.0)}),
        ([("param", "a"), ("values", "1, 2e3")], {"a": (1.0, 2000.0)}),
        ([("param", "a"), ("values", "14 MPa,28")], {"a": ("14 MPa", 28.0)}),
        ([("param", "a"), ("values", "14,28MPa")], {"a": ("14 MPa", "28MPa")}),
        ([("param", "a"), ("values", "-1,1e-3,5")], {"a": (-1.0, 0.001, 5.0)}),
        (
            [("param", "a"), ("param", "b"), ("range", "1:2 mm:3")],
            {"a": None, "b": Range(range=("1 mm", "2 mm"), count=3)},
        ),
        (
            [("param", "b"), ("log", "1e6:4e6:3"), ("param", "a=1:3:3")],
            {
                "b": Range(range=(1e6, 4e6), count=3, spacing="log"),
                "a": Range(range=(1.0, 3.0), count=3),
            },
        ),
    ],
)
def test_values_belong_to_the_parameter_before_them(given, wanted):
    assert parameters_of(given) == wanted
    assert list(parameters_of(given)) == list(wanted)


def test_help_teaches(tmp_path):
    wide = os.environ | {"COLUMNS": "100"}
    done = tyrefrf_command("sweep", "--help", cwd=tmp_path, env=wide)
    assert done.returncode == 0
    for word in ("--param", "--values", "--range", "--log", "E_rubber", "sector_angle"):
        assert word in done.stdout
