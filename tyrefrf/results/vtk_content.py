"""What every VTK file of a deflection says, whatever its format.

Displacements and points are in single precision: 6e-8 of a value, for pictures.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefrf.arrays import FloatArray
from tyrefrf.results.deflection import Deflection, at_phase
from tyrefrf.results.ring_mesh import RingMesh

Arrays = dict[str, NDArray[Any]]
"""Arrays by the names that ParaView shows."""

CELL_TYPES = {8: 12, 20: 25}
"""VTK_HEXAHEDRON, VTK_QUADRATIC_HEXAHEDRON: their nodes stand in Abaqus order."""

COMPONENTS = ("u_r", "u_y", "u_theta")

CONVENTION = (
    "u(t) = Re[(real + i imag) exp(i omega t)]: phase 0 is the real part, phase 90 deg minus the "
    "imaginary part; u_r, u_y, u_theta along e_r = (cos t, 0, sin t), e_y = (0, 1, 0), "
    "e_theta = (-sin t, 0, cos t)"
)


def parts(deflection: Deflection) -> Arrays:
    """Real and imaginary parts as Cartesian vectors (p, 3), and the mean-square velocity (p,)."""
    u = deflection.cartesian
    return {
        "displacement_real": single(u.real),
        "displacement_imag": single(u.imag),
        "mean_square_velocity": single(deflection.mean_square_velocity),
    }


def cylindrical_parts(deflection: Deflection) -> Arrays:
    """Real and imaginary parts (p,) of each cylindrical component."""
    return {
        f"{name}_{part}": single(getattr(column, part))
        for name, column in zip(COMPONENTS, deflection.u.T, strict=True)
        for part in ("real", "imag")
    }


def moment(deflection: Deflection, phase: float) -> Arrays:
    """The motion at omega t = phase [rad]: a Cartesian vector (p, 3), and its components (p,)."""
    u = at_phase(deflection.u, phase)
    components = {name: single(u[:, i]) for i, name in enumerate(COMPONENTS)}
    return {"displacement": single(at_phase(deflection.cartesian, phase)), **components}


def cell_data(mesh: RingMesh) -> Arrays:
    """What each brick (b,) is: its material, and its angular cell."""
    return {"material": mesh.material.astype(np.int32), "cell": mesh.cell.astype(np.int32)}


def texts(deflection: Deflection) -> dict[str, str]:
    """Where the file comes from and how to read it, as field data."""
    origin, units = deflection.provenance, deflection.units
    return {
        "case": origin.case_name,
        "case_hash": origin.case_hash,
        "version": f"tyrefrf {origin.version}",
        "load": deflection.words,
        "convention": CONVENTION,
        "units": f"displacement, u_r, u_y, u_theta: {units['displacement']}; "
        f"mean_square_velocity: {units['mean_square_velocity']}; points: m; time: deg of phase",
        "materials": ", ".join(f"{i}: {name}" for i, name in enumerate(deflection.mesh.materials)),
    }


def numbers(deflection: Deflection) -> dict[str, float]:
    """The numbers that a reader of the file needs, as field data."""
    return {
        "frequency_Hz": deflection.frequency,
        "residual": deflection.residual,
        "visible_scale": deflection.visible_scale,
    }


def single(values: FloatArray) -> NDArray[np.float32]:
    """In single precision."""
    return values.astype(np.float32)
