"""A case's section may come from a mesh file; it has exactly one source."""

from __future__ import annotations

import pytest

from tyrefrf.case import Case, CellFile, Region, SectionFile, parse_case, resolved_toml
from tyrefrf.errors import CaseError

MESH = """\
[mesh]
file = "section.inp"
kind = "section"
unit = "mm"
rim = "RIM"
[mesh.materials]
TREAD = "rubber"
BELT = { material = "belt", angle = 20.0, through = [1, 0] }
[materials.belt]
kind = "transverse"
E_1 = "20 GPa"
E_2 = "30 MPa"
nu_12 = 0.4
nu_23 = 0.5
G_12 = "8 MPa"
rho = 2000.0
"""


@pytest.fixture
def text(small) -> str:
    return MESH + small.replace('[geometry]\nmaterial = "rubber"\n', "")


def parsed(text: str) -> Case:
    return parse_case(text, "case.toml", "case")


def test_sets_have_a_material_or_a_table(text):
    mesh = parsed(text).mesh
    assert isinstance(mesh, SectionFile)
    assert mesh.axis == "y"
    assert mesh.regions == {
        "TREAD": Region(material="rubber"),
        "BELT": Region(material="belt", angle=20.0, through=(1.0, 0.0)),
    }


def test_a_cell_has_faces(text):
    more = 'kind = "cell"\nleft = "L"\nright = "R"\ntolerance = "0.1 mm"'
    mesh = parsed(text.replace('kind = "section"', more)).mesh
    assert isinstance(mesh, CellFile)
    assert (mesh.left, mesh.right, mesh.tolerance) == ("L", "R", 1e-4)


def test_it_is_the_same_case_written_out_and_read_again(text):
    case = parsed(text)
    assert parsed(resolved_toml(case)) == case
    assert "directory" not in resolved_toml(case)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('unit = "mm"\n', "", "case.toml:1: mesh.unit: missing: unit of the file's coordinates"),
        ('"mm"', '"cm"', "case.toml:4: mesh.unit: 'cm' is not one of m, mm, in"),
        ('kind = "section"\n', "", "case.toml:1: mesh.kind: missing: one of section, cell"),
        ('rim = "RIM"\n', "", "case.toml:1: mesh.rim: missing: node set"),
        ('rim = "RIM"', 'rim = "RIM"\nleft = "L"', "6: mesh.left: unknown key for kind 'section'"),
        ('rim = "RIM"', 'rim = "RIM"\naxis = "r"', "mesh.axis: 'r' is not one of x, y, z"),
        ('TREAD = "rubber"', "TREAD = 5", "7: mesh.materials.TREAD: 5 is not text in quotes"),
        ('TREAD = "rubber"', 'TREAD = "ruber"', "7: mesh.materials.TREAD: undefined material 'rub"),
        ('material = "belt",', 'material = "bel",', "BELT.?m?a?t?e?r?i?a?l?: undefined material"),
        (
            'material = "belt",',
            'material = "rubber",',
            "8: mesh.materials.BELT.angle: 'rubber' is is",
        ),
        ("angle = 20.0", "angel = 20.0", "BELT.angel: unknown key; did you mean 'angle'"),
        (
            "angle = 20.0",
            "angle = 120.0",
            "8: mesh.materials.BELT.angle: 120.0 deg is out of range",
        ),
        ("[1, 0]", "[0, 0]", "8: mesh.materials.BELT.through: .0, 0. is no direction"),
        ("[1, 0]", "[1]", "8: mesh.materials.BELT.through: has only 1; must have at least 2"),
        ('rim = "RIM"', 'rim = "RIM"\nleave_out = ["BELT"]', "'BELT' has a material"),
        ("[mesh.materials]", "[geometry]\n[mesh.materials]", "not together with .geometry."),
        ("[cell]", '[cell]\nelements_around = "2"', "elements_around"),
    ],
)
def test_what_is_wrong_has_its_line(text, old, new, words):
    assert old in text
    with pytest.raises(CaseError, match=words):
        parsed(text.replace(old, new, 1))


def test_a_ply_at_several_angles_is_not_turned(text):
    ply = """\
[materials.belt]
kind = "ply"
cord = { E = "3 GPa", nu = 0.3, rho = 1100.0 }
rubber = { E = "10 MPa", nu = 0.48, rho = 1100.0 }
volume_fraction = 0.3
angles = [20.0, -20.0]
"""
    head, _, rest = text.partition("[materials.belt]")
    _, _, rest = rest.partition("rho = 2000.0\n")
    with pytest.raises(CaseError, match="'belt' has plies at 2 angles"):
        parsed(head + ply + rest)
    one = parsed(head + ply.replace(", -20.0", "") + rest)
    assert one.laid_materials["belt at 20 deg"].angles == (20.0,)


def test_no_other_material_has_the_name_of_a_laid_one(text):
    other = '[materials."belt at 20 deg"]\nE = 1e6\nnu = 0.3\nrho = 1e3\n'
    used = text.replace('TREAD = "rubber"', 'TREAD = "rubber"\nX = "belt at 20 deg"')
    with pytest.raises(CaseError, match=r"mesh.materials.BELT.angle: 'belt' at this angle"):
        parsed(used + other)


def test_a_case_has_exactly_one_source(text, small):
    with pytest.raises(
        CaseError, match=r"case.toml:1: geometry: missing: .*\[geometry\] or \[mesh\]"
    ):
        parsed(small.replace('[geometry]\nmaterial = "rubber"\n', ""))
    both = f'{text}[geometry]\nmaterial = "rubber"\n'
    with pytest.raises(CaseError, match=r"mesh: not together with \[geometry\]"):
        parsed(both)


def test_a_cell_from_a_file_has_its_own_elements_around(text):
    cell = text.replace('kind = "section"', 'kind = "cell"')
    with pytest.raises(CaseError, match=r"cell.elements_around: not with mesh.kind = 'cell'"):
        parsed(cell.replace("[cell]", "[cell]\nelements_around = 2"))
