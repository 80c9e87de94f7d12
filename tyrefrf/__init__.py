"""Tyre vibrations to 3 kHz from one angular cell.

Conventions, the same everywhere:

- Phasor exp(+i omega t). Receptance H = q/F [m/N], mobility Y = i omega H [m/(s N)],
  accelerance A = -omega^2 H [m/(s^2 N)] (ISO 7626-1).
- The axle is y. e_r = (cos t, 0, sin t), e_y = (0, 1, 0), e_theta = (-sin t, 0, cos t):
  right-handed as (r, y, theta). Dofs are in (r, y, theta) at their own node.
- F is the force applied to the tyre: D_tot q = +F, so Re Y >= 0 at every driving point.
- Loss factors are hysteretic and per material: K = sum of (1 + i eta_m) K_m.
- SI units and radians inside; in case files bare angles are degrees.

Source: Duhamel, Erlicher, Nguyen, A recursive finite element method for computing tyre
vibrations (2011). Bracketed numbers in the code, [18], are its equations.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefrf.case import load_case
    from tyrefrf.results import (
        Comparison,
        Dispersion,
        Modes,
        Results,
        SweepResults,
        load_comparison,
        load_dispersion,
        load_modes,
        load_results,
        load_sweep,
        to_xarray,
        write_results,
        write_sweep,
    )
    from tyrefrf.results.deflection import Deflection, mode_deflection
    from tyrefrf.results.vtkhdf import write_vtkhdf
    from tyrefrf.results.vtu import write_vtu
    from tyrefrf.study.cluster import cluster
    from tyrefrf.study.compare import compare
    from tyrefrf.study.deflection import deflections
    from tyrefrf.study.dispersion import dispersion
    from tyrefrf.study.modes import modes
    from tyrefrf.study.outside import with_mesh
    from tyrefrf.study.run import run
    from tyrefrf.study.sweep import sweep

__all__ = [
    "Comparison",
    "Deflection",
    "Dispersion",
    "Modes",
    "Results",
    "SweepResults",
    "cluster",
    "compare",
    "deflections",
    "dispersion",
    "load_case",
    "load_comparison",
    "load_dispersion",
    "load_modes",
    "load_results",
    "load_sweep",
    "mode_deflection",
    "modes",
    "run",
    "sweep",
    "to_xarray",
    "with_mesh",
    "write_results",
    "write_sweep",
    "write_vtkhdf",
    "write_vtu",
]

_HOME = {
    "Comparison": "tyrefrf.results",
    "Deflection": "tyrefrf.results.deflection",
    "Dispersion": "tyrefrf.results",
    "Modes": "tyrefrf.results",
    "Results": "tyrefrf.results",
    "SweepResults": "tyrefrf.results",
    "cluster": "tyrefrf.study.cluster",
    "compare": "tyrefrf.study.compare",
    "deflections": "tyrefrf.study.deflection",
    "dispersion": "tyrefrf.study.dispersion",
    "load_case": "tyrefrf.case",
    "load_comparison": "tyrefrf.results",
    "load_dispersion": "tyrefrf.results",
    "load_modes": "tyrefrf.results",
    "load_results": "tyrefrf.results",
    "load_sweep": "tyrefrf.results",
    "mode_deflection": "tyrefrf.results.deflection",
    "modes": "tyrefrf.study.modes",
    "run": "tyrefrf.study.run",
    "sweep": "tyrefrf.study.sweep",
    "to_xarray": "tyrefrf.results",
    "with_mesh": "tyrefrf.study.outside",
    "write_results": "tyrefrf.results",
    "write_sweep": "tyrefrf.results",
    "write_vtkhdf": "tyrefrf.results.vtkhdf",
    "write_vtu": "tyrefrf.results.vtu",
}


def __getattr__(name: str) -> object:
    """Import public names when they are first used: `tyrefrf --help` needs none of them."""
    from importlib import import_module

    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'tyrefrf' has no attribute {name!r}")
