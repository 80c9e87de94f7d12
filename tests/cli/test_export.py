"""`tyrefrf export`, and the exports that a case asks for, as a user types them."""

from __future__ import annotations

import json
import sys

import numpy as np
import pandas
import pytest
import pyuff
import synthetic
from command import tyrefrf_command
from scipy.io import loadmat
from small import TEXT, text_with

import tyrefrf
from tyrefrf.cli.main import main
from tyrefrf.results import write_results

REGION = """
[[probes]]
name = "tread"
kind = "region"
s = [0.4, 0.6]
count = [2, 5]
direction = "r"
"""


@pytest.fixture
def file(tmp_path):
    """A results file in a directory of its own."""
    write_results(tmp_path / "made.up.h5", synthetic.results())
    return tmp_path / "made.up.h5"


def called(monkeypatch, capsys, *arguments):
    """The command in this process: its status, stdout and stderr."""
    monkeypatch.setattr(sys, "argv", ["tyrefrf", *map(str, arguments)])
    with pytest.raises(SystemExit) as exit_:
        main()
    said = capsys.readouterr()
    return exit_.value.code, said.out, said.err


def test_export_writes_beside_the_results_and_names_the_files(file):
    done = tyrefrf_command("export", file, "--to", "uff58,csv,mat", cwd=file.parent)
    assert done.returncode == 0, done.stderr
    names = ["made.up.uff", "made.up.csv", "made.up_bands.csv", "made.up.mat"]
    assert done.stdout.splitlines() == [str(file.parent / name) for name in names]
    made = synthetic.results()
    np.testing.assert_array_equal(loadmat(file.parent / names[3])["mobility"], made.mobility)
    assert len(pyuff.UFF(str(file.parent / names[0])).get_set_types()) == 39
    assert len(pandas.read_csv(file.parent / names[1], comment="#")) == 401


def test_nothing_is_replaced_without_force(file, monkeypatch, capsys):
    (file.parent / "made.up_bands.csv").write_text("mine")
    status, _, error = called(monkeypatch, capsys, "export", file, "--to", "csv")
    assert status == 2
    assert "made.up_bands.csv exists; --force" in error
    assert (file.parent / "made.up_bands.csv").read_text() == "mine"
    assert not (file.parent / "made.up.csv").exists()
    assert called(monkeypatch, capsys, "export", file, "--to", "csv", "--force")[0] == 0
    assert (file.parent / "made.up_bands.csv").read_text() != "mine"


def test_quantity_directory_reference_and_json(file, tmp_path, monkeypatch, capsys):
    status, out, _ = called(
        monkeypatch, capsys, "export", file, "--to", "csv", "--quantity", "receptance",
        "--output", tmp_path / "there", "--reference", "iso1683", "--json",
    )  # fmt: skip
    files = json.loads(out)["files"]
    assert status == 0
    assert files == [
        str(tmp_path / "there" / f"made.up_receptance{end}.csv") for end in ("", "_bands")
    ]
    table = pandas.read_csv(files[1], comment="#").set_index("band [Hz]")
    rms, level = (
        table[f"receptance radial -> shoulder {end}"][1000.0] for end in ("rms [m/N]", "level [dB]")
    )
    assert level == pytest.approx(20 * np.log10(rms / 1e-6))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--to", "uff"], "no format 'uff'; there are uff58, csv, mat, vtk; did you mean 'uff58'"),
        (["--to", ","], "there are uff58, csv, mat, vtk"),
        (["--to", "csv", "--reference", "loud"], "'loud' is no reference"),
        (["--to", "csv", "--quantity", "impedance"], "impedance"),
        ([], "--to"),
    ],
)
def test_a_wrong_command_line_exits_2(file, monkeypatch, capsys, arguments, message):
    status, _, error = called(monkeypatch, capsys, "export", file, *arguments)
    assert status == 2
    assert message in error
    assert [path.name for path in file.parent.iterdir()] == ["made.up.h5"]


def test_a_missing_library_is_named_before_anything_is_computed(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("tyrefrf.results.export.files.find_spec", lambda name: None)
    case = tmp_path / "small.toml"
    case.write_text(TEXT + '[output]\nexport = ["uff58"]\n')
    status, _, error = called(monkeypatch, capsys, "run", case, "--output", tmp_path / "out")
    assert status == 1
    assert 'pip install "tyrefrf[uff]"' in error
    assert not (tmp_path / "out").exists()


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run of a case with a region that asks for all formats, and what it said."""
    directory = tmp_path_factory.mktemp("run")
    (directory / "small.toml").write_text(
        text_with(("values = [0.0, 40.0, 150.0, 420.0]", "start = 20.0\nstop = 150.0\nstep = 5.0"))
        + REGION
        + '[output]\nplots = []\nexport = ["uff58", "csv", "mat"]\n'
    )
    return directory, tyrefrf_command("run", "small.toml", "--jobs", 1, cwd=directory)


def test_run_writes_what_the_case_asks_for(finished):
    directory, done = finished
    assert done.returncode == 0, done.stderr
    made = directory / "results/small"
    names = ["small.h5", "small.uff", "small.csv", "small_bands.csv", "small.mat"]
    assert sorted(path.name for path in made.glob("[!.]*")) == sorted(names)
    assert all(f"results/small/{name}" in done.stdout for name in names)


def test_files_say_the_same_as_the_results(finished):
    directory, _ = finished
    made = directory / "results/small"
    results = tyrefrf.load_results(made / "small.h5")
    m = loadmat(made / "small.mat", simplify_cells=True)
    np.testing.assert_array_equal(m["mobility"], results.mobility)
    functions = [s for s in pyuff.UFF(str(made / "small.uff")).read_sets() if s["type"] == 58]
    np.testing.assert_allclose(functions[2]["data"], results.mobility[0, 2], rtol=1e-11)
    table = pandas.read_csv(made / "small_bands.csv", comment="#").set_index("band [Hz]")
    rms = table["mobility radial -> tread rms [m/(s N)]"]
    assert (rms[[25.0, 31.5, 40.0, 50.0, 63.0, 80.0, 100.0]] > 0.0).all()


def test_info_names_a_region_once(finished):
    directory, _ = finished
    done = tyrefrf_command("info", "results/small/small.h5", cwd=directory)
    assert done.stdout.count("tread") == 1
    assert "tread: r at 10 points of a region" in done.stdout


def test_a_region_is_not_drawn_as_curves(finished):
    directory, _ = finished
    done = tyrefrf_command("plot", "results/small/small.h5", cwd=directory)
    names = sorted(line.rpartition("/")[2] for line in done.stdout.splitlines())
    assert names == [
        "blocked_force.png",
        "driving_points.png",
        "mobility_patch.png",
        "mobility_radial.png",
        "section.png",
    ]
