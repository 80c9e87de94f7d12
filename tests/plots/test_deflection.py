"""Still pictures of deflections: what is drawn, how much larger, and in which colour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from small import case_with

from tyrefrf.plots import draw_plots
from tyrefrf.plots.deflection import deflection_figure, mid_tread, outward
from tyrefrf.results.deflection import at_phase, mode_deflection, phase_of_most
from tyrefrf.study.deflection import deflections
from tyrefrf.study.modes import modes


@pytest.fixture(scope="module")
def motion():
    return deflections(case_with(), [150.0])[0]


@pytest.fixture(scope="module")
def drawn(motion):
    """The figure, and the polygons and colours that it was given."""
    given = {}

    class Recording(Poly3DCollection):
        def __init__(self, verts, **look):
            given.update(verts=verts, **look)
            super().__init__(verts, **look)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tyrefrf.plots.deflection.Poly3DCollection", Recording)
        return deflection_figure(motion), given


@pytest.fixture(scope="module")
def figure(drawn):
    return drawn[0]


def test_the_outer_surface_is_drawn_moved_as_stated(motion, drawn):
    """The axle to the right, angle 0 on top."""
    u = at_phase(motion.cartesian, phase_of_most(motion.u))
    x, y, z = np.moveaxis((motion.mesh.points + motion.visible_scale * u)[motion.mesh.outer], 2, 0)
    np.testing.assert_allclose(drawn[1]["verts"], np.stack([y, z, x], axis=2), rtol=1e-12)


def test_the_title_says_what_moves_and_how_much_larger(figure, motion):
    words = figure.get_suptitle()
    assert words.splitlines()[0] == "Small tyre"
    assert "150 Hz, radial: r at outer 0.500, 0" in words
    degrees = np.rad2deg(phase_of_most(motion.u)) % 360.0
    assert f"{motion.visible_scale:g} times the displacement under 1 N" in words
    assert f"at the phase of most motion, {degrees:.0f}" in words


def test_outwards_is_red_and_inwards_blue(drawn, motion):
    out = outward(motion.mesh, at_phase(motion.cartesian, phase_of_most(motion.u)))
    red, _, blue, _ = drawn[1]["facecolors"].T
    clear = np.abs(out) > 0.1 * np.abs(out).max()
    assert np.ptp(np.sign(out[clear])) == 2.0
    np.testing.assert_array_equal((red > blue)[clear], (out > 0.0)[clear])


def test_the_colours_are_in_a_unit_that_suits(figure, motion):
    _, bar, _ = figure.axes
    assert bar.get_ylabel() == "outward displacement [\N{MICRO SIGN}m/N]"
    out = outward(motion.mesh, at_phase(motion.cartesian, phase_of_most(motion.u)))
    np.testing.assert_allclose(bar.get_ylim(), 1e6 * np.abs(out).max() * np.array([-1.0, 1.0]))


def test_breathing_is_outwards_everywhere_and_a_translation_is_not(motion):
    mesh = motion.mesh
    from_axle = mesh.points * [1.0, 0.0, 1.0]
    middle = np.abs(mesh.points[mesh.outer, 1]).mean(axis=1) < 0.05
    assert middle.any()
    assert np.all(outward(mesh, from_axle)[middle] > 0.0)
    along_x = outward(mesh, np.tile([1.0, 0.0, 0.0], (len(mesh.points), 1)))
    x = mesh.points[mesh.outer, 0].mean(axis=1)
    np.testing.assert_array_equal(np.sign(along_x[middle]), np.sign(x[middle]))


def test_the_load_is_an_arrow_and_a_mode_has_none(figure):
    def arrows(axes):
        return [c for c in axes.collections if isinstance(c, Line3DCollection)]

    assert len(arrows(figure.axes[0])) == 1
    found = modes(case_with(), count=3)
    of_mode = deflection_figure(mode_deflection(found, 1))
    assert arrows(of_mode.axes[0]) == []
    assert "mode 1, order" in of_mode.get_suptitle()
    assert "of unit modal mass" in of_mode.get_suptitle()


def test_the_mid_tread_is_a_closed_line_around_the_axle(figure, motion):
    mesh = motion.mesh
    line = mid_tread(mesh)
    assert len(line) == 15  # cells of one brick
    np.testing.assert_allclose(mesh.points[line, 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(np.diff(mesh.theta[line]), np.deg2rad(24.0))
    rest, most, later = figure.axes[-1].lines
    u = at_phase(motion.cartesian, phase_of_most(motion.u))[line]
    moved = mesh.points[line] + motion.visible_scale * u
    np.testing.assert_allclose(most.get_ydata()[:-1], moved[:, 0])
    np.testing.assert_allclose(most.get_xdata()[:-1], moved[:, 2])
    assert all(curve.get_ydata()[0] == curve.get_ydata()[-1] for curve in (rest, most, later))


def test_a_tyre_that_does_not_move_is_drawn(motion):
    still = deflection_figure(replace(motion, u=np.zeros_like(motion.u)))
    assert "drawn 1 times" in still.get_suptitle()


def test_figures_become_files(motion, tmp_path):
    (path,) = draw_plots(motion, tmp_path, ("png",))
    assert path.name == "deflection_radial_150Hz.png"
    assert path.stat().st_size > 10_000
