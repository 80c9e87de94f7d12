"""At 0 Hz the rim takes exactly the force and the moment that the load applies."""

from __future__ import annotations

import numpy as np
import pytest
from rings import THETA, R, Y, lopsided, tyre

from tyrefrf.solvers import SOLVERS, solve_line

ROUND_OFF = 1e-9  # of a unit force, and of a unit force on the tyre's radius


def wrench(position, force):
    """Force and moment about the wheel's centre, in x, y, z."""
    return np.concatenate([force, np.cross(position, force)])


def nodes_of(ring):
    """Position and local axes (columns e_r, e_y, e_theta) of every ring node, in x, y, z."""
    own = ring.mesh.points[: ring.mesh.n_own]
    turns = np.arange(ring.n_cells)[:, None] * ring.mesh.sector_angle
    r, y = (np.tile(own[:, k], ring.n_cells) for k in (0, 1))
    theta = (own[:, 2] + turns).ravel()
    c, s, o = np.cos(theta), np.sin(theta), np.zeros_like(theta)
    axes = np.stack([[c, o, s], [o, o + 1.0, o], [-s, o, c]])  # (direction, xyz, node)
    return np.stack([r * c, y, r * s], axis=1), axes.transpose(2, 1, 0)


def hub_columns(ring):
    """Probes: the six components of what all fixed nodes together receive."""
    position, axes = nodes_of(ring)
    held = np.flatnonzero(~ring.cartesian.free[::3])
    columns = [{} for _ in range(6)]
    for node in held:
        for direction in (R, Y, THETA):
            for column, weight in zip(
                columns, wrench(position[node], axes[node, :, direction]), strict=True
            ):
                column[3 * node + direction] = float(weight)
    return ring.columns(*columns)


@pytest.mark.parametrize("n_cells", [1, 3, 8])
@pytest.mark.parametrize("solver", SOLVERS)
def test_hub_balances_the_load(solver, n_cells):
    ring = lopsided(tyre(n_cells=n_cells, elements_along=4, elements_around=max(2, 6 // n_cells)))
    places = [(0, 4, R), (n_cells // 2, ring.mesh.n_face + 3, THETA), (n_cells - 1, 5, Y)]
    problem = ring.problem(ring.point_loads(*places), hub_columns(ring))
    position, axes = nodes_of(ring)
    applied = [
        wrench(position[node], axes[node, :, direction])
        for node, direction in (divmod(ring.dof(*place), 3) for place in places)
    ]

    line = solve_line(problem, SOLVERS[solver](problem), 0.0)

    assert line.remark == ""
    np.testing.assert_allclose(line.receptance, np.transpose(applied), atol=ROUND_OFF)


def test_a_load_on_the_rim_goes_straight_into_it():
    """Half the load on a rim node adds half of it to the hub, and moves nothing more."""
    ring = tyre(n_cells=8, elements_along=4)
    free, fixed = ring.dof(1, 4, R), ring.dof(1, 0, R)
    reaction = ring.columns({fixed: 1.0})
    both, alone = (ring.columns(column) for column in ({free: 1.0, fixed: 0.5}, {free: 1.0}))

    onto_rim, without = (
        solve_line(problem, SOLVERS["recursive"](problem), 0.0).receptance[0, 0]
        for problem in (ring.problem(both, reaction), ring.problem(alone, reaction))
    )

    assert onto_rim - without == pytest.approx(0.5, abs=ROUND_OFF)
