"""Operating deflections: how the whole tyre moves under every load at chosen frequencies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tyrefrf.arrays import ComplexArray
from tyrefrf.case import Case, load_case, read_text
from tyrefrf.errors import CaseError, Problem, SolveError
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.mesh.place import Place
from tyrefrf.results.deflection import Deflection
from tyrefrf.results.names import file_names
from tyrefrf.results.ring_mesh import RingMesh
from tyrefrf.solvers import Field, prepare, solve_field
from tyrefrf.study.choose import decided_model
from tyrefrf.study.local import pinned
from tyrefrf.study.memory import check_fits, need_of_deflections
from tyrefrf.study.model import Model, build_model
from tyrefrf.study.run import provenance_of, sizes


@dataclass(frozen=True, slots=True)
class Deflected:
    """One frequency [Hz]: a deflection for every load, or none and the reason."""

    frequency: float
    deflections: tuple[Deflection, ...]
    failure: str = ""


@pinned
def deflections(case: Case | str | Path, frequencies: Sequence[float]) -> list[Deflection]:
    """Every load's deflection at frequencies [Hz]: `tyrefrf.deflections("case.toml", [100.0])`.

    Raises CaseError and MeshError as `run`, SolveError at a frequency without an answer.
    """
    text = ""
    if not isinstance(case, Case):
        path = Path(case)
        case, text = load_case(path), read_text(path)
    found: list[Deflection] = []
    for line in deflected(case, frequencies, case_text=text):
        if line.failure:
            raise SolveError(line.failure)
        found += line.deflections
    return found


def deflected(
    case: Case, frequencies: Sequence[float], *, case_text: str = ""
) -> Iterator[Deflected]:
    """Solve a case at frequencies [Hz], whatever its own lines are, one after another.

    Lines are checked as any are: one without a trustworthy answer has its reason instead.
    Raises CaseError and MeshError as `build_model`, SolveError where none could be solved.
    """
    if case.matrices is not None:
        message = "have no elements to draw a deflection with; bring a mesh, as [mesh]"
        raise CaseError([Problem(("matrices",), message)])
    model, _ = pinned(decided_model)(build_model(case))
    check_fits(need_of_deflections(model.case, model.problem))
    solver = pinned(prepare)(model.problem, model.case.solver)()
    gather = _Gather(model, case_text)
    for frequency in frequencies:
        try:
            field = pinned(solve_field)(model.problem, solver, 2.0 * np.pi * frequency)
        except SolveError as error:
            yield Deflected(frequency, (), str(error))
        else:
            yield Deflected(frequency, gather.of(field, frequency))


class _Gather:
    """Puts fields of the ring's dofs on the points of its mesh."""

    def __init__(self, model: Model, case_text: str) -> None:
        assert isinstance(model.mesh, CellMesh)
        self.mesh = RingMesh.of(model.mesh, model.problem.n_cells)
        self.provenance = provenance_of(model.case, case_text, dict(sizes(model)))
        self.loads = model.loads
        self.names = file_names(load.name for load in model.loads)

    def of(self, field: Field, frequency: float) -> tuple[Deflection, ...]:
        """A deflection for every load."""
        of_loads = np.moveaxis(field.q, 2, 0)[: len(self.loads)]  # without those at sensors
        return tuple(
            self._deflection(name, load, q, field.residual, frequency)
            for name, load, q in zip(self.names, self.loads, of_loads, strict=True)
        )

    def _deflection(
        self, name: str, load: Place, q: ComplexArray, residual: float, frequency: float
    ) -> Deflection:
        """q: (n_cells, n_own) along r, y and theta, node by node."""
        return Deflection(
            name=name,
            words=load.label,
            frequency=frequency,
            u=q.reshape(-1, 3).copy(),
            residual=residual,
            mesh=self.mesh,
            provenance=self.provenance,
            load=load,
        )
