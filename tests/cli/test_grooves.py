"""What the commands say of a tyre with grooves."""

import re

import pytest
from command import tyrefrf_command
from small import text_with

GROOVED = text_with(
    (
        'material = "rubber"\n\n[materials',
        'material = "rubber"\n\n[geometry.tread]\nmaterial = "rubber"\n\n[geometry.tread.grooves]\n'
        'width = "20 mm"\ndepth = "6 mm"\n\n[materials',
    ),
    ("sector_angle = 24.0", "sector_angle = 24.0\nelements_around = 3"),
    ("values = [0.0, 40.0, 150.0, 420.0]", "values = [40.0]"),
)


@pytest.fixture
def here(tmp_path):
    (tmp_path / "small.toml").write_text(GROOVED)
    return tmp_path


def test_a_grooved_tyre_is_certified_by_twice_its_elements_around(here):
    done = tyrefrf_command("run", "small.toml", "--jobs", 1, "--certify", cwd=here)
    assert done.returncode == 0, done.stderr
    refined = r"refined   twice the elements around in every cell, on 1 lines: levels change by \d"
    assert re.search(refined, done.stdout)


def test_shapes_of_a_grooved_tyre_are_written_over_its_own_cell(here):
    done = tyrefrf_command("modes", "small.toml", "--count", 1, "--vtk", 1, cwd=here)
    assert done.returncode == 0, done.stderr
    assert len(list((here / "results/small_modes/fields").iterdir())) == 2


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("20 mm", "12 cm", "small.toml:11: geometry.tread.grooves.width: 0.12 m leaves no block"),
        ("around = 3", "around = 2", "small.toml:22: cell.elements_around: 2 is too few"),
        ("s = 0.31\nangle = 100.0", "s = 0.5\nangle = 12.5", "loads[1].s: at 12.5 deg there is a"),
        (
            's = 0.8\nangle = 31.0\ndirection = "y"',
            'kind = "region"\ns = [0.45, 0.55]\nangle = [6, 42]\ncount = [2, 3]\ndirection = "r"',
            "probes[0].s: point 'sidewall.1' of the region, s = 0.475: at 12 deg there is a groove",
        ),
    ],
)
def test_what_does_not_fit_is_refused_at_its_line(here, old, new, message):
    assert old in GROOVED
    (here / "small.toml").write_text(GROOVED.replace(old, new))
    done = tyrefrf_command("check", "small.toml", cwd=here)
    assert done.returncode == 2
    assert message in done.stderr
