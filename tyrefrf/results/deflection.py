"""The motion of the whole tyre in one harmonic: under a load, or of a natural mode."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, log10

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray, frozen
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.cell import CellMesh, revolve
from tyrefrf.mesh.place import Place
from tyrefrf.results.modes import Modes
from tyrefrf.results.results import Provenance
from tyrefrf.results.ring_mesh import RingMesh

VISIBLE, LARGEST = 0.08, 0.3
"""Motion in a drawing, of the tyre's radius: of all but a twentieth of the points, which may stand
out beside a load at a node; and of any point. `visible_scale` rounds it down."""

STEADY = 1e-9  # of the mean square: a square sum that varies less with time varies by rounding


@dataclass(frozen=True, slots=True, eq=False)
class Deflection:
    """One harmonic motion of the ring, u(t) = Re[u exp(i omega t)]; its arrays are read-only.

    name: what moves, fit for file names: the load's, or "mode_3". words: the same for a title.
    frequency: [Hz].
    u: (p, 3) along r, y and theta at every point's own angle: displacement per unit load [m/N],
        or of a mode of unit modal mass of the ring's cell [1/sqrt(kg)].
    residual: ||F - D q|| / ||F|| of its line, or of the mode's own equation.
    load: where the load acts; None of a mode.
    Raises ResultsError where u has not a vector for every point.
    """

    name: str
    words: str
    frequency: float
    u: ComplexArray
    residual: float
    mesh: RingMesh
    provenance: Provenance
    load: Place | None = None

    def __post_init__(self) -> None:
        if self.u.shape != self.mesh.points.shape:
            raise ResultsError(f"u has shape {self.u.shape}; expected {self.mesh.points.shape}")
        frozen(self.u)

    @property
    def stem(self) -> str:
        """The name of its files: `radial_100Hz`; natural frequencies are rounded there."""
        return field_stem(self.name, self.frequency, of_mode=self.load is None)

    @property
    def cartesian(self) -> ComplexArray:
        """(p, 3) the motion along x, y and z."""
        return self.mesh.cartesian(self.u)

    @property
    def mean_square_velocity(self) -> FloatArray:
        """(p,) |omega u|^2 / 2, summed over the directions [(m/s)^2 per N^2, or 1/(s^2 kg)]."""
        omega = 2.0 * np.pi * self.frequency
        return np.asarray(0.5 * omega**2 * np.sum(np.abs(self.u) ** 2, axis=1))

    @property
    def units(self) -> dict[str, str]:
        """Units of the displacement and of its mean-square velocity."""
        if self.load is None:
            return {"displacement": "1/sqrt(kg)", "mean_square_velocity": "1/(s^2 kg)"}
        return {"displacement": "m/N", "mean_square_velocity": "m^2/(s^2 N^2)"}

    @property
    def visible_scale(self) -> float:
        """A round factor that makes the motion visible; 1 where nothing moves."""
        size = np.linalg.norm(self.u, axis=1)
        if not size.any():
            return 1.0
        radius = float(np.hypot(self.mesh.points[:, 0], self.mesh.points[:, 2]).max())
        needed = max(float(np.quantile(size, 0.95)) / VISIBLE, float(size.max()) / LARGEST)
        factor = radius / needed
        decade = 10.0 ** floor(log10(factor))
        fits = (step for step in (5.0, 2.0, 1.0) if step * decade <= factor)
        return decade * next(fits, 1.0)


def field_stem(name: str, frequency: float, *, of_mode: bool) -> str:
    """The name of a motion's files, without what is after the dot."""
    return f"{name}_{frequency:.{5 if of_mode else 10}g}Hz"


def phase_of_most(u: ComplexArray) -> float:
    """The omega t [rad] at which the sum of the squares of Re[u exp(i omega t)] is largest.

    0 where it is the same at all times, as of a wave that runs around.
    """
    beat = np.sum(u**2)
    steady = np.abs(beat) <= STEADY * np.sum(np.abs(u) ** 2)
    return 0.0 if steady else float(-0.5 * np.angle(beat))


def at_phase(u: ComplexArray, phase: float) -> FloatArray:
    """Re[u exp(i phase)]; phase = omega t [rad]."""
    return np.asarray((u * np.exp(1j * phase)).real)


def mode_deflection(modes: Modes, number: int, cell: CellMesh | None = None) -> Deflection:
    """The whole ring in one of its modes, number 1 being the lowest.

    Of a pair, the real and the imaginary part are its two members, standing waves that differ by
    a quarter of a wavelength; together they run around.

    cell: the case's own, needed where it is no whole section revolved: with grooves, from a file.
    Raises ResultsError for a mode that is not there, or where the modes are not of this cell.
    """
    if not 1 <= number <= len(modes.frequency):
        raise ResultsError(f"no mode {number}; there are: 1 to {len(modes.frequency)}")
    i, N = number - 1, modes.provenance.n_cells
    h = int(modes.order[i])
    turned = np.exp(2j * np.pi * h * np.arange(N) / N)
    return Deflection(
        name=f"mode_{number}",
        words=f"mode {number}, order {h}, {modes.kind[i]}",
        frequency=float(modes.frequency[i]),
        u=(turned[:, None, None] * modes.shape[i]).reshape(-1, 3),
        residual=float(modes.residual[i]),
        mesh=RingMesh.of(_cell_of(modes, cell), N),
        provenance=modes.provenance,
    )


def _cell_of(modes: Modes, cell: CellMesh | None) -> CellMesh:
    """The cell of the modes; by default what their section was revolved into.

    Raises ResultsError where it is not.
    """
    if cell is not None:
        if not np.array_equal(cell.points[: cell.n_own], modes.points):
            raise ResultsError("the modes' points are not those of the cell")
        return cell
    step = 2 if modes.section.quads.shape[1] == 8 else 1
    layers = len(np.unique(modes.points[:, 2])) // step
    mesh = revolve(modes.section, modes.provenance.sector_angle, layers)
    if not np.array_equal(mesh.points[: mesh.n_own], modes.points):
        raise ResultsError(
            "the modes' points are not those of the section revolved; give their cell"
        )
    return mesh
