"""`tyrefrf export --to vtk`: deflections of a run and shapes of modes, from their files alone."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from small import case_with

import tyrefrf
from tyrefrf.cli.main import main
from tyrefrf.errors import SingularError
from tyrefrf.solvers import SOLVERS, Recursive

CASES = Path(__file__).parents[2] / "cases"
LINES = ("values = [0.0, 40.0, 150.0, 420.0]", "values = [40.0]")


@pytest.fixture
def export(tmp_path, monkeypatch, capsys):
    """Runs `tyrefrf export ...` in a directory of its own: exit status, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["tyrefrf", "export", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        return left.value.code or 0, said.out, said.err

    return call


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """The file of a run, alone in a directory."""
    path = tmp_path_factory.mktemp("run") / "small.h5"
    tyrefrf.write_results(path, tyrefrf.run(case_with(LINES), jobs=1))
    return path


@pytest.fixture(scope="module")
def modes(tmp_path_factory) -> Path:
    """The file of nine frequencies, alone in a directory."""
    path = tmp_path_factory.mktemp("modes") / "small_modes.h5"
    tyrefrf.results.write_modes(path, tyrefrf.modes(case_with(LINES), count=15))
    return path


def same_files(one: Path, other: Path) -> bool:
    return one.read_bytes() == other.read_bytes()


def test_a_run_is_solved_again_at_the_frequencies_asked_for(export, run, tmp_path):
    status, said, _ = export(run, "--to", "vtk", "--at", "0.1 kHz", "--at", 33.3, "--output", "o")
    assert status == 0
    stems = ["radial_100Hz", "patch_100Hz", "radial_33.3Hz", "patch_33.3Hz"]
    assert said.splitlines() == [
        f"o/fields/{stem}.{form}" for stem in stems for form in ("vtkhdf", "vtu")
    ]
    radial, patch = tyrefrf.deflections(case_with(LINES), [100.0])
    for name, deflection in {"radial": radial, "patch": patch}.items():
        tyrefrf.write_vtu(tmp_path / "own.vtu", deflection)
        assert same_files(tmp_path / "own.vtu", tmp_path / f"o/fields/{name}_100Hz.vtu")


def test_without_frequencies_they_are_those_of_the_case(export, tmp_path):
    case = case_with(LINES, ("[cell]", "[output]\ndeflections = [55.0]\n\n[cell]"))
    tyrefrf.write_results(tmp_path / "own.h5", tyrefrf.run(case, jobs=1))
    status, said, _ = export("own.h5", "--to", "vtk")
    assert status == 0
    assert said.split() == [
        f"fields/{name}_55Hz.{form}" for name in ("radial", "patch") for form in ("vtkhdf", "vtu")
    ]


@pytest.mark.parametrize(
    ("arguments", "count"), [([], 6), (["--shapes", 2], 2), (["--shapes", 99], 9)]
)
def test_modes_have_their_lowest_shapes(export, modes, tmp_path, arguments, count):
    status, said, _ = export(modes, "--to", "vtk", *arguments, "--output", "o", "--json")
    found = tyrefrf.load_modes(modes)
    files = [tmp_path / name for name in json.loads(said)["files"]]
    assert status == 0
    assert len(files) == 2 * count
    assert all(path.is_file() for path in files)
    tyrefrf.write_vtu(tmp_path / "own.vtu", tyrefrf.mode_deflection(found, 2))
    assert same_files(tmp_path / "own.vtu", files[3])


def test_fields_and_tables_are_written_together(export, run):
    status, said, _ = export(run, "--to", "csv,vtk", "--at", "100", "--output", "o")
    assert status == 0
    assert said.split()[-2:] == ["o/small.csv", "o/small_bands.csv"]
    assert len(said.split()) == 6


def test_only_what_would_be_replaced_is_refused(export, modes, tmp_path):
    assert export(modes, "--to", "vtk", "--shapes", 1, "--output", "o")[0] == 0
    (there,) = (tmp_path / "o/fields").glob("*.vtu")
    there.write_text("mine")
    (tmp_path / "o/fields/mode_8_1Hz.vtu").write_text("another's")
    status, _, why = export(modes, "--to", "vtk", "--shapes", 2, "--output", "o")
    assert status == 2
    assert f"{there.name} exists; --force" in why
    assert there.read_text() == "mine"
    assert len(list((tmp_path / "o/fields").iterdir())) == 3
    assert export(modes, "--to", "vtk", "--shapes", 2, "--output", "o", "--force")[0] == 0
    assert there.read_text() != "mine"


def test_another_frequency_of_a_run_replaces_nothing(export, run, tmp_path):
    there = tmp_path / "o/fields/radial_50Hz.vtu"
    there.parent.mkdir(parents=True)
    there.write_text("mine")
    assert export(run, "--to", "vtk", "--at", 60, "--output", "o")[0] == 0
    status, _, why = export(run, "--to", "vtk", "--at", 50, "--output", "o")
    assert status == 2
    assert "radial_50Hz.vtu exists; --force" in why
    assert there.read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--to", "vtk"], '--to vtk: at which frequencies? give --at "100 Hz"'),
        (["--to", "vtk", "--at", "low"], "--at: 'low' is not a number with a unit"),
        (["--to", "vtk", "--at", "5 mm"], "--at: "),
        (["--to", "vtk", "--at", "-5"], "--at: -5.0 Hz is out of range"),
        (["--to", "vtk", "--at", "5", "--at", "5 Hz"], "--at: 5 Hz is listed twice"),
        (["--to", "vtk", "--shapes", "3"], "--shapes is of a file of modes"),
        (["--to", "csv", "--at", "5"], "--at is an option of --to vtk"),
        (["--to", "vtks"], "did you mean 'vtk'"),
    ],
)
def test_a_wrong_command_line_exits_2(export, run, tmp_path, arguments, words):
    status, _, why = export(run, *arguments, "--output", "o")
    assert status == 2
    assert words in why
    assert not (tmp_path / "o").exists()


def test_modes_have_frequencies_of_their_own(export, modes):
    status, _, why = export(modes, "--to", "vtk", "--at", 50)
    assert status == 2
    assert "--at is of a run's file" in why


def test_a_table_of_moduli_has_to_reach_that_far(export, tmp_path):
    rows = "frequencies = [1.0, 100.0], E = [8e7, 8e7], eta = [0.1, 0.1]"
    table = f'modulus = {{ kind = "table", {rows} }}'
    case = case_with(LINES, ('E = "80 MPa"\n', ""), ("eta = 0.1", table))
    tyrefrf.write_results(tmp_path / "own.h5", tyrefrf.run(case, jobs=1))
    status, _, why = export("own.h5", "--to", "vtk", "--at", 500)
    assert status == 2
    assert "--at: materials.rubber.modulus.frequencies: " in why


def test_a_sweep_has_no_fields(export, tmp_path):
    study = tyrefrf.sweep(case_with(LINES), {"E_rubber": [4e7, 8e7]}, jobs=1)
    tyrefrf.write_sweep(tmp_path / "s.h5", study)
    status, _, why = export("s.h5", "--to", "vtk", "--at", 50)
    assert status == 1
    assert "s.h5: holds a sweep, which has no fields" in why


def test_a_frequency_without_an_answer_is_named_and_exits_1(export, run, monkeypatch):
    class Refusing(Recursive):
        def field(self, omega):
            raise SingularError("an undamped resonance lies on this line")

    monkeypatch.setitem(SOLVERS, "recursive", Refusing)
    status, said, why = export(run, "--to", "vtk,csv", "--at", 50, "--output", "o")
    assert status == 1
    assert "deflection at 50 Hz: an undamped resonance lies on this line" in why
    assert said.split() == ["o/small.csv", "o/small_bands.csv"]


@pytest.fixture(scope="module")
def from_mesh(tmp_path_factory) -> Path:
    """The file of a run whose case names a mesh file."""
    path = tmp_path_factory.mktemp("mesh") / "mesh_section.h5"
    text = (CASES / "mesh_section.toml").read_text().replace("stop = 500.0", "stop = 5.0")
    case = tyrefrf.case.parse_case(text, "mesh_section.toml", "mesh_section").beside(CASES)
    tyrefrf.write_results(path, tyrefrf.run(case, jobs=1))
    return path


def test_files_that_the_case_names_have_to_be_there(export, from_mesh, tmp_path):
    status, _, why = export(from_mesh, "--to", "vtk", "--at", 50, "--output", "o")
    assert status == 2
    assert "mesh.file: meshes/section.inp cannot be read" in why
    assert "--files DIR says where it is" in why
    options = ["--at", 50, "--files", CASES, "--output", "o"]
    assert export(from_mesh, "--to", "vtk", *options)[0] == 0
    assert len(list((tmp_path / "o/fields").iterdir())) == 2


def test_files_that_have_changed_are_refused(export, from_mesh, tmp_path):
    (tmp_path / "meshes").mkdir()
    mesh = (CASES / "meshes/section.inp").read_text()
    (tmp_path / "meshes/section.inp").write_text(mesh + "** another\n")
    status, _, why = export(from_mesh, "--to", "vtk", "--at", 50, "--output", "o")
    assert status == 2
    assert "(mesh.file) is not what it was when they were computed" in why
    assert not (tmp_path / "o").exists()
