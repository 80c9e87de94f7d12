"""What a run computed: responses of every load and probe, and where they come from."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal, get_args

import numpy as np

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray, frozen
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.place import HUB, Place
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.certificate import Certificate
from tyrefrf.results.measured import Measured

Quantity = Literal["receptance", "mobility", "accelerance"]

MISSING = "not solved yet"
"""Remark of a line that a run has not come to."""


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where results come from: the case, the program, the tyre's cells.

    case_text: the case file as the user wrote it; resolved_case: as TOML with every default.
    case_hash: of the resolved case. created: ISO 8601. sector_angle: of one cell [rad].
    numbers: free facts of the run, such as dofs or wall time.
    """

    case_name: str
    title: str
    case_text: str
    resolved_case: str
    case_hash: str
    version: str
    solver: str
    created: str
    n_cells: int
    sector_angle: float
    numbers: dict[str, float | int]


@dataclass(frozen=True, slots=True, eq=False)
class StaticState:
    """The tyre at rest under pressure; its arrays are read-only.

    pressure: [Pa]. displacement: (n, 2) of the section's nodes along r and y [m].
    stress: (e, 6) mean stress of the section's elements [Pa], in the order of `STRESS`; second
        Piola-Kirchhoff where the inflation was nonlinear.
    resultant: (3,) pressure force on one cell in the axes (r, y, theta) of its middle [N].
    share, iterations, lack: (k,) the load steps: share of the pressure reached, Newton's
        iterations, and ||f - f_int|| / ||f|| that was left.
    """

    pressure: float
    displacement: FloatArray
    stress: FloatArray
    resultant: FloatArray
    share: FloatArray
    iterations: IntArray
    lack: FloatArray

    def __post_init__(self) -> None:
        for name in ("displacement", "stress", "resultant", "share", "iterations", "lack"):
            frozen(getattr(self, name))


STRESS = ("rr", "yy", "tt", "ry", "yt", "tr")
"""Components of the stress: r radial, y along the axle, t around."""


@dataclass(frozen=True, slots=True, eq=False)
class Results:
    """Responses of p probes to l loads at f frequency lines; its arrays are read-only.

    frequency: (f,) [Hz].
    loads, probes: l and p places; the probe "<load>.drive" is that load's driving point.
    receptance: (l, p, f) displacement per force [m/N], NaN where a line failed or is missing.
    blocked_force: (l, h, f) force [N/N] and moment [N m/N] that the tyre exerts on the blocked
        hub per unit load; h = 6 as in `HUB`, or 0 where the case asks for none.
    solved: (f,) false where a line failed, was fitted or is missing.
    residual: (f,) ||F - D q|| / ||F|| of the ring's equations, NaN where not solved.
    solve_time: (f,) [s], NaN where fitted.
    remark: f texts, empty or what was special about the line, or why it failed; `MISSING`.
    inflation: the static state that the tyre vibrates about; None without pressure.
    certificate: what a second look found, where one was asked for.
    measured: responses that were measured, to be held against those computed.
    Raises ResultsError where the shapes do not agree.
    """

    frequency: FloatArray
    loads: tuple[Place, ...]
    probes: tuple[Place, ...]
    receptance: ComplexArray
    blocked_force: ComplexArray
    solved: BoolArray
    residual: FloatArray
    solve_time: FloatArray
    remark: tuple[str, ...]
    section: SectionMesh
    provenance: Provenance
    inflation: StaticState | None = None
    certificate: Certificate | None = None
    measured: tuple[Measured, ...] = ()

    def __post_init__(self) -> None:
        lines = self.frequency.shape
        expect_shape(self, "receptance", (len(self.loads), len(self.probes), *lines))
        expect_shape(self, "blocked_force", (len(self.loads), len(self.hub), *lines))
        for name in ("solved", "residual", "solve_time"):
            expect_shape(self, name, lines)
        if len(self.remark) != len(self.frequency):
            raise ResultsError(f"{len(self.remark)} remarks for {len(self.frequency)} lines")
        frozen(self.frequency)

    @property
    def hub(self) -> tuple[str, ...]:
        """Names of the blocked force's components: `HUB`, or none."""
        return HUB if self.blocked_force.shape[1] else ()

    @property
    def omega(self) -> FloatArray:
        """(f,) circular frequency [rad/s]."""
        return 2 * np.pi * self.frequency

    @property
    def mobility(self) -> ComplexArray:
        """(l, p, f) velocity per force, i omega H [m/(s N)]."""
        return self._as("mobility", self.receptance)

    @property
    def accelerance(self) -> ComplexArray:
        """(l, p, f) acceleration per force, -omega^2 H [m/(s^2 N)]."""
        return self._as("accelerance", self.receptance)

    def _as(self, quantity: Quantity, receptance: ComplexArray) -> ComplexArray:
        """Receptances (..., f) as another quantity: of one response without making all the rest."""
        if quantity == "receptance":
            return receptance
        return receptance * (1j * self.omega if quantity == "mobility" else -(self.omega**2))

    @property
    def missing(self) -> BoolArray:
        """(f,) true where a run was ended before it came to the line."""
        return np.array([remark == MISSING for remark in self.remark], dtype=bool)

    @property
    def n_missing(self) -> int:
        """How many lines a run has not come to; 0 of a run that ended."""
        return int(self.missing.sum())

    @property
    def failed(self) -> BoolArray:
        """(f,) true where a line was tried and has no answer."""
        return np.isnan(self.receptance).any(axis=(0, 1)) & ~self.missing

    @property
    def n_failed(self) -> int:
        """How many lines have no answer."""
        return int(self.failed.sum())

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """The names of every load with every probe."""
        return tuple((load.name, probe.name) for load in self.loads for probe in self.probes)

    def response(self, load: str, probe: str, quantity: Quantity = "mobility") -> ComplexArray:
        """(f,) the response of a probe to a load, both by name.

        Raises ResultsError for a name that is not in the results.
        """
        index_of(quantity, get_args(Quantity), "quantity")
        i = index_of(load, [place.name for place in self.loads], "load")
        j = index_of(probe, [place.name for place in self.probes], "probe")
        return self._as(quantity, self.receptance[i, j])

    def driving_point(self, load: str, quantity: Quantity = "mobility") -> ComplexArray:
        """(f,) the response of a load's own point in its own direction."""
        index_of(load, [place.name for place in self.loads], "load")
        return self.response(load, f"{load}.drive", quantity)


def expect_shape(results: object, name: str, shape: tuple[int, ...]) -> None:
    """Make an array of some results read-only. Raises ResultsError where it has another shape."""
    array = getattr(results, name)
    if array.shape != shape:
        raise ResultsError(f"{name} has shape {array.shape}; expected {shape}")
    frozen(array)


def index_of(name: str, names: list[str] | tuple[str, ...], what: str) -> int:
    """Where a name stands in the list, or an error that proposes the nearest one."""
    if name in names:
        return names.index(name)
    close = get_close_matches(name, names, n=1)
    hint = f"did you mean {close[0]!r}?" if close else f"there are: {', '.join(names)}"
    raise ResultsError(f"no {what} {name!r} in the results; {hint}")
