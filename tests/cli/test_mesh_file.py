"""A case with a mesh file, as a user types it, from any directory."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from command import tyrefrf_command

import tyrefrf
from tyrefrf.case import Geometry, load_case
from tyrefrf.cli.main import main
from tyrefrf.mesh.profile import tyre_section
from tyrefrf.study.model import build_mesh

SHIPPED = Path(__file__).parents[2] / "cases" / "mesh_section.toml"
SHORT = "stop = 500.0\nstep = 5.0"


@pytest.fixture
def case(tmp_path) -> Path:
    """The shipped case with three lines, its mesh beside it."""
    folder = tmp_path / "tyre"
    (folder / "meshes").mkdir(parents=True)
    mesh = SHIPPED.parent / "meshes" / "section.inp"
    (folder / "meshes" / "section.inp").write_bytes(mesh.read_bytes())
    text = SHIPPED.read_text()
    assert SHORT in text
    path = folder / "tyre.toml"
    path.write_text(text.replace(SHORT, "values = [0.0, 50.0, 100.0]"))
    return path


def test_the_shipped_mesh_is_the_papers_section():
    mesh = build_mesh(load_case(SHIPPED)).section
    geometry = Geometry(material="rubber", elements_along=28, elements_through=2)
    section = tyre_section(geometry, quadratic=False)
    assert np.abs(mesh.points - section.points).max() < 1e-9  # [m]: six digits of a millimetre
    for name in ("quads", "rim", "outer", "inner"):
        assert np.array_equal(getattr(mesh, name), getattr(section, name)), name


def test_the_mesh_is_beside_the_case_wherever_the_user_is(case, tmp_path):
    done = tyrefrf_command("run", "tyre/tyre.toml", "--jobs", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    results = tyrefrf.load_results(tmp_path / "results/mesh_section/mesh_section.h5")
    assert results.section.n_elements == 56
    assert results.probes[1].r == pytest.approx(tyrefrf.run(case, jobs=1).probes[1].r)
    compared = tyrefrf_command(
        *("compare", "tyre/tyre.toml", "--solvers", "cyclic,recursive", "--output", "c"),
        cwd=tmp_path,
    )
    assert compared.returncode == 0, compared.stderr


@pytest.fixture
def said(monkeypatch, capsys):
    """Runs a command in this process; its exit status and what it says."""

    def command(*arguments) -> tuple[int, str]:
        monkeypatch.setattr(sys, "argv", ["tyrefrf", *map(str, arguments)])
        with pytest.raises(SystemExit) as exit_:
            main()
        words = capsys.readouterr()
        return exit_.value.code or 0, words.out + words.err

    return command


def test_check_says_what_was_read(case, said):
    _, words = said("check", case)
    assert "mesh      meshes/section.inp: 87 nodes, 56 quad; r 168 to 278 mm" in words
    assert "mesh      sets of elements: EALL 56, RUBBER 56 (rubber)" in words
    _, facts = said("check", case, "--json")
    assert json.loads(facts)["mesh_file"][2] == "sets of nodes: RIM 6"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"RIM"', '"RIMS"', "tyre.toml:14: mesh.rim: section.inp has no node set 'RIMS'"),
        ('"meshes/section.inp"', '"gone.inp"', "tyre.toml:10: mesh.file: "),
        (
            'element = "hex8i"',
            'element = "hex20"',
            "tyre.toml:28: cell.element: hex20 does not fit",
        ),
        ('"mm" ', '"m" ', "tyre.toml:10: mesh.file: "),
        ("node = 30 ", "node = 3000 ", "tyre.toml:41: probes[0].node: node 3000 is not in the"),
    ],
)
def test_what_does_not_fit_exits_2_with_its_line(case, said, old, new, words):
    text = case.read_text()
    assert old in text
    case.write_text(text.replace(old, new, 1))
    status, found = said("check", case)
    assert status == 2
    assert words in found


def test_a_mesh_file_that_is_wrong_is_named(case, said):
    mesh = case.parent / "meshes" / "section.inp"
    mesh.write_text(mesh.read_text().replace("\n7, 10, 11, 14, 13", "\n7, 10, 14, 11, 13"))
    status, found = said("check", case)
    assert status == 2
    assert "section.inp: element 7 is inverted" in found
