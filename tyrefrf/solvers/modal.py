"""The whole ring's undamped modes, superposed: truncated, unlike the other solvers.

Modes of different circumferential orders h do not couple, in whatever way the tyre is damped, as
its cells are equal. So the superposition is one small dense problem per order, on the modes V
(n, m) of that order:

    (V^H A_h V) y_h = V^H f_h,  x_h = V y_h,

with the complex A_h of the line in question: damping that is not proportional, and moduli that
depend on frequency, couple the modes of an order, and nothing of that is left out.
Source: Clough and Penzien, Dynamics of Structures (1993), chapters 12 and 13.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from tyrefrf.arrays import ComplexArray
from tyrefrf.errors import SingularError, SolveError
from tyrefrf.solvers.cyclic import Cyclic
from tyrefrf.solvers.modes import OrderModes, ring_modes
from tyrefrf.solvers.problem import RESIDUAL_MAX, Field, RingProblem
from tyrefrf.solvers.projection import Exchange, Parts, Projection

if TYPE_CHECKING:
    from tyrefrf import case

DEFAULT_MODES = 1000
"""As many as the paper could afford of its full model."""
MODULI_AT = 2.0 * np.pi * 1000.0
"""Frequency [rad/s] whose storage moduli the modes are made with, where no cut-off says where they
will be used. It matters only where moduli depend on frequency, and there only to which shapes are
superposed: the line's own moduli act on them."""


class Modal:
    """Superposed modes of the whole ring, by order; built once from the modes, then cheap.

    damping: "full" keeps V^H A_h V as it is: the best that these modes can do. "modal" keeps its
    diagonal: one loss per mode, that of the materials' strain energy in it, exact where all of
    the tyre has one loss factor.
    static_correction: what the modes leave out answers as it does at 0 Hz, with the moduli that it
    has there, and to first order to what is different on the line (see `Exchange`). The answer at
    0 Hz is exact then. It needs a tyre that is held.

    Limits. The paper says of modal synthesis in Ansys that more than 1000 modes were not possible,
    as they needed more memory and disk than its computer had (4 GB; 28 GB of results); that it
    agreed with the recursion up to 800 Hz, which was its limit; that it was the faster one at low
    frequencies, and could give nothing above 1000 Hz or for finer meshes. Modes by order need
    little memory, so here there may be more of them. The rest stays: an answer has meaning only
    well below the last mode; and a driving point, to which all modes add in phase, needs many
    more of them than a distant point, or the correction. On the paper's layered tyre at 400 Hz,
    1000 modes (to 1889 Hz) leave an error of 9 % of the driven section's displacement under a
    radial point force (88 % under a tangential one) and of 0.8 % (1.3 %) on the opposite side;
    with the correction 4e-5 (1.4e-4) and 1.5e-5 (3e-5). Forces on the rim need the correction
    where loss factors differ, however many the modes: beside rubber, the steel of the bead lacks
    the small motions that balance what the rubber loses. There 47 % (15 %), with it 4e-5 (2e-4).
    A line's residual is what the modes left out hold of the load, of order one under a point
    force: it does not tell how good the answer is. A line above the last mode says so.
    """

    exact = False

    def __init__(
        self,
        problem: RingProblem,
        modes: Sequence[OrderModes],
        *,
        damping: Literal["full", "modal"] = "full",
        static_correction: bool = False,
    ) -> None:
        self.problem = problem
        self._parts = Parts(problem.cell)
        f = problem.loads.toarray().reshape(problem.n_cells, problem.cell.n_own, -1)
        f_h = np.fft.fft(f[:, problem.free], axis=0)
        self._projections = [
            Projection.of(order, self._parts, f_h, coupled=damping == "full") for order in modes
        ]
        complete = all(len(m.omega) == len(m.shapes) for m in modes)
        self._last = np.inf if complete else max(m.omega[-1] for m in modes if len(m.omega))
        self._correction: ComplexArray | float = 0.0
        if static_correction:
            self._correction = at_rest(problem) - self._superposed(0.0)
            x_h = np.fft.fft(self._correction[:, problem.free], axis=0)
            self._projections = [
                replace(order, exchange=Exchange.of(order, self._parts, x_h))
                for order in self._projections
            ]

    @classmethod
    def prepare(cls, problem: RingProblem, choice: case.Solver) -> Modal:
        """Compute the modes that a case asks for: the work that is done once for all lines.

        Raises SolveError where there are none below the cut-off, and as `ring_modes` does.
        """
        if choice.cutoff is not None:
            below = 2.0 * np.pi * choice.cutoff
            modes = ring_modes(problem.cell, problem.n_cells, below=below, at=below / 2.0)
            if not any(len(order.omega) for order in modes):
                raise SolveError(
                    f"no mode lies below the cut-off of {choice.cutoff:.6g} Hz; raise it"
                )
        else:
            count = choice.modes or DEFAULT_MODES
            modes = ring_modes(problem.cell, problem.n_cells, count=count, at=MODULI_AT)
        return cls(
            problem, modes, damping=choice.damping, static_correction=choice.static_correction
        )

    def field(self, omega: float) -> Field:
        """Superpose one line; omega [rad/s]. Raises SingularError if a mode resonates undamped."""
        D = self.problem.cell.dynamic_stiffness(omega)
        field = Field.checked(self.problem, D, self._superposed(omega) + self._correction)
        if omega <= self._last:
            return field
        hertz = self._last / (2.0 * np.pi)
        return replace(field, remark=f"above the last mode superposed, at {hertz:.6g} Hz")

    def _superposed(self, omega: float) -> ComplexArray:
        """Displacements (n_cells, n_own, n_loads)."""
        problem, N = self.problem, self.problem.n_cells
        c, rest = self._parts.coefficients(omega), self._parts.rest(omega)
        x_h = np.zeros((N, self._parts.orders.n, problem.n_loads), complex)
        for order in self._projections:  # 0 and N/2 are their own opposites: written twice, equal
            A_rest = None if rest is None else self._parts.at(rest, order.mu)
            x_h[order.h], x_h[-order.h] = order.answers(omega, c, A_rest)
        q = np.zeros((N, problem.cell.n_own, problem.n_loads), complex)
        q[:, problem.free] = np.fft.ifft(x_h, axis=0)
        return q


def at_rest(problem: RingProblem) -> ComplexArray:
    """Displacements (n_cells, n_own, n_loads) at 0 Hz, all modes included.

    Raises SingularError for a tyre that nothing holds.
    """
    try:
        field = Cyclic(problem).field(0.0)
        if field.residual <= RESIDUAL_MAX:
            return field.q
        why = f"residual {field.residual:.0e}"
    except SingularError as error:
        why = str(error)
    raise SingularError(
        f"static_correction needs the answer at 0 Hz, and there is none ({why}); fix the rim, or "
        "leave the correction out"
    )
