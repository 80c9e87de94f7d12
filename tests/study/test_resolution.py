"""Elements per wavelength: the waves of flat walls, against the plate's closed forms.

A plate of bending stiffness D and mass m per area bends in waves of 2 pi (D/(m omega^2))^(1/4);
a plate of two layers has D = E_1 h_1^3/3 + E_2 h_2^3/3 - (E_1 h_1^2 - E_2 h_2^2)^2/(4 (E_1 h_1 +
E_2 h_2)) about its neutral axis, with E/(1 - nu^2) for E (Timoshenko, Analysis of bi-metal
thermostats, 1925, with distances from the interface). Shear waves have sqrt(G/rho)/f.
"""

from __future__ import annotations

import numpy as np
import pytest

from tyrefrf.case import Isotropic
from tyrefrf.fem.constitutive import constitutive
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.grid import grid_section
from tyrefrf.study.resolution import Resolution, resolutions

EXACT = 1e-12
F = 500.0  # [Hz]
OMEGA = 2.0 * np.pi * F
SOFT = Isotropic(E=28e6, nu=0.48, rho=1000.0, eta=0.1)
STIFF = Isotropic(E=400e6, nu=0.4, rho=2500.0, eta=0.1)
LAWS = {"soft": constitutive(SOFT), "stiff": constitutive(STIFF)}
LENGTH, AROUND = 0.01, np.pi / 900.0  # along the profile [m], sector angle: 3.5 mm


def flat(heights: list[float], material: list[int], quadratic: bool = False) -> CellMesh:
    """A flat wall of four columns at a radius of 1 m; heights of its rows' borders [m]."""
    step = 2 if quadratic else 1
    n = len(material)
    r = 1.0 + np.interp(np.arange(step * n + 1) / step, np.arange(n + 1), heights)
    y = LENGTH / step * np.arange(4 * step + 1)
    grid = np.stack(np.meshgrid(y, r, indexing="ij")[::-1], axis=-1)
    section = grid_section(grid, np.full(4, n), step, np.tile(material, (4, 1)), ("soft", "stiff"))
    return revolve(section, AROUND, 2)


def found(mesh: CellMesh) -> dict[str, Resolution]:
    return {r.material: r for r in resolutions(mesh, LAWS, F)}


def wavelength(D: float, mass: float) -> float:
    return 2.0 * np.pi * (D / (mass * OMEGA**2)) ** 0.25


def plate(stuff: Isotropic) -> float:
    assert stuff.E is not None
    return stuff.E / (1.0 - stuff.nu**2)


@pytest.mark.parametrize("quadratic", [False, True])
def test_bending_of_two_layers(quadratic):
    a, b, h_a, h_b = plate(SOFT), plate(STIFF), 0.005, 0.003
    D = a * h_a**3 / 3 + b * h_b**3 / 3 - (a * h_a**2 - b * h_b**2) ** 2 / (4 * (a * h_a + b * h_b))
    wave = wavelength(D, SOFT.rho * h_a + STIFF.rho * h_b)
    waves = found(flat([0.0, h_a, h_a + h_b], [0, 1], quadratic))
    for name in ("soft", "stiff"):
        assert waves[name].bending == pytest.approx(wave, rel=EXACT)
        assert waves[name].thickness == pytest.approx(h_a + h_b, rel=EXACT)


def test_bending_of_a_wall_does_not_depend_on_how_it_is_cut_into_rows():
    one = flat([0.0, 0.006, 0.007], [0, 0])
    many = flat([0.0, 0.001, 0.003, 0.0065, 0.007], [0, 0, 0, 0])
    for mesh in (one, many):
        waves = resolutions(_only_soft(mesh), LAWS, F)[0]
        assert waves.bending == pytest.approx(
            wavelength(plate(SOFT) * 0.007**3 / 12.0, SOFT.rho * 0.007), rel=1e-9
        )


def _only_soft(mesh: CellMesh) -> CellMesh:
    from dataclasses import replace

    return replace(mesh, materials=("soft",))


def test_shear_is_the_materials_own():
    waves = found(flat([0.0, 0.005, 0.008], [0, 1]))
    for name, stuff in (("soft", SOFT), ("stiff", STIFF)):
        G = stuff.E / (2.0 * (1.0 + stuff.nu))
        assert waves[name].shear == pytest.approx(np.sqrt(G / stuff.rho) / F, rel=EXACT)


@pytest.mark.parametrize(("quadratic", "enough"), [(False, 6.0), (True, 3.0)])
def test_size_is_the_longest_edge_along_or_around(quadratic, enough):
    waves = found(flat([0.0, 0.05, 0.08], [0, 1], quadratic))["soft"]
    assert waves.size == pytest.approx(LENGTH, rel=EXACT)  # not the 50 mm through
    assert waves.enough == enough
    assert waves.per_wavelength == min(waves.shear, waves.bending) / waves.size
    assert waves.fine == (waves.per_wavelength >= enough)


def test_the_worst_place_of_a_material_counts():
    mesh = flat([0.0, 0.005, 0.008], [0, 1])
    points = mesh.points.copy()
    thin = (points[:, 1] < 1.5 * LENGTH) & (points[:, 0] > 1.0)
    points[thin, 0] = 1.0 + (points[thin, 0] - 1.0) / 2.0
    section = mesh.section
    from dataclasses import replace

    sunk = replace(section, points=points[: section.n_nodes, :2])
    waves = found(revolve(sunk, AROUND, 2))
    assert waves["soft"].thickness == pytest.approx(0.004, rel=1e-9)
