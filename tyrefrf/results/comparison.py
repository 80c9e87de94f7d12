"""What several solvers made of the same lines: their answers, and what these took."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tyrefrf.arrays import BoolArray, ComplexArray, FloatArray, IntArray, frozen
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.place import Place
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results.results import Provenance, Results, StaticState, expect_shape, index_of

TRUTH = "direct"
"""The solver that the others are measured against, where it has answers."""


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """s solvers at the same f lines, each in a process of its own; arrays are read-only.

    frequency: (f,) [Hz]. loads, probes: l and p places, as in `Results`.
    receptance: (s, l, p, f) [m/N], NaN where a line failed, or the solver as a whole.
    seconds: (s, f) CPU time of each line [s]. prepare_seconds: (s,) before the first line [s].
    base_memory: (s,) most memory until the tyre was assembled [bytes]: the interpreter,
        libraries, matrices of one cell. peak_memory: (s,) until the last line was solved.
    disk: (s,) size of the results file [bytes].
    residual: (s, f) ||F - D q|| / ||F|| of the ring's equations, NaN where not solved.
    difference: (s, f) of the responses to those of `reference`: the largest over loads and
        probes, relative to the norm over the probes at that line under that load.
    samples: (k,) numbers of the lines at which whole sections are compared.
    section_error: (s, s, k) of a solver against another, their order that of `solvers`: norm of
        the difference over a section's displacement, relative to the norm of the other's; the
        largest over sections and loads.
    remark: s times f texts, as in `Results`. failure: s texts, why a solver has no answers.
    machine: facts of what it was computed on, by name.
    Raises ResultsError where the shapes do not agree.
    """

    frequency: FloatArray
    solvers: tuple[str, ...]
    loads: tuple[Place, ...]
    probes: tuple[Place, ...]
    receptance: ComplexArray
    seconds: FloatArray
    prepare_seconds: FloatArray
    peak_memory: FloatArray
    base_memory: FloatArray
    disk: FloatArray
    residual: FloatArray
    difference: FloatArray
    samples: IntArray
    section_error: FloatArray
    remark: tuple[tuple[str, ...], ...]
    failure: tuple[str, ...]
    machine: dict[str, str]
    section: SectionMesh
    provenance: Provenance
    inflation: StaticState | None = None

    def __post_init__(self) -> None:
        s, lines = len(self.solvers), self.frequency.shape
        expect_shape(self, "receptance", (s, len(self.loads), len(self.probes), *lines))
        for name in ("seconds", "residual", "difference"):
            expect_shape(self, name, (s, *lines))
        for name in ("prepare_seconds", "peak_memory", "base_memory", "disk"):
            expect_shape(self, name, (s,))
        expect_shape(self, "section_error", (s, s, len(self.samples)))
        if (len(self.remark), len(self.failure)) != (s, s):
            raise ResultsError(f"remarks or failures are not those of {s} solvers")
        frozen(self.frequency)
        frozen(self.samples)

    @property
    def mobility(self) -> ComplexArray:
        """(s, l, p, f) velocity per force, i omega H [m/(s N)]."""
        return 2j * np.pi * self.frequency * self.receptance

    @property
    def failed(self) -> BoolArray:
        """(s, f) true where a solver has no answer to a line."""
        return np.asarray(np.isnan(self.receptance).any(axis=(1, 2)))

    @property
    def reference(self) -> str:
        """The solver that `difference` is measured against."""
        return reference_of(self.solvers, self.failure)

    @property
    def error(self) -> FloatArray:
        """(s,) largest `section_error` against the reference over the lines compared."""
        return self.pair_error[:, self.solvers.index(self.reference)]

    @property
    def pair_error(self) -> FloatArray:
        """(s, s) largest `section_error` of every solver against every other."""
        return largest(self.section_error)

    @property
    def runs(self) -> tuple[Results, ...]:
        """Every solver's answers as those of a run."""
        return tuple(self._run(i) for i in range(len(self.solvers)))

    def of(self, solver: str) -> Results:
        """One solver's answers as those of a run. Raises ResultsError for another name."""
        return self._run(index_of(solver, self.solvers, "solver"))

    def _run(self, i: int) -> Results:
        return Results(
            frequency=self.frequency,
            loads=self.loads,
            probes=self.probes,
            receptance=self.receptance[i],
            blocked_force=np.empty((len(self.loads), 0, len(self.frequency)), complex),
            solved=~np.isnan(self.residual[i]),
            residual=self.residual[i],
            solve_time=self.seconds[i],
            remark=self.remark[i],
            section=self.section,
            provenance=self.provenance,
            inflation=self.inflation,
        )


def time_text(seconds: float) -> str:
    """Three digits of seconds or milliseconds."""
    return f"{seconds:.3g} s" if seconds >= 0.9995 else f"{1e3 * seconds:.3g} ms"


def reference_of(solvers: tuple[str, ...], failure: tuple[str, ...]) -> str:
    """`direct` where it has answers, else the first that has, else the first."""
    answered = [name for name, why in zip(solvers, failure, strict=True) if not why]
    return TRUTH if TRUTH in answered else (*answered, *solvers)[0]


def largest(values: FloatArray) -> FloatArray:
    """The largest along the last axis of what is not NaN; NaN where nothing is left."""
    known = ~np.isnan(values)
    top = np.max(values, axis=-1, where=known, initial=-np.inf)
    return np.where(known.any(axis=-1), top, np.nan)
