"""Brought matrices on the command line: every command works, or says why not."""

from __future__ import annotations

import json
import shutil

import h5py
import numpy as np
import pytest
from brought import export
from rings import lopsided, tyre

import tyrefrf
from tyrefrf.case import case_hash, load_case
from tyrefrf.cli.main import main

RING = lopsided(tyre("hex8i", n_cells=9, elements_along=4, elements_around=2))


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    """Where a cell lies as files, and its case, `brought.toml`."""
    directory = tmp_path_factory.mktemp("brought")
    export(RING, directory).case()
    return directory


@pytest.fixture
def command(directory, monkeypatch, capsys):
    """Runs `tyrefrf ...` in another directory than the case's: exit status, stdout, stderr."""
    (directory / "elsewhere").mkdir(exist_ok=True)
    monkeypatch.chdir(directory / "elsewhere")

    def call(*arguments):
        monkeypatch.setattr("sys.argv", ["tyrefrf", *arguments])
        with pytest.raises(SystemExit) as left:
            main()
        said = capsys.readouterr()
        return left.value.code or 0, said.out, said.err

    return call


@pytest.fixture
def unplotted(monkeypatch):
    """Plots take the most time."""
    monkeypatch.setattr("tyrefrf.plots.draw_plots", lambda *_: [])


def test_shapes_need_elements(command):
    status, _, why = command("modes", "../brought.toml", "--count", "1", "--vtk", "1")
    assert status == 2
    assert "a case with [matrices] has none" in why


def test_check_says_what_was_found(command):
    status, said, _ = command("check", "../brought.toml")
    mass = RING.n_cells * RING.cell.sparse(RING.cell.M)[1::3, 1::3].sum()
    assert status == 0
    assert "section   10 nodes, 18 dofs that move" in said
    assert f"mass      {mass:.2f} kg\n" in said
    assert "matrices  K.rubber: K_rubber.mtx, 90 rows, " in said
    assert "matrices  sections: 10 nodes fall on each other within " in said
    assert "matrices  rigid motions: K u is at most " in said
    assert "warning" not in said
    facts = json.loads(command("check", "../brought.toml", "--json")[1])
    assert facts["mass"] == pytest.approx(mass)
    assert facts["resolution"] == []


def test_run_draws_the_nodes_and_certifies_without_finer_cells(command):
    status, said, planned = command("run", "../brought.toml", "--certify", "--output", "run")
    assert status == 0
    assert "none of a refined ring" in planned
    assert "the matrices are of cells of 40 deg, as they are" in said
    results = tyrefrf.load_results("run/brought.h5")
    found, ours = (np.sort(p, axis=0) for p in (results.section.points, RING.mesh.section.points))
    np.testing.assert_allclose(found, ours, atol=1e-15)
    assert results.section.n_elements == 0
    assert results.section.materials == ("rubber", "tread")
    assert results.certificate.difference.max() < 1e-8
    with h5py.File("run/brought.h5") as file:
        assert "K_tread.mtx" in file.attrs["resolved_case"]
    status, said, _ = command("plot", "run/brought.h5", "--output", "again")
    assert status == 0
    assert "section.png" in said


def test_modes_share_their_energy_among_the_parts(command):
    assert command("modes", "../brought.toml", "--count", "6", "--output", "modes")[0] == 0
    found = tyrefrf.load_modes("modes/brought_modes.h5")
    np.testing.assert_allclose(found.energy_share.sum(axis=1), 1.0, atol=1e-9)
    eta = np.array([0.15, 0.03])
    viscous = found.loss_factor - found.energy_share @ eta
    assert np.all(viscous > 0.0)  # C = alpha M + beta K came along


@pytest.mark.usefixtures("unplotted")
def test_dispersion_and_compare_need_nothing_but_the_matrices(command):
    assert command("dispersion", "../brought.toml", "--lines", "3", "--output", "waves")[0] == 0
    status, said, _ = command(
        "compare", "../brought.toml", "--solvers", "recursive,cyclic", "--output", "compared"
    )
    assert status == 0
    assert "cyclic" in said


@pytest.mark.usefixtures("unplotted")
def test_a_sweep_over_a_loss_factor_is_the_runs_it_stands_for(command, directory):
    status, _, _ = command(
        "sweep", "../brought.toml", "--param", "eta_rubber", "--values", "0.15,0.3", "--output", "s"
    )
    assert status == 0
    swept = tyrefrf.load_sweep("s/brought_sweep.h5")
    text = (directory / "brought.toml").read_text()
    (directory / "lossy.toml").write_text(text.replace("eta = 0.15", "eta = 0.3"))
    plain = tyrefrf.run(directory / "brought.toml", jobs=1)
    lossy = tyrefrf.run(directory / "lossy.toml", jobs=1)
    np.testing.assert_array_equal(swept.points[0].receptance, plain.receptance)
    np.testing.assert_array_equal(swept.points[1].receptance, lossy.receptance)


@pytest.mark.parametrize(
    ("parameter", "message"),
    [
        ("E_rubber", "no parameter 'E_rubber' in this case; there are eta_rubber, eta_tread"),
        ("pressure", "there is no surface to press on; bring the stiffness of the inflated"),
        ("sector_angle", "turned by cell.sector_angle = 20 deg about the axle, falls on no node"),
        ("elements_around", "not together with [matrices]: there are no elements"),
    ],
)
def test_a_sweep_of_what_matrices_do_not_have_is_refused(command, parameter, message):
    values = "20" if parameter == "sector_angle" else "2"
    status, _, said = command("sweep", "../brought.toml", "--param", parameter, "--values", values)
    assert status == 2
    assert message in said


def test_a_file_that_is_wrong_is_named_at_the_line_of_its_key(command, directory):
    text = (directory / "brought.toml").read_text()
    (directory / "wrong.toml").write_text(text.replace('M = "M.mtx"', 'M = "mass.mtx"'))
    status, _, said = command("check", "../wrong.toml")
    assert status == 2
    assert said.startswith("../wrong.toml:2: matrices.M: ")
    assert said.endswith("mass.mtx cannot be read: No such file or directory\n")


def test_the_hash_of_a_case_is_of_what_its_files_hold(directory, tmp_path):
    shutil.copytree(directory, tmp_path / "copy")
    here, there = (load_case(d / "brought.toml") for d in (directory, tmp_path / "copy"))
    assert case_hash(here) == case_hash(there)
    path = tmp_path / "copy/rim.txt"
    path.write_text(path.read_text() + "# another\n")
    assert case_hash(here) != case_hash(there)


def test_a_run_warns_of_matrices_along_other_directions_than_said(command, directory, unplotted):
    text = (directory / "brought.toml").read_text()
    assert 'directions = "cartesian"' in text
    (directory / "turned.toml").write_text(text.replace("cartesian", "cylindrical"))
    _, _, said = command("run", "../turned.toml", "--output", str(directory / "turned"))
    assert said.startswith("warning: ")
    assert "rigid translations strain the cell" in said
