"""Sensors of a case: where their masses are, who sees them, and what else they leave alone.

The truth is the case's own ring with a mass of omega^2 m in the dynamic stiffness of the whole
ring, at the place's own weights.
"""

from __future__ import annotations

import numpy as np
import pytest
from small import TEXT, case_with

from tyrefrf.case import parse_case
from tyrefrf.results import load_results, write_results
from tyrefrf.results.proof import breaches
from tyrefrf.solvers.direct import ring_matrix
from tyrefrf.study.certify import certified, plan_certificate
from tyrefrf.study.estimate import estimate
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import sweep

ERROR = 1e-9
MASSES = (0.02, 0.03)  # kg, at the sidewall and at the crown
SIDEWALL, CROWN = 2, 3  # probes, after the driving points
LINE = 3  # 420 Hz
KINDS = {
    "point": 's = 0.5\nangle = 30.0\ndirection = "r"\n',
    "node": 'kind = "node"\ns = 0.5\nangle = 48.0\ndirection = "r"\n',
    "patch": 'kind = "patch"\ns = 0.5\nangle = 30.0\ndirection = "theta"\ndiameter = "30 mm"\n',
}


def probes(kind, *masses):
    """The small tyre with a second probe, of some kind, and masses at both."""
    keys = [f"sensor_mass = {mass}\n" for mass in masses] or ["", ""]
    first = f'name = "sidewall"\n{keys[0]}'
    second = f'[[probes]]\nname = "crown"\n{KINDS[kind]}{keys[1]}\n[[probes]]\nname = "hub"'
    return ('name = "sidewall"\n', first), ('[[probes]]\nname = "hub"', second)


def roving(kind="point", *more):
    return case_with(*probes(kind, *MASSES), *more)


def mounted(kind="point"):
    return roving(kind, ("[geometry]", 'sensors = "mounted"\n\n[geometry]'))


def truth(case, *masses):
    """(l, p) of the bare case's ring at 420 Hz with masses at (probe) in its dynamic stiffness."""
    model = build_model(case)
    problem = model.problem
    omega = 2.0 * np.pi * case.frequency.lines()[LINE]
    free = np.tile(problem.free, problem.n_cells)
    matrix = ring_matrix(problem)
    entries = problem.cell.dynamic_stiffness(omega)[matrix.source]
    D = np.zeros((matrix.n, matrix.n), complex)
    np.add.at(D, (matrix.rows, matrix.columns), entries)
    for probe, mass in masses:
        for direction in ("r", "y", "theta"):
            P = _column(case, probe, direction)[free]
            D -= omega**2 * mass * np.outer(P, P)
    q = np.linalg.solve(D, problem.loads.toarray()[free])
    return (problem.probes.toarray()[free].T @ q)[: len(model.probes)].T


def _column(case, probe, direction):
    """The weights of a probe of the case, turned into another direction."""
    entries = list(case.probes)
    k = probe - len(case.loads)
    entries[k] = entries[k].model_copy(update={"direction": direction, "name": "turned"})
    turned = build_model(case.model_copy(update={"probes": tuple(entries)}))
    return turned.problem.probes[:, [probe]].toarray()[:, 0]


def assert_same(H, expected):
    assert np.max(np.abs(H - expected) / np.abs(expected).max(axis=1, keepdims=True)) < ERROR


@pytest.fixture(scope="module")
def bare():
    return case_with(*probes("point"))


@pytest.fixture(scope="module")
def without(bare):
    return run_case(bare, jobs=1)


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_probe_sees_its_own_sensor(kind):
    H = run_case(roving(kind), jobs=1).receptance[..., LINE]
    case = case_with(*probes(kind))
    expected = truth(case)
    expected[:, SIDEWALL] = truth(case, (SIDEWALL, MASSES[0]))[:, SIDEWALL]
    expected[:, CROWN] = truth(case, (CROWN, MASSES[1]))[:, CROWN]
    assert_same(H, expected)


def test_mounted_sensors_are_seen_by_every_probe(bare):
    H = run_case(mounted(), jobs=1).receptance[..., LINE]
    expected = truth(bare, (SIDEWALL, MASSES[0]), (CROWN, MASSES[1]))
    assert_same(H, expected)
    assert np.abs(expected - truth(bare))[:, :2].max() > 1e-3 * np.abs(expected).max()


def test_roving_sensors_leave_driving_points_and_the_hub_alone(without):
    with_sensors = run_case(roving(), jobs=1)
    H, expected = with_sensors.receptance[:, :SIDEWALL], without.receptance[:, :SIDEWALL]
    np.testing.assert_allclose(H, expected, rtol=ERROR)
    force, size = without.blocked_force, np.abs(without.blocked_force).max()
    np.testing.assert_allclose(with_sensors.blocked_force, force, atol=ERROR * size)


def test_mounted_sensors_are_felt_at_the_hub(without):
    moved = run_case(mounted(), jobs=1).blocked_force - without.blocked_force
    assert np.abs(moved[..., 1:]).max() > 1e-3 * np.abs(without.blocked_force).max()
    assert np.abs(moved[..., 0]).max() < ERROR  # at 0 Hz no mass acts


@pytest.mark.parametrize("case", [roving(), mounted()], ids=["roving", "mounted"])
def test_proofs_and_certificate_raise_no_alarm(case):
    results = run_case(case, jobs=1)
    results = certified(plan_certificate(case, results), 1)
    assert results.certificate.difference.shape == (2, 4)
    assert results.certificate.difference.max() < ERROR
    assert results.certificate.cell_difference.shape == (2, 4)
    assert results.certificate.level_change.shape == (2, 4, 4)
    assert breaches(results) == ()


FINE = ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 420.0\nstep = 1.0")
ADAPTIVE = (FINE[0], f"{FINE[1]}\nadaptive = true")


def test_adaptive_lines_fit_what_the_sensor_sees():
    every = run_case(roving("point", FINE), jobs=1)
    some = run_case(roving("point", ADAPTIVE), jobs=1)
    assert some.solved.sum() < 0.6 * len(some.frequency)
    peak = np.abs(every.receptance[[0, 1], [0, 1]]).max(axis=1)
    error = np.abs(some.receptance - every.receptance).max(axis=(1, 2)) / peak
    assert error.max() < 1e-5


def test_a_sweep_and_the_file_keep_the_sensors(tmp_path):
    study = sweep(roving(), {"E_rubber": (80e6, 90e6)}, jobs=1)
    alone = run_case(roving(), jobs=1)
    np.testing.assert_array_equal(study.points[0].receptance, alone.receptance)
    write_results(tmp_path / "run.h5", alone)
    kept = load_results(tmp_path / "run.h5")
    assert [place.sensor_mass for place in kept.probes] == [0.0, 0.0, *MASSES]
    assert kept.probes[CROWN].label.endswith("sensor 30 g")


def test_an_estimate_counts_the_loads_of_the_sensors(bare):
    assert (estimate(roving(), 1).n_sensors, estimate(bare, 1).n_sensors) == (2, 0)


def test_a_load_s_own_point_with_a_sensor_is_a_probe_there():
    """A' = A / (1 + m A) where nothing couples: radially at a node of the plane of symmetry."""
    probe = (
        '[[probes]]\nname = "own"\nkind = "node"\ns = 0.5\ndirection = "r"\nsensor_mass = 0.05\n'
    )
    results = run_case(parse_case(f"{TEXT}\n{probe}", "small.toml", "small"), jobs=1)
    A = results.driving_point("radial", "accelerance")
    loaded = results.response("radial", "own", "accelerance")
    np.testing.assert_allclose(loaded, A / (1.0 + 0.05 * A), rtol=ERROR)
