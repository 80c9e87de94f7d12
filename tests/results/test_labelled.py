"""Results as an xarray.Dataset: the same as their file opened with xarray."""

import sys
from dataclasses import replace

import pytest
import synthetic
import xarray

from tyrefrf.case.axis import Axis
from tyrefrf.errors import ResultsError
from tyrefrf.results import SweepResults, to_xarray, write_results, write_sweep

MODULUS = Axis("E_rubber", "materials.rubber.E", "Pa", "Young's modulus", (14e6, 28e6))
CROWN = Axis("crown", "geometry.thickness.crown", "m", "thickness at mid-tread", (0.012, 0.014))


def run(scale=1.0):
    made = synthetic.results(synthetic.LINES[::40])
    return replace(made, receptance=scale * made.receptance)


def by_modulus():
    return SweepResults((MODULUS,), (run(2.0), run(1.0)), synthetic.PROVENANCE)


def by_both():
    """The load moves from point to point."""
    points = [run(scale) for scale in (4.0, 3.0, 2.0, 1.0)]
    moved = [
        replace(point, loads=tuple(replace(load, r=load.r + 1e-3 * i) for load in point.loads))
        for i, point in enumerate(points)
    ]
    return SweepResults((MODULUS, CROWN), tuple(moved), synthetic.PROVENANCE)


def opened(path):
    return xarray.load_dataset(path, engine="h5netcdf", decode_cf=False)


def test_a_run_is_what_its_file_holds(tmp_path):
    made = run()
    write_results(tmp_path / "run.h5", made)
    xarray.testing.assert_equal(to_xarray(made), opened(tmp_path / "run.h5"))


@pytest.mark.parametrize("sweep", [by_modulus, by_both])
def test_a_sweep_is_what_its_file_holds(tmp_path, sweep):
    made = sweep()
    write_sweep(tmp_path / "sweep.h5", made)
    xarray.testing.assert_equal(to_xarray(made), opened(tmp_path / "sweep.h5"))


def test_units_and_origin_are_those_of_the_file(tmp_path):
    made = by_modulus()
    write_sweep(tmp_path / "sweep.h5", made)
    here, there = to_xarray(made), opened(tmp_path / "sweep.h5")
    assert here.attrs == there.attrs
    for name in here.variables:
        assert here[name].attrs == there[name].attrs, name


def test_a_point_of_a_sweep_is_chosen_by_its_parameter():
    made = by_modulus()
    soft = to_xarray(made).sel(E_rubber=14e6, load="radial", probe="shoulder")["mobility"]
    assert soft.values == pytest.approx(made.points[0].response("radial", "shoulder"), abs=0.0)


def test_without_xarray_it_is_said_what_brings_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ResultsError, match=r'pip install "tyrefrf\[xarray\]"'):
        to_xarray(run())
