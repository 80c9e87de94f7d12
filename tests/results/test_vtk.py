"""Files for ParaView, opened by VTK: the tyre's volume, its motion over a cycle, and what it says.

u(t) = Re[u exp(i omega t)]: at phase 0 the real part, a quarter of a period later minus the
imaginary part.
"""

from __future__ import annotations

from dataclasses import replace
from importlib.metadata import version

import numpy as np
import pytest
from small import case_with

pytest.importorskip("vtkmodules", reason='vtk, of the extra "test", is not installed')

from vtk_files import Series, read_vtu
from vtkmodules.vtkCommonDataModel import vtkHexahedron, vtkQuadraticHexahedron

from tyrefrf.errors import ResultsError
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.mesh.shapes import HEX8, HEX20
from tyrefrf.results.vtkhdf import write_vtkhdf
from tyrefrf.results.vtu import write_vtu
from tyrefrf.study.deflection import deflections
from tyrefrf.study.model import build_mesh

SINGLE = 2e-7  # single precision, and the sum of two rounded terms
COORDINATES = 1e-5  # points in single precision, 2e-8 m, of edges of 5 mm and more
CURVED = 0.1  # VTK's filter cuts a curved brick into straight tetrahedra
FREQUENCY = 150.0
SIDEWALL = '[[probes]]\nname = "sidewall"'
PROBE = '[[probes]]\nname = "node"\nkind = "node"\nnode = 7\nangle = 73.0\ndirection = "theta"\n\n'


def tyre(element):
    return case_with(('"hex8i"', f'"{element}"'), (SIDEWALL, PROBE + SIDEWALL))


@pytest.fixture(scope="module", params=["hex8i", "hex20"])
def element(request):
    return request.param


@pytest.fixture(scope="module")
def written(element, tmp_path_factory):
    """A deflection, and the two files of it."""
    directory = tmp_path_factory.mktemp("vtk")
    found = deflections(tyre(element), [FREQUENCY])[1]
    write_vtkhdf(directory / "patch.vtkhdf", found)
    write_vtu(directory / "patch.vtu", found)
    return found, Series(directory / "patch.vtkhdf"), read_vtu(directory / "patch.vtu")


@pytest.mark.parametrize(
    ("natural", "brick"), [(HEX8, vtkHexahedron()), (HEX20, vtkQuadraticHexahedron())]
)
def test_bricks_have_their_nodes_in_vtk_s_order(natural, brick):
    parametric = np.array(brick.GetParametricCoords()[: 3 * len(natural)]).reshape(-1, 3)
    np.testing.assert_array_equal(2.0 * parametric - 1.0, natural)


def test_every_brick_has_its_volume_and_all_the_tyre_s(written, element):
    case, (_, series, still) = tyre(element), written
    mesh, N = build_mesh(case), case.cell.n_cells
    _, dV = ELEMENTS[element].full_strain(mesh.cartesian[mesh.bricks])
    expected = np.tile(dV.sum(axis=1), N)
    by_filter = {"hex8i": COORDINATES, "hex20": CURVED}[element]
    for grid in (still, series.at(0.0)):
        assert grid.n_cells == N * len(mesh.bricks)
        np.testing.assert_allclose(grid.integrated_volume, expected, rtol=COORDINATES)
        np.testing.assert_allclose(grid.volume, expected, rtol=by_filter)


def test_a_node_probe_sees_in_the_files_what_the_response_says(written, element):
    import tyrefrf

    case = tyre(element)
    lines = case.frequency.model_copy(update={"values": (FREQUENCY,)})
    results = tyrefrf.run(case.model_copy(update={"frequency": lines}), jobs=1)
    place = next(place for place in results.probes if place.name == "node")
    expected = results.response("patch", "node", "receptance")[0]

    _, series, still = written
    c, s = np.cos(place.angle), np.sin(place.angle)
    there = np.array([place.r * c, place.y, place.r * s])
    point = np.argmin(np.linalg.norm(still.points - there, axis=1))
    np.testing.assert_allclose(still.points[point], there, atol=1e-7)
    e_theta = np.array([-s, 0.0, c])
    real, imag = (still.point_data[f"displacement_{part}"][point] @ e_theta for part in PARTS)
    assert real + 1j * imag == pytest.approx(expected, rel=1e-5)
    around = [still.point_data[f"u_theta_{part}"][point] for part in PARTS]
    assert complex(*around) == pytest.approx(expected, rel=1e-5)
    assert series.at(0.0).point_data["u_theta"][point] == pytest.approx(expected.real, rel=1e-5)


PARTS = ("real", "imag")


def test_the_phases_are_one_cycle(written):
    found, series, _ = written
    np.testing.assert_allclose(series.times, 15.0 * np.arange(24))
    cartesian, scale = found.cartesian, np.abs(found.u).max()
    for degrees in series.times:
        turned = np.exp(1j * np.deg2rad(degrees))
        moment = series.at(degrees).point_data
        expected = (cartesian * turned).real
        np.testing.assert_allclose(moment["displacement"], expected, atol=SINGLE * scale)
        cylindrical = np.stack([moment[name] for name in ("u_r", "u_y", "u_theta")], axis=1)
        np.testing.assert_allclose(cylindrical, (found.u * turned).real, atol=SINGLE * scale)


def test_it_begins_with_the_real_part_and_goes_on_with_minus_the_imaginary_one(written):
    _, series, still = written
    start, quarter = (series.at(t).point_data for t in (0.0, 90.0))
    atol = SINGLE * np.abs(still.point_data["displacement_real"]).max()
    for other in (still.point_data, start, quarter):
        real, imag = other["displacement_real"], other["displacement_imag"]
        np.testing.assert_allclose(start["displacement"], real, atol=atol)
        np.testing.assert_allclose(quarter["displacement"], -imag, atol=atol)


def test_the_mean_square_velocity_is_that_of_the_cycle(written):
    """The mean of |d/dt displacement|^2 over the phases, which sum a cosine's square exactly."""
    _, series, still = written
    omega = 2.0 * np.pi * FREQUENCY
    squares = [
        np.sum((omega * series.at(t).point_data["displacement"]) ** 2, axis=1) for t in series.times
    ]
    for grid in (still, series.at(30.0)):
        np.testing.assert_allclose(
            grid.point_data["mean_square_velocity"], np.mean(squares, axis=0), rtol=1e-5
        )


def test_bricks_know_their_cell_and_material(written, element):
    case, (_, series, still) = tyre(element), written
    per_cell = len(build_mesh(case).bricks)
    for grid in (still, series.at(345.0)):
        np.testing.assert_array_equal(grid.cell_data["cell"], np.repeat(np.arange(15), per_cell))
        assert not grid.cell_data["material"].any()
        assert grid.field_data["materials"] == "0: rubber"
        assert grid.types == {12 if element == "hex8i" else 25}


def test_files_say_where_they_come_from(written):
    found, series, still = written
    for grid in (still, series.at(0.0), series.at(200.0)):
        said = grid.field_data
        assert said["case"] == "small"
        assert said["case_hash"] == found.provenance.case_hash
        assert said["version"] == f"tyrefrf {version('tyrefrf')}"
        assert said["load"] == "patch: theta at outer 0.310, 100\N{DEGREE SIGN}"
        assert said["frequency_Hz"] == FREQUENCY
        assert 0.0 < said["residual"] == found.residual < 1e-9
        assert said["visible_scale"] == found.visible_scale
        assert "displacement, u_r, u_y, u_theta: m/N" in said["units"]
        assert "mean_square_velocity: m^2/(s^2 N^2)" in said["units"]
        assert "exp(i omega t)" in said["convention"]


def test_other_numbers_of_phases_can_be_asked_for(written, tmp_path):
    found, *_ = written
    write_vtkhdf(tmp_path / "few.vtkhdf", found, n_phases=4)
    assert Series(tmp_path / "few.vtkhdf").times.tolist() == [0.0, 90.0, 180.0, 270.0]


@pytest.mark.parametrize("write", [write_vtkhdf, write_vtu])
def test_what_cannot_be_written_says_so(written, tmp_path, write):
    found, *_ = written
    (tmp_path / "file").touch()
    with pytest.raises(ResultsError, match="cannot be written"):
        write(tmp_path / "file" / "x.vtu", found)


def test_a_motion_of_other_points_is_refused(written):
    found, *_ = written
    with pytest.raises(ResultsError, match="u has shape"):
        replace(found, u=found.u[1:])
