"""The paper's layered tyre (section 3.3) is solved as truly as a homogeneous one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small import case_with

from tyrefrf.case import Case, build_case, load_case, resolved
from tyrefrf.study.estimate import estimate
from tyrefrf.study.run import run_case

SAME = 1e-8  # of the driving line's norm: steel beside rubber, 7000 to 1
RESIDUAL = 1e-10
REAL_TYRE = (5.5, 7.0)  # [kg], a 165/65R13

LAYERS = """\
elements_along = 16
elements_through = 2
material = "rubber"
[geometry.tread]
material = "rubber"
[geometry.belt]
material = "belt"
[geometry.bead]
material = "steel"
[materials.belt]
E = "400 MPa"
nu = 0.4
rho = 2500
eta = 0.1
[materials.steel]
E = "200 GPa"
nu = 0.33
rho = 7850
"""
SMALL = ('elements_along = 8\nmaterial = "rubber"\n', LAYERS)


@pytest.fixture(scope="module")
def papers() -> Case:
    return load_case(Path(__file__).parents[2] / "cases" / "paper" / "layered.toml")


def at(case: Case, solver: str, lines: list[float]) -> Case:
    changed = {"frequency": {"values": lines}, "solver": {"name": solver}}
    return build_case(resolved(case) | changed, case.name)


def difference(a, b):
    """Largest difference of two results over each line's norm."""
    norm = np.linalg.norm(b.receptance, axis=(0, 1))
    return (np.linalg.norm(a.receptance - b.receptance, axis=(0, 1)) / norm).max()


def assert_sound(results):
    assert not results.failed.any()
    assert results.residual.max() < RESIDUAL
    for load in results.loads:
        Y = results.driving_point(load.name)
        assert (Y.real >= -1e-10 * abs(Y)).all()


def test_the_papers_tyre_by_recursion_and_by_orders(papers):
    recursive, cyclic = (
        run_case(at(papers, solver, [80.0, 1500.0]), jobs=1) for solver in ("recursive", "cyclic")
    )
    assert_sound(recursive)
    assert_sound(cyclic)
    assert difference(recursive, cyclic) < SAME


@pytest.mark.long
def test_the_papers_tyre_by_recursion_and_assembled(papers):
    lines = [5.0, 80.0, 400.0, 2000.0]
    recursive, direct = (
        run_case(at(papers, solver, lines), jobs=1) for solver in ("recursive", "direct")
    )
    assert_sound(recursive)
    assert difference(recursive, direct) < SAME


@pytest.mark.parametrize("element", ["hex8i", "hex8", "hex20", "hex20r"])
def test_a_small_layered_tyre_by_every_solver(element):
    case = case_with(SMALL, ('element = "hex8i"', f'element = "{element}"'))
    lines = [40.0, 420.0]
    direct = run_case(at(case, "direct", lines), jobs=1)
    for solver in ("recursive", "cyclic"):
        other = run_case(at(case, solver, lines), jobs=1)
        assert_sound(other)
        assert difference(other, direct) < SAME


def test_the_papers_tyre_weighs_what_its_case_says(papers):
    found = estimate(papers, 1)
    assert found.mass == pytest.approx(7.0, abs=0.05)
    assert REAL_TYRE[0] < found.mass < REAL_TYRE[1]
    assert sum(found.masses.values()) == pytest.approx(found.mass, rel=1e-12)
    assert list(found.masses) == ["rubber", "reinforced", "steel"]


@pytest.mark.parametrize("element", ["hex8i", "hex20"])
def test_masses_by_material_are_those_assembled(element):
    case = case_with(SMALL, ('element = "hex8i"', f'element = "{element}"'))
    found = estimate(case, 1)
    assert sum(found.masses.values()) == pytest.approx(found.mass, rel=1e-12)
    # the belt is a band 115 mm wide and 3 mm thick around 268.5 mm, less its facets and camber
    band = 2500.0 * 0.115 * 0.003 * 2.0 * np.pi * 0.2685
    assert found.masses["belt"] == pytest.approx(band, rel=0.05)


def test_the_papers_ring(papers):
    found = estimate(papers, 1)
    assert (found.section_nodes, found.section_elements) == (173, 128)
    assert (found.n_cells, found.ring_nodes) == (60, 60 * 173)
    assert found.free_section_dofs == 3 * (173 - 6)
