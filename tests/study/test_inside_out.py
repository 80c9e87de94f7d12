"""Nonlinear inflation ends where the tyre does, and not beyond with bricks inside out.

St. Venant-Kirchhoff's energy is the same for F and -F: forces balance in states that no tyre comes
to. A tyre of 2 MPa has its limit point at 0.97 bar.
"""

from __future__ import annotations

import numpy as np
import pytest
from small import case_with

from tyrefrf.errors import CaseError
from tyrefrf.fem.frames import axes
from tyrefrf.study.model import build_model

HEX20R = ('element = "hex8i"', 'element = "hex20r"')
SOFT = ('E = "80 MPa"', 'E = "2 MPa"')


def under(pressure):
    table = f'[inflation]\npressure = {pressure}\nkind = "nonlinear"\n\n[cell]'
    return case_with(("[cell]", table), HEX20R, SOFT)


def volumes(model) -> np.ndarray:
    """Volumes of the tetrahedra at the bricks' first corners, deformed: negative if inside out."""
    mesh = model.mesh
    u = np.einsum("nij,ni->nj", axes(mesh.points[:, 2]), model.inflation.displacement)
    corners = (mesh.cartesian + u)[mesh.bricks[:, [0, 1, 3, 4]]]
    return np.linalg.det(corners[:, 1:] - corners[:, :1])


def test_a_soft_tyre_beyond_its_limit_point_is_refused_and_not_turned_inside_out():
    """In one step from rest Newton's method finds balanced forces at 1 bar: det F = -1.01."""
    with pytest.raises(CaseError, match=r"no equilibrium found beyond 9\.\d+e\+04 Pa: the tyre"):
        build_model(under(1e5))


@pytest.mark.parametrize("pressure", [5e4, 9e4])
def test_a_soft_tyre_before_its_limit_point_has_all_bricks_the_right_way_round(pressure):
    assert volumes(build_model(under(pressure))).min() > 0.0


def test_the_limit_does_not_depend_on_the_pressure_asked_for():
    limits = []
    for pressure in (1e5, 2e5, 5e5):
        with pytest.raises(CaseError) as refused:
            build_model(under(pressure))
        limits.append(float(str(refused.value).split("beyond ")[1].split(" Pa")[0]))
    np.testing.assert_allclose(limits, 9.7e4, rtol=0.02)
