"""A region's points: where they are, and what their mean says of the tyre.

A mean over a whole turn does not depend on where around the tyre the load acts.
"""

from __future__ import annotations

import numpy as np
import pytest
from small import case_with

from tyrefrf.results.derived import regions_of, space_mean_square
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case

ROUND_OFF = 1e-9
SHORT = ("values = [0.0, 40.0, 150.0, 420.0]", "values = [40.0, 150.0]")
HUB = '[[probes]]\nname = "hub"\nkind = "hub"\n'


def region(s="[0.3, 0.7]", angle="[0.0, 360.0]", count="[3, 15]", direction="r"):
    return (
        f'{HUB}\n[[probes]]\nname = "tread"\nkind = "region"\ns = {s}\nangle = {angle}\n'
        f'count = {count}\ndirection = "{direction}"\n'
    )


def results_of(*changes, **keys):
    return run_case(case_with((HUB, region(**keys)), SHORT, *changes), jobs=1)


def test_points_are_the_middles_of_equal_parts():
    model = build_model(case_with((HUB, region(angle='["-10 deg", 10.0]', count="[2, 4]"))))
    points = [model.probes[j] for j in regions_of(model.probes)["tread"]]
    assert [point.name for point in points] == [f"tread.{k}" for k in range(1, 9)]
    assert [point.s for point in points[:4]] == pytest.approx([0.4, 0.6, 0.4, 0.6])
    degrees = [np.rad2deg(point.angle) for point in points[::2]]
    assert degrees == pytest.approx([352.5, 357.5, 2.5, 7.5])


def test_a_region_s_points_are_probes_like_any_others():
    """The region's point at s = 0.5 and 0 degrees, and a probe there."""
    keys = {"s": "[0.4, 0.6]", "angle": "[-12.0, 12.0]", "count": "[1, 1]"}
    here = 's = 0.8\nangle = 31.0\ndirection = "y"', 's = 0.5\nangle = 0.0\ndirection = "r"'
    results = results_of(here, **keys)
    np.testing.assert_allclose(
        results.response("radial", "tread.1"),
        results.response("radial", "sidewall"),
        rtol=ROUND_OFF,
    )
    mean = space_mean_square(results, "tread")
    expected = np.abs(results.mobility[:, regions_of(results.probes)["tread"][0]]) ** 2
    np.testing.assert_allclose(mean, expected)


def test_a_mean_over_a_whole_turn_does_not_depend_on_the_load_s_angle():
    """A ring of 15 cells looks the same from every one of them."""
    first = space_mean_square(results_of(), "tread")
    turned = space_mean_square(
        results_of(('s = 0.5\ndirection = "r"', 's = 0.5\nangle = 72.0\ndirection = "r"')), "tread"
    )
    np.testing.assert_allclose(turned[0], first[0], rtol=ROUND_OFF)
    assert (first > 0.0).all()


NEAR_FIELD = 0.05  # measured 0.028: the mean square next to a force at a node is badly sampled


def test_more_points_give_the_same_mean():
    few = space_mean_square(results_of(count="[6, 30]"), "tread")[0]
    many = space_mean_square(results_of(count="[12, 60]"), "tread")[0]
    np.testing.assert_allclose(few, many, rtol=NEAR_FIELD)
