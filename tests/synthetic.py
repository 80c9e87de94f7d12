"""Made-up results that look like a tyre's: damped modes on a curved section of 28 elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.mesh.place import Place
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results import Provenance, Results

N_ELEMENTS = 28
LINES = np.linspace(0.0, 2000.0, 401)
LOSS_FACTOR = 0.1
ROUNDING = 1e-17  # what a response that is zero by symmetry looks like [m/N]
PHASE_SHIFT = {"r": 0.0, "y": 0.0, "theta": np.pi / 2}


def section() -> SectionMesh:
    """One element through the thickness, from rim to rim: rubber, and a belt of steel cord."""
    t = np.linspace(-1.0, 1.0, N_ELEMENTS + 1)
    centre, normal = _profile(t)
    half = (0.003 + 0.004 * (1.0 - np.abs(t)))[:, None] * normal
    points = np.stack([centre - half, centre + half], axis=1).reshape(-1, 2)
    first = 2 * np.arange(N_ELEMENTS)
    belt = (np.abs(t[:-1] + t[1:]) / 2 < 0.36).astype(np.int64)
    return SectionMesh(
        points=points,
        quads=np.stack([first, first + 2, first + 3, first + 1], axis=1),
        material=belt,
        materials=("rubber", "tread"),
        rim=np.array([0, 1, 2 * N_ELEMENTS, 2 * N_ELEMENTS + 1]),
        outer=np.stack([first + 1, first + 3], axis=1),
        inner=np.stack([first, first + 2], axis=1),
    )


def _profile(t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Centre line (n, 2) in (r, y) and its outward unit normal (n, 2), for t from -1 to 1."""
    knots = [-1.0, -0.78, -0.42, 0.0, 0.42, 0.78, 1.0]
    places = np.array(
        [
            [0.168, -0.064],
            [0.220, -0.081],
            [0.264, -0.060],
            [0.271, 0.0],
            [0.264, 0.060],
            [0.220, 0.081],
            [0.168, 0.064],
        ]
    )
    curve = CubicSpline(knots, places)
    tangent = curve(t, 1)
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    return curve(t), normal / np.linalg.norm(normal, axis=1)[:, None]


def place(
    name: str, s: float, direction: str, angle: float = 0.0, surface: str = "outer", **more: object
) -> Place:
    """A place on a surface of the section."""
    centre, normal = _profile(np.array([2.0 * s - 1.0]))
    side = 1.0 if surface == "outer" else -1.0
    r, y = (centre + side * (0.003 + 0.004 * (1.0 - abs(2.0 * s - 1.0))) * normal)[0]
    kind = "patch" if more.get("diameter") else "point"
    return Place(name, kind, surface, s, float(r), float(y), np.deg2rad(angle), direction, **more)  # type: ignore[arg-type]


LOADS = (
    place("radial", 0.5, "r", diameter=0.01),
    place("tangential", 0.5, "theta"),
)
PROBES = (
    place("shoulder", 0.32, "r"),
    place("sidewall", 0.15, "y"),
    place("radial.drive", 0.5, "r", diameter=0.01),
    place("tangential.drive", 0.5, "theta"),
    place("far side", 0.5, "r", angle=180.0),
    place("quarter", 0.5, "theta", angle=90.0),
    place("liner", 0.6, "r", surface="inner"),
    place("crown y", 0.5, "y"),
)


def results(
    frequency: FloatArray = LINES,
    loads: tuple[Place, ...] = LOADS,
    probes: tuple[Place, ...] = PROBES,
) -> Results:
    """Passive, reciprocal responses with zeros by symmetry, and no line that failed."""
    receptance = np.array(
        [[_receptance(frequency, load, probe) for probe in probes] for load in loads]
    )
    return Results(
        frequency=frequency.copy(),
        loads=loads,
        probes=probes,
        receptance=receptance,
        blocked_force=np.array([_blocked_force(frequency, load) for load in loads]),
        solved=np.ones(len(frequency), dtype=bool),
        residual=np.full(len(frequency), 3e-15),
        solve_time=np.full(len(frequency), 0.012),
        remark=("",) * len(frequency),
        section=section(),
        provenance=PROVENANCE,
    )


PROVENANCE = Provenance(
    case_name="made_up",
    title="A made-up tyre 165/65R13",
    case_text='title = "A made-up tyre 165/65R13"  # η = 0.1\n',
    resolved_case='title = "A made-up tyre 165/65R13"\nsolver = "recursive"\n',
    case_hash="5f1d",
    version="0.1.0",
    solver="recursive",
    created="2026-11-22T07:00:00+00:00",
    n_cells=45,
    sector_angle=float(np.deg2rad(8.0)),
    numbers={"dofs": 7830, "wall_time": 4.75},
)


def with_failed(made: Results, *lines: int) -> Results:
    """The same results, had these lines found no answer."""
    receptance, blocked = made.receptance.copy(), made.blocked_force.copy()
    solved, residual = made.solved.copy(), made.residual.copy()
    for array in (receptance, blocked):
        array[..., list(lines)] = complex(np.nan, np.nan)
    solved[list(lines)], residual[list(lines)] = False, np.nan
    remark = tuple("singular" if i in lines else "" for i in range(len(made.frequency)))
    return replace(
        made,
        receptance=receptance,
        blocked_force=blocked,
        solved=solved,
        residual=residual,
        remark=remark,
    )


def _receptance(frequency: FloatArray, load: Place, probe: Place) -> ComplexArray:
    """(f,) sum over modes, n waves around and m half waves across [m/N]."""
    omega, total = 2 * np.pi * frequency, np.full(len(frequency), ROUNDING, dtype=complex)
    for n in range(26):
        for m in (1, 2, 3):
            omega_0 = 2 * np.pi * (70.0 + 38.0 * n + 210.0 * (m - 1) + 1.1 * n**2)
            weight = _around(n, load, probe) * _across(m, load) * _across(m, probe)
            total += weight / (9.0 * (omega_0**2 * (1 + 1j * LOSS_FACTOR) - omega**2))
    return total


def _around(n: int, load: Place, probe: Place) -> float:
    """Modes come in pairs, cos and sin; an in-plane tangential motion lags by a quarter wave."""
    shift = PHASE_SHIFT[probe.direction] - PHASE_SHIFT[load.direction]
    value = float(np.cos(n * (probe.angle - load.angle) + shift))
    return 0.0 if abs(value) < 1e-12 else value


def _across(m: int, place: Place) -> float:
    """Shape across the section; axial motion is odd about the mid-plane in odd shapes."""
    shape = np.cos if place.direction == "y" else np.sin
    value = float(shape(m * np.pi * place.s)) * {"r": 1.0, "y": 0.5, "theta": 0.4}[place.direction]
    return 0.0 if abs(value) < 1e-12 or (place.direction == "y" and m == 2) else value


def _blocked_force(frequency: FloatArray, load: Place) -> ComplexArray:
    """(6, f) a radial load gives Fx alone, a tangential one Fz and My."""
    resonance = 95.0 if load.direction == "r" else 60.0
    transmitted = 1.0 / (1.0 + 1j * LOSS_FACTOR - (frequency / resonance) ** 2)
    force = np.full((6, len(frequency)), ROUNDING, dtype=complex)
    if load.direction == "r":
        force[0] = transmitted
    else:
        force[2], force[4] = transmitted, -load.r * transmitted
    return force
