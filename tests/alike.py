"""Small tyres of every kind, and their lines to the bit."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from small import case_with, text_with

from tyrefrf.case import Solver
from tyrefrf.solvers import Line, Maker, RingProblem, answer, prepare
from tyrefrf.study.model import build_model

LAYERS = """\
elements_along = 12
elements_through = 2
material = "rubber"
[geometry.tread]
material = "rubber"
[geometry.belt]
material = "belt"
[materials.belt]
E = "170 GPa"
nu = 0.3
rho = 5000
"""
RUBBER = 'E = "80 MPa"\nnu = 0.42\nrho = 1200.0\neta = 0.1\n'
ZENER = '{ kind = "zener", E_0 = 30e6, E_inf = 3e9, alpha = 0.6, tau = 1e-6 }'
TYRES = {
    "damped": (),
    "undamped": (("eta = 0.1", "eta = 0.0"),),
    "viscoelastic": ((RUBBER, f"nu = 0.42\nrho = 1200.0\nmodulus = {ZENER}\n"),),
    "layered": (('elements_along = 8\nmaterial = "rubber"\n', LAYERS),),
    "inflated": (
        ('element = "hex8i"', 'element = "hex20r"'),
        ("[cell]", '[inflation]\npressure = "1 bar"\nkind = "nonlinear"\n[cell]'),
    ),
    "with a sensor": (('name = "sidewall"\n', 'name = "sidewall"\nsensor_mass = "5 g"\n'),),
    "beside the middle": (('name = "radial"\ns = 0.5', 'name = "radial"\ns = 0.37\nangle = 7.0'),),
}
"""Changes to the text of the small tyre."""

SOLVERS = {
    name: Solver.model_validate({"name": name, **options})
    for name, options in [
        ("recursive", {}),
        ("cyclic", {}),
        ("direct", {"library": "superlu"}),
        ("modal", {"modes": 60}),
    ]
}

HERTZ = np.array([420.0, 0.0, 1001.0, 40.0, 1000.0, 150.0, 77.0, 610.0])


def problem_of(name: str) -> RingProblem:
    """The problem of one of `TYRES`."""
    return build_model(case_with(*TYRES[name])).problem


def text_of(name: str, *changes: tuple[str, str]) -> str:
    """The case of one of `TYRES` as text, with more changes after its own."""
    text = text_with(*TYRES[name])
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


def maker_of(problem: RingProblem, solver: str) -> Maker:
    """What makes a solver that nobody has asked anything."""
    return prepare(problem, SOLVERS[solver])


def bits(line: Line) -> tuple[bytes, bytes, str]:
    """All that a line says, to be compared to the bit; NaN is NaN."""
    return line.receptance.tobytes(), np.float64(line.residual).tobytes(), line.remark


def solved(problem: RingProblem, make: Maker, hertz: Sequence[float]) -> dict[float, tuple]:
    """Lines one after the other by one solver, by their frequency."""
    solver = make()
    return {f: bits(answer(problem, solver, 2.0 * np.pi * f)) for f in hertz}


def solving(problem: RingProblem, make: Maker) -> Callable[[Sequence[float]], dict[float, tuple]]:
    """The same for a process of its own, which keeps its solver."""
    solver = make()
    return lambda hertz: solved(problem, lambda: solver, hertz)
