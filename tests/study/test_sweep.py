"""Sweeps: every point to the bit as a run of its own, and nothing computed twice."""

from __future__ import annotations

import numpy as np
import pytest
import xarray
from small import TEXT, case_with

import tyrefrf
from tyrefrf.case import make_grid
from tyrefrf.errors import CaseError, SingularError
from tyrefrf.fem import assembly
from tyrefrf.fem.elements import ELEMENTS
from tyrefrf.solvers import SOLVERS, Recursive
from tyrefrf.study import model, spectrum
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import run_sweep

MODULI = (40e6, 70e6, 130e6)  # no ratios that binary numbers have exactly
GRIDS = {
    "modulus": {"E_rubber": MODULI},
    "loss factor": {"eta_rubber": (0.05, 0.1)},
    "density": {"rho_rubber": (1000.0, 1200.0)},
    "sector angle": {"sector_angle": (24.0, 12.0)},
    "pressure": {"pressure": (0.0, 1e5)},
    "thickness": {"sidewall": (0.006, 0.008)},
    "modulus by angle": {"E_rubber": (40e6, 70e6), "sector_angle": (24.0, 36.0, 20.0)},
}


@pytest.fixture(scope="module")
def by_modulus():
    return tyrefrf.sweep(case_with(), {"E_rubber": MODULI}, jobs=1)


@pytest.mark.parametrize("wanted", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("jobs", [1, 2])
def test_every_point_has_the_bits_of_its_own_run(wanted, jobs):
    grid = make_grid(case_with(), wanted)
    swept = run_sweep(grid, jobs=jobs)
    assert swept.shape == grid.shape
    for case, point in zip(grid.cases, swept.points, strict=True):
        alone = run_case(case, jobs=1)
        np.testing.assert_array_equal(point.receptance, alone.receptance)
        np.testing.assert_array_equal(point.blocked_force, alone.blocked_force)
        np.testing.assert_array_equal(point.residual, alone.residual)
        np.testing.assert_array_equal(point.section.points, alone.section.points)
        assert (point.loads, point.probes) == (alone.loads, alone.probes)
        assert point.provenance.case_hash == alone.provenance.case_hash


def test_a_point_at_the_case_s_own_value_is_the_case():
    swept = tyrefrf.sweep(case_with(), {"E_rubber": (30e6, "80 MPa")}, jobs=1)
    own = run_case(case_with(), jobs=1)
    np.testing.assert_array_equal(swept.point(E_rubber=80e6).receptance, own.receptance)


def test_mobility_falls_as_the_modulus_grows(by_modulus):
    for load in by_modulus.loads:
        levels = by_modulus.level(load.name)
        assert (np.diff(levels) < -1.0).all(), levels  # dB


def test_static_compliance_is_inverse_to_the_modulus(by_modulus):
    statics = by_modulus.driving_point("radial", "receptance")[:, 0]
    np.testing.assert_allclose(statics * np.array(MODULI), statics[0] * MODULI[0], rtol=1e-10)


SLOW, FAST = "values = [0.0, 40.0, 150.0, 420.0]", "values = [0.0, 80.0, 300.0, 840.0]"


@pytest.mark.parametrize(
    ("name", "value", "receptance"), [("E_rubber", 320e6, 0.25), ("rho_rubber", 300.0, 1.0)]
)
def test_resonances_shift_with_the_root_of_modulus_over_density(name, value, receptance):
    """Four times E/rho has at lines twice as high the same shapes, 1/E times as large."""
    own = run_case(case_with(), jobs=1)
    (fast,) = tyrefrf.sweep(case_with((SLOW, FAST)), {name: (value,)}, jobs=1).points
    expected = receptance * own.receptance
    np.testing.assert_allclose(fast.receptance, expected, rtol=0, atol=1e-10 * abs(expected).max())


class Counted:
    """Counts the calls of a function."""

    def __init__(self, function):
        self.function, self.calls = function, 0

    def __call__(self, *arguments):
        self.calls += 1
        return self.function(*arguments)


@pytest.fixture
def counted(monkeypatch):
    """How often cells are meshed, and bricks integrated for stiffness and for mass."""
    element = type(ELEMENTS["hex8i"])
    counters = {
        "mesh": Counted(model.build_mesh),
        "places": Counted(model._place_all),
        "stiffness": Counted(element.stiffness),
        "mass": Counted(element.mass),
        "pattern": Counted(assembly.Pattern.of),
    }
    monkeypatch.setattr(model, "build_mesh", counters["mesh"])
    monkeypatch.setattr(model, "_place_all", counters["places"])
    for name in ("stiffness", "mass"):
        counter = counters[name]
        monkeypatch.setattr(element, name, lambda *a, counter=counter: counter(*a))
    monkeypatch.setattr(assembly.Pattern, "of", counters["pattern"])
    return lambda: {name: counter.calls for name, counter in counters.items()}


ONCE = {"mesh": 1, "places": 1, "stiffness": 1, "mass": 1, "pattern": 1}


@pytest.mark.parametrize("name", ["E_rubber", "eta_rubber", "rho_rubber", "alpha", "beta"])
def test_what_a_parameter_does_not_change_is_computed_once(counted, name):
    tyrefrf.sweep(case_with(), {name: (1.0, 2.0, 3.0)}, jobs=1)
    assert counted() == ONCE


def test_poisson_s_ratio_changes_the_stiffness_alone(counted):
    tyrefrf.sweep(case_with(), {"nu_rubber": (0.3, 0.4)}, jobs=1)
    assert counted() == ONCE | {"stiffness": 2}


def test_the_sector_angle_changes_everything(counted):
    wanted = {"sector_angle": (24.0, 36.0), "E_rubber": MODULI}
    tyrefrf.sweep(case_with(), wanted, jobs=1)
    assert counted() == dict.fromkeys(ONCE, 2)


def test_a_pressure_is_put_on_once(monkeypatch):
    """What a loss factor, a density or a pool of points does not change is the state at rest."""
    inflations = Counted(model.inflate)
    monkeypatch.setattr(model, "inflate", inflations)
    wanted = {"pressure": (0.0, 1e5, 2e5), "eta_rubber": (0.1, 0.2), "rho_rubber": (1e3, 2e3)}
    tyrefrf.sweep(case_with(), wanted, jobs=1)
    assert inflations.calls == 2


def test_all_points_share_one_pool(monkeypatch):
    pools = []

    def mapped(tasks, workers, *_):
        tasks = list(tasks)
        chunks = [task.item for task in tasks]
        pools.append((len({chunk.number for chunk in chunks}), sum(len(c.lines) for c in chunks)))
        yield from (task.make()(task.item) for task in tasks)

    monkeypatch.setattr(spectrum, "map_unordered", mapped)
    tyrefrf.sweep(case_with(), {"E_rubber": MODULI}, jobs=2)
    assert pools == [(3, 12)]


def test_bad_points_are_refused_before_anything_is_solved(monkeypatch):
    monkeypatch.setattr(spectrum, "map_unordered", lambda *_: pytest.fail("solved"))
    case = case_with(("s = 0.5\n", "node = 12\n"))
    with pytest.raises(CaseError) as caught:
        tyrefrf.sweep(case, {"elements_along": (8, 4, 6), "E_rubber": MODULI}, jobs=1)
    assert str(caught.value).splitlines() == [
        "case: elements_along = 4: loads[0].node: node 12 is not in the section, "
        "which has 10 nodes; give 0 to 9",
        "case: elements_along = 6: loads[0].node: 'radial' lies on the rim, which is fixed; move "
        'it off the rim or, for the force on the rim, use a probe of kind = "hub"',
    ]


def test_a_failed_line_is_data_of_its_point(monkeypatch):
    class Refusing(Recursive):
        def field(self, omega):
            D = self.problem.cell.dynamic_stiffness(0.0)
            if omega > 2 * np.pi * 400 and abs(D).max() > self.limit:
                raise SingularError("an undamped resonance lies on this line")
            return super().field(omega)

    grid = make_grid(case_with(), {"E_rubber": (40e6, 80e6)})
    soft = model.build_model(grid.cases[0]).problem.cell.dynamic_stiffness(0.0)
    Refusing.limit = 1.5 * abs(soft).max()
    monkeypatch.setitem(SOLVERS, "recursive", Refusing)
    swept = run_sweep(grid, jobs=1)
    assert swept.failed.tolist() == [[False] * 4, [False, False, False, True]]
    assert swept.n_failed == 1
    assert "420 Hz: an undamped" in swept.points[1].remark[3]


def test_progress_counts_every_line_of_every_point():
    counted = []
    run_sweep(make_grid(case_with(), {"E_rubber": MODULI}), jobs=1, progress=counted.append)
    assert sum(counted) == 12


def test_sweep_takes_a_path_and_the_case_s_own_values(tmp_path):
    path = tmp_path / "tyre.toml"
    path.write_text(TEXT + '[sweep]\nE_rubber = ["40 MPa", "80 MPa"]\n')
    swept = tyrefrf.sweep(path, {"E_rubber": None, "crown": ["12 mm", 0.014]}, jobs=1)
    assert swept.shape == (2, 2)
    assert swept.provenance.case_text == path.read_text()
    assert swept.provenance.case_name == "tyre"
    assert swept.labels[1] == "E_rubber = 40 MPa, crown = 14 mm"


def test_a_sweep_of_pressures_keeps_every_state_and_none_for_none(tmp_path):
    swept = tyrefrf.sweep(case_with(), {"pressure": (0.0, 1e5, 2e5)}, jobs=1)
    tyrefrf.write_sweep(tmp_path / "sweep.h5", swept)
    read = tyrefrf.load_sweep(tmp_path / "sweep.h5")
    assert [point.inflation is None for point in read.points] == [True, False, False]
    one, two = read.points[1].inflation, read.points[2].inflation
    np.testing.assert_array_equal(one.displacement, swept.points[1].inflation.displacement)
    np.testing.assert_allclose(two.displacement, 2.0 * one.displacement)  # linear
    with xarray.open_datatree(tmp_path / "sweep.h5", engine="h5netcdf") as tree:
        assert tree["mobility"].dims == ("pressure", "load", "probe", "frequency")
        assert tree["inflation_index"].to_numpy().tolist() == [-1, 0, 1]
