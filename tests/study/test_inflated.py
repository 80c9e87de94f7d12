"""Cases under pressure, from text to results: the right state, and clear refusals."""

from __future__ import annotations

import numpy as np
import pytest
from small import case_with

import tyrefrf
from tyrefrf.case import builtin_text, parse_case
from tyrefrf.errors import CaseError
from tyrefrf.fem import inflation as fem_inflation
from tyrefrf.plots.inflation import inflation_figures
from tyrefrf.study import model as study_model
from tyrefrf.study.inflate import elasticity_key
from tyrefrf.study.model import Workshop, build_model
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import sweep

SAME = 1e-9  # of the largest response of a line, between solvers
HEX20R = ('element = "hex8i"', 'element = "hex20r"')


def inflated(*changes, pressure="1 bar", more=""):
    table = f'[inflation]\npressure = "{pressure}"\n{more}\n[cell]'
    return case_with(("[cell]", table), *changes)


@pytest.mark.parametrize(
    ("element", "kind"), [("hex8i", "linear"), ("hex8", "linear"), ("hex20r", "nonlinear")]
)
def test_solvers_agree_about_the_inflated_state(element, kind):
    change = ('element = "hex8i"', f'element = "{element}"')
    found = {}
    for solver in ("recursive", "cyclic", "direct"):
        case = inflated(change, ("[frequency]", f'[solver]\nname = "{solver}"\n\n[frequency]'),
                        more=f'kind = "{kind}"')  # fmt: skip
        found[solver] = run_case(case, jobs=1)
        assert found[solver].remark == ("",) * 4
    expected = found["direct"].receptance
    scale = abs(expected).max(axis=(0, 1))
    for results in found.values():
        assert (abs(results.receptance - expected).max(axis=(0, 1)) < SAME * scale).all()
        assert results.residual.max() < SAME


def test_tension_stiffens_the_tyre_against_a_push():
    taut = run_case(inflated(more="pressure_stiffness = false"), jobs=1)
    slack = run_case(case_with(), jobs=1)
    taut, slack = (abs(r.driving_point("radial", "receptance")[0]) for r in (taut, slack))
    assert taut < 0.98 * slack


def test_no_pressure_is_no_inflation():
    at_rest = run_case(case_with(), jobs=1)
    nothing = run_case(inflated(pressure="0 bar"), jobs=1)
    assert nothing.inflation is None
    np.testing.assert_array_equal(nothing.receptance, at_rest.receptance)


@pytest.fixture(scope="module")
def results():
    return run_case(inflated(HEX20R, more='kind = "nonlinear"'), jobs=1)


def test_state_is_kept_and_read_back(results, tmp_path):
    tyrefrf.write_results(tmp_path / "tyre.h5", results)
    again = tyrefrf.load_results(tmp_path / "tyre.h5").inflation
    for name in ("displacement", "stress", "resultant", "share", "iterations", "lack"):
        np.testing.assert_array_equal(getattr(again, name), getattr(results.inflation, name))
    assert again.pressure == 1e5
    assert results.inflation.lack[-1] < 1e-10
    assert results.inflation.displacement[results.section.rim].any() == 0.0


def test_xarray_opens_the_state(results, tmp_path):
    xarray = pytest.importorskip("xarray")
    tyrefrf.write_results(tmp_path / "tyre.h5", results)
    with xarray.open_dataset(tmp_path / "tyre.h5", engine="h5netcdf", group="inflation") as state:
        hoop = state.stress.sel(component="tt")
        np.testing.assert_array_equal(hoop, results.inflation.stress[:, 2])


def test_figure_shows_the_stress_of_every_element(results):
    (figure,) = inflation_figures(results)
    hoop = figure.axes[0].collections[-1].get_array()
    np.testing.assert_allclose(hoop, results.inflation.stress[:, 2] / 1e6)
    assert "1 bar" in figure.axes[0].get_title(loc="left")
    assert figure.axes[0].get_xlabel() == "y [mm]"


def test_rest_has_no_figure():
    assert inflation_figures(run_case(case_with(), jobs=1)) == []


def test_nonlinear_needs_a_brick_of_finite_strain():
    with pytest.raises(CaseError, match=r"inflation\.kind: 'nonlinear' needs .*hex8i.*hex20"):
        inflated(more='kind = "nonlinear"')


def test_inflation_that_does_not_converge_is_refused_at_its_key(monkeypatch):
    monkeypatch.setattr(fem_inflation, "MAX_ITERATIONS", 1)  # of the six or seven that it takes
    with pytest.raises(CaseError, match=r"inflation\.pressure: no equilibrium found beyond 0 Pa"):
        build_model(inflated(HEX20R, more='kind = "nonlinear"'))


def test_buckled_tyre_is_refused_with_its_orders():
    """Pressure from outside, which a case cannot ask for, makes K + K_G + K_P indefinite."""
    case = inflated()
    sucked = case.inflation.model_copy(update={"pressure": -30e5})
    with pytest.raises(CaseError, match=r"inflation\.pressure: the tyre buckles .* order \d"):
        build_model(case.model_copy(update={"inflation": sucked}))


def test_E_static_alone_carries_the_pressure():
    soft = ("eta = 0.1", 'eta = 0.1\nE_static = "40 MPa"')
    half, full = (
        build_model(inflated(*changes, pressure=pressure)).inflation.displacement
        for changes, pressure in (((soft,), "0.5 bar"), ((), "1 bar"))
    )
    np.testing.assert_allclose(half, full, atol=1e-12)


def test_sweep_inflates_once_where_elasticity_stays(monkeypatch):
    count = []
    monkeypatch.setattr(
        study_model, "inflate", lambda *a: count.append(1) or inflate_of_the_program(*a)
    )
    points = sweep(inflated(), {"eta_rubber": [0.05, 0.1], "rho_rubber": [1000.0, 1200.0]}, jobs=1)
    assert len(count) == 1
    alone = run_case(
        inflated(("eta = 0.1", "eta = 0.05"), ("rho = 1200.0", "rho = 1000.0")), jobs=1
    )
    np.testing.assert_array_equal(points.points[0].receptance, alone.receptance)


inflate_of_the_program = study_model.inflate


def test_sweep_of_pressure_keeps_every_state(tmp_path):
    study = sweep(case_with(), {"pressure": [0.0, 1e5, 2e5]}, jobs=1)
    tyrefrf.write_sweep(tmp_path / "sweep.h5", study)
    at_rest, *states = (p.inflation for p in tyrefrf.load_sweep(tmp_path / "sweep.h5").points)
    assert at_rest is None
    assert [state.pressure for state in states] == [1e5, 2e5]
    np.testing.assert_allclose(states[1].displacement, 2.0 * states[0].displacement, rtol=1e-9)


def test_elasticity_key_tells_materials_apart():
    materials = parse_case(builtin_text(), "", "tyre").materials.values()
    assert len({elasticity_key(stuff) for stuff in materials}) == 3


def test_workshop_gives_the_same_model_alone_and_after_others():
    shop = Workshop()
    shop.model(inflated(pressure="2 bar"))
    after = shop.model(inflated()).problem.cell.K_G
    np.testing.assert_array_equal(after, build_model(inflated()).problem.cell.K_G)
