"""Fields for ParaView beside a run's and the modes' results, as a user asks for them."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest
from small import text_with

from tyrefrf.cli.main import main
from tyrefrf.errors import SingularError
from tyrefrf.solvers import SOLVERS, Recursive

OUTPUT = ("[cell]", '[output]\nplots = []\ndeflections = ["0.1 kHz", 33.3]\n\n[cell]')
STEMS = ["patch_100Hz", "patch_33.3Hz", "radial_100Hz", "radial_33.3Hz"]


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Runs `tyrefrf ...` beside a case that asks for fields: exit status, stdout, stderr."""
    (tmp_path / "small.toml").write_text(text_with(OUTPUT))
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["tyrefrf", *arguments])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        return left.value.code or 0, said.out, said.err

    return call


def names(directory):
    """Files and directories, without those that `ls` hides: the lock."""
    return sorted(path.name for path in directory.glob("[!.]*"))


def test_run_writes_every_load_at_every_frequency_and_says_so(command, tmp_path):
    status, said, err = command("run", "small.toml", "--jobs", "1")
    assert status == 0
    written = names(tmp_path / "results/small/fields")
    assert written == sorted(f"{stem}.{form}" for stem in STEMS for form in ("vtkhdf", "vtu"))
    assert all(f"wrote     results/small/fields/{name}" in said for name in written)
    assert "fields    of all loads on 2 line(s), residual " in said
    assert "small, deflections: 2/2 lines" in err


def test_pictures_are_drawn_beside_the_other_plots_in_the_formats_asked_for(command, monkeypatch):
    drawn = []

    def draw(found, directory, formats):
        drawn.append((getattr(found, "stem", "results"), str(directory), formats))
        return []

    monkeypatch.setattr("tyrefrf.plots.draw_plots", draw)
    command("run", "small.toml", "--jobs", "1", "--format", "svg")
    stems = ["results", STEMS[2], STEMS[0], STEMS[3], STEMS[1]]
    assert drawn == [(stem, "results/small/plots", ("svg",)) for stem in stems]


def test_json_names_the_frequencies_their_residual_and_the_files(command):
    status, said, _ = command("run", "small.toml", "--jobs", "1", "--json")
    facts = json.loads(said)
    assert status == 0
    assert facts["deflections"]["frequencies"] == [100.0, 33.3]
    assert 0.0 < facts["deflections"]["largest_residual"] < 1e-9
    assert facts["deflections"]["failed"] == []
    assert "results/small/fields/radial_33.3Hz.vtu" in facts["files"]


def test_a_failed_deflection_is_named_and_the_run_exits_1(command, tmp_path, monkeypatch):
    class Refusing(Recursive):
        def field(self, omega):
            if omega == 2 * np.pi * 33.3:
                raise SingularError("an undamped resonance lies on this line")
            return super().field(omega)

    monkeypatch.setitem(SOLVERS, "recursive", Refusing)
    status, said, err = command("run", "small.toml", "--jobs", "1")
    assert status == 1
    assert "deflection at 33.3 Hz: an undamped resonance lies on this line" in err
    assert "of all loads on 1 line(s)" in said
    assert ", 1 FAILED" in said
    assert "lines     4, 0 to 420 Hz\n" in said
    assert names(tmp_path / "results/small/fields") == [
        f"{load}_100Hz.{form}" for load in ("patch", "radial") for form in ("vtkhdf", "vtu")
    ]


def test_fields_are_not_replaced_without_force(command, tmp_path):
    there = tmp_path / "out/fields/radial_5Hz.vtu"
    there.parent.mkdir(parents=True)
    there.write_text("precious")
    status, _, why = command("run", "small.toml", "--jobs", "1", "--output", "out")
    assert status == 2
    assert "radial_5Hz.vtu exists; --force replaces it" in why
    assert there.read_text() == "precious"
    assert names(there.parents[1]) == ["fields"]
    assert command("run", "small.toml", "--jobs", "1", "--output", "out", "--force")[0] == 0


def test_modes_write_their_lowest_shapes(command, tmp_path):
    status, said, _ = command("modes", "small.toml", "--count", "9", "--vtk", "2")
    assert status == 0
    written = names(tmp_path / "results/small_modes/fields")
    assert [name.split("_")[1] for name in written] == ["1", "1", "2", "2"]
    assert [name.rpartition(".")[2] for name in written] == ["vtkhdf", "vtu"] * 2
    assert all(f"wrote     results/small_modes/fields/{name}" in said for name in written)
    (tmp_path / "results/small_modes/small_modes.h5").unlink()
    status, _, why = command("modes", "small.toml", "--count", "9", "--vtk", "2")
    assert status == 2
    assert "exists; --force replaces it" in why


def test_more_shapes_than_modes_are_all_of_them(command, tmp_path):
    status, _, _ = command("modes", "small.toml", "--count", "1", "--vtk", "99")
    assert status == 0
    assert len(names(tmp_path / "results/small_modes/fields")) == 2


def test_without_asking_there_are_none(command, tmp_path):
    command("modes", "small.toml", "--count", "1")
    assert names(tmp_path / "results/small_modes") == ["small_modes.h5"]
