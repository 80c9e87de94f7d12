"""Superposed modes: what they lack, and what is right however few they are.

With all modes of a ring they span its equations, so `modal` is exact (tests/solvers/
test_every_solver.py); with some it is their best answer. With per-mode loss it is

    q = sum over r of phi_r phi_r^T f / (omega_r^2 (1 + i eta_r) - omega^2),
    eta_r = sum over materials of eta_m phi_r^T K_m phi_r / phi_r^T K phi_r

(Clough and Penzien, Dynamics of Structures, 1993, chapter 12; Ungar and Kerwin, J. Acoust. Soc.
Am. 34 (1962), 954-957), here from the referee's matrices and a dense eigensolver.
"""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rings import (
    THETA,
    R,
    Y,
    lopsided,
    lossless,
    omegas,
    ring_frequencies,
    section_error,
    tyre,
)
from scipy.linalg import eigh
from small import case_with

from tyrefrf.case import (
    Cord,
    Damping,
    FractionalZener,
    Isotropic,
    Ply,
    Solver,
    Viscoelastic,
    load_case,
)
from tyrefrf.errors import SingularError, SolveError
from tyrefrf.fem.assembly import Pattern, at_rest, dofs_of
from tyrefrf.fem.constitutive import constitutive
from tyrefrf.fem.frames import rotations
from tyrefrf.solvers import Cyclic, solve_line
from tyrefrf.solvers.modal import Modal
from tyrefrf.solvers.modal import at_rest as at_rest_of
from tyrefrf.solvers.modes import lowest, ring_modes
from tyrefrf.study.model import build_model

ROUND_OFF = 1e-9  # of a section's displacement
SOFT = 1e-8  # the same with rubber 100 times softer than what it is bonded to, reduced bricks
LINES = omegas(0.0, 230.0, 1700.0)
ALL = 10_000_000
LAYERED = Path(__file__).parents[2] / "cases" / "paper" / "layered.toml"


def superposed(problem, modes=ALL, **keys):
    return Modal.prepare(problem, Solver(name="modal", modes=modes, **keys))


def mottled(n_cells: int = 7):
    """Two materials whose loss factors are five times apart, brick by brick at random."""
    return lopsided(tyre(n_cells=n_cells, elements_along=4, elements_around=2))


def loads(ring):
    return ring.point_loads((0, 3, R), (ring.n_cells // 2, 5, THETA), (0, ring.mesh.n_own - 3, Y))


def per_mode_loss(ring, omega, n_modes=None):
    """The sum above over the lowest modes of the referee's ring, in (r, y, theta)."""
    referee = ring.cartesian
    free = referee.free
    K, C, M = (A[free][:, free].toarray() for A in (referee.K, referee.C, referee.M))
    squared, phi = eigh(K.real, M)
    loss, viscous = (np.einsum("ar,ab,br->r", phi, A, phi, optimize=True) for A in (K.imag, C))
    f = (referee.to_cartesian @ loads(ring).toarray())[free]
    kept = slice(0, n_modes)
    stiffness = (squared + 1j * loss + 1j * omega * viscous - omega**2)[kept, None]
    q = np.zeros((ring.n_dofs, f.shape[1]), complex)
    q[free] = phi[:, kept] @ (phi[:, kept].T @ f / stiffness)
    return (referee.to_cartesian.T @ q).reshape(*referee.shape, -1)


@pytest.mark.parametrize("omega", LINES)
@pytest.mark.parametrize("n_cells", [3, 6])
def test_per_mode_loss_is_the_materials_strain_energy(n_cells, omega):
    ring = mottled(n_cells)

    field = superposed(ring.problem(loads(ring)), damping="modal").field(omega)

    assert section_error(field.q, per_mode_loss(ring, omega), ring.cell.n_face) < ROUND_OFF


@pytest.mark.parametrize("omega", LINES)
def test_one_loss_factor_everywhere_couples_no_modes(omega):
    ring = tyre(n_cells=7, elements_along=4, elements_around=2)
    problem = ring.problem(loads(ring))

    full, modal = (superposed(problem, 60, damping=d).field(omega).q for d in ("full", "modal"))

    assert section_error(modal, full, ring.cell.n_face) < ROUND_OFF


@pytest.mark.parametrize("omega", LINES)
def test_several_loss_factors_couple_modes(omega):
    """All modes: the full projection is exact, and the diagonal alone is not."""
    ring = mottled()
    problem = ring.problem(loads(ring))
    expected = Cyclic(problem).field(omega).q

    full, modal = (superposed(problem, damping=d).field(omega).q for d in ("full", "modal"))

    assert section_error(full, expected, ring.cell.n_face) < ROUND_OFF
    assert section_error(modal, expected, ring.cell.n_face) > 1e-3


@pytest.mark.parametrize("omega", LINES)
def test_a_truncated_sum_is_that_over_the_lowest_modes_of_the_ring(omega):
    """With both members of a pair; 16 of this ring split none."""
    ring = mottled()

    field = superposed(ring.problem(loads(ring)), 16, damping="modal").field(omega)

    expected = per_mode_loss(ring, omega, 16)
    assert section_error(field.q, expected, ring.cell.n_face) < ROUND_OFF


@pytest.mark.parametrize("damping", ["full", "modal"])
@pytest.mark.parametrize("modes", [1, 12, 150])
def test_the_static_correction_is_exact_at_0_hz(modes, damping):
    ring = mottled()
    problem = ring.problem(loads(ring))

    field = superposed(problem, modes, damping=damping, static_correction=True).field(0.0)

    assert section_error(field.q, Cyclic(problem).field(0.0).q, ring.cell.n_face) < 1e-12
    assert field.residual < 1e-11


@pytest.mark.parametrize("static_correction", [False, True])
@pytest.mark.parametrize("modes", [5, 60])
def test_truncated_answers_stay_reciprocal(modes, static_correction):
    ring = mottled()
    problem = ring.problem(loads(ring))
    solver = superposed(problem, modes, static_correction=static_correction)

    for omega in LINES:
        H = solve_line(problem, solver, omega).receptance
        drive = np.sqrt(np.abs(np.outer(np.diag(H), np.diag(H))))
        assert np.all(np.abs(H - H.T) < 1e-10 * drive)


@pytest.mark.parametrize("damping", ["full", "modal"])
@pytest.mark.parametrize("modes", [5, 60])
def test_truncated_answers_stay_passive(modes, damping):
    ring = mottled()
    problem = ring.problem(loads(ring))
    solver = superposed(problem, modes, damping=damping)

    H = np.array([np.diag(solve_line(problem, solver, w).receptance) for w in LINES])

    assert np.all(H.imag <= 1e-10 * np.abs(H))


def test_the_residual_of_a_truncated_sum_is_reported_and_not_judged():
    ring = mottled()
    problem = ring.problem(loads(ring))
    solver = superposed(problem, 20)

    line = solve_line(problem, solver, LINES[1])

    assert not solver.exact
    assert 0.1 < line.residual < 10.0


ZENER = FractionalZener(kind="zener", E_0=6e6, E_inf=1e9, tau=1e-6, alpha=0.5)
PLY = Ply(
    kind="ply",
    cord=Cord(E=2e9, nu=0.3, rho=1400.0),
    rubber=Viscoelastic(nu=0.48, rho=1100.0, modulus=ZENER),
    volume_fraction=0.3,
    angles=(20.0,),
)


def half_relaxing(stuff, element="hex8i"):
    """Bricks of this stuff and of a lossy steel-like one in turn."""
    ring = tyre(element, 5, 4)
    halves = np.arange(len(ring.mesh.bricks)) % 2
    stiff = Isotropic(E=4e8, nu=0.3, rho=1500.0, eta=0.03)
    return replace(
        ring,
        mesh=replace(ring.mesh, material=halves, materials=("soft", "stiff")),
        materials={"soft": stuff, "stiff": stiff},
    )


@pytest.mark.parametrize("static_correction", [False, True])
@pytest.mark.parametrize(
    "stuff", [Isotropic(nu=0.48, rho=1100.0, modulus=ZENER), PLY], ids=["rubber", "ply"]
)
@pytest.mark.parametrize("element", ["hex8i", "hex20r"])
def test_moduli_are_the_lines_own(element, stuff, static_correction):
    """The modes are made with the moduli of 1 kHz; all of them span every other line as well."""
    ring = half_relaxing(stuff, element)
    problem = ring.problem(loads(ring))
    solver = superposed(problem, static_correction=static_correction)

    errors = [
        section_error(solver.field(w).q, Cyclic(problem).field(w).q, ring.cell.n_face)
        for w in LINES
    ]

    assert max(errors) < SOFT


@pytest.mark.parametrize("stuff", [Isotropic(nu=0.48, rho=1100.0, modulus=ZENER), PLY])
def test_the_static_correction_is_exact_at_0_hz_where_moduli_relax(stuff):
    ring = half_relaxing(stuff)
    problem = ring.problem(loads(ring))
    q = superposed(problem, 12, static_correction=True).field(0.0).q
    assert section_error(q, Cyclic(problem).field(0.0).q, ring.cell.n_face) < 1e-10


def test_the_correction_is_of_second_order_in_how_far_the_moduli_have_relaxed():
    """E(omega) - E(0) grows as the root of omega here, so the error grows as omega."""
    ring = half_relaxing(Isotropic(nu=0.48, rho=1100.0, modulus=ZENER))
    problem = ring.problem(loads(ring))
    solver = superposed(problem, 12, static_correction=True)

    e = [
        section_error(solver.field(w).q, Cyclic(problem).field(w).q, ring.cell.n_face)
        for w in omegas(0.01, 0.02)
    ]

    assert np.log2(e[1] / e[0]) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("damping", ["full", "modal"])
def test_a_stiffness_put_together_line_by_line_is_the_same_stiffness(damping):
    ring = mottled()
    mesh, dofs = ring.mesh, dofs_of(ring.mesh.bricks)
    X, T = mesh.cartesian[mesh.bricks], rotations(mesh.points[mesh.bricks, 2])
    pattern = Pattern.of(dofs, 3 * mesh.n_nodes)
    relaxation = {}
    for index, name in enumerate(mesh.materials):
        here, stuff = mesh.material == index, constitutive(ring.materials[name])
        slots = pattern.slots(dofs[here])
        relaxation[name] = at_rest(stuff, ring.element, X[here], T[here], slots)
    scaled = ring.problem(loads(ring))
    anew = replace(scaled, cell=replace(ring.cell, relaxation=relaxation))

    q, q_anew = (superposed(p, 40, damping=damping).field(LINES[1]).q for p in (scaled, anew))

    assert section_error(q_anew, q, ring.cell.n_face) < ROUND_OFF


def test_all_modes_about_an_inflated_state_are_exact():
    table = '[inflation]\npressure = "1 bar"\n\n[cell]'
    problem = build_model(case_with(("[cell]", table))).problem
    solver = superposed(problem)

    q, expected = (s.field(LINES[1]).q for s in (solver, Cyclic(problem)))

    assert section_error(q, expected, problem.cell.n_face) < ROUND_OFF


def test_a_cutoff_below_all_modes_is_an_error():
    ring = mottled()
    with pytest.raises(SolveError, match="cut-off of 20 Hz"):
        superposed(ring.problem(loads(ring)), None, cutoff=20.0)


@pytest.mark.parametrize(
    ("modes", "remark"), [(16, "above the last mode superposed, at 435.896 Hz"), (ALL, "")]
)
def test_a_line_above_the_last_mode_says_so(modes, remark):
    ring = mottled()
    solver = superposed(ring.problem(loads(ring)), modes)

    below, above = (solver.field(omega).remark for omega in omegas(430.0, 1e6))

    assert below == ""
    assert above == remark


@pytest.mark.parametrize("hertz", [250.0, 900.0])
def test_the_cutoff_keeps_all_modes_below_it(hertz):
    ring = mottled()
    count = np.sum(ring_frequencies(ring) < 2.0 * np.pi * hertz)

    field = superposed(ring.problem(loads(ring)), None, cutoff=hertz, damping="modal").field(9.0)

    assert section_error(field.q, per_mode_loss(ring, 9.0, count), ring.cell.n_face) < ROUND_OFF


def test_the_papers_1000_modes_are_the_default():
    ring = tyre(elements_along=8)
    problem = ring.problem(loads(ring))

    default, thousand, fewer = (superposed(problem, n).field(LINES[1]).q for n in (None, 1000, 990))

    np.testing.assert_array_equal(default, thousand)
    assert np.any(fewer != thousand)


@pytest.mark.parametrize("static_correction", [False, True])
def test_workers_get_the_modes_as_they_are(static_correction):
    ring = mottled()
    solver = superposed(ring.problem(loads(ring)), 40, static_correction=static_correction)

    sent = pickle.loads(pickle.dumps(solver))

    np.testing.assert_array_equal(sent.field(LINES[1]).q, solver.field(LINES[1]).q)


@pytest.mark.parametrize("damping", ["full", "modal"])
@pytest.mark.parametrize("mode", [0, 1, 7, 30])
def test_resonance_of_the_undamped_ring_is_an_error_that_names_it(mode, damping):
    ring = lossless(tyre(n_cells=7, elements_along=4))
    problem = ring.problem(loads(ring))
    omega = ring_frequencies(ring)[mode]
    solver = superposed(problem, 60, damping=damping)

    with pytest.raises(SolveError, match=rf"^{omega / 2 / np.pi:.6g} Hz: .*add a loss factor"):
        solve_line(problem, solver, omega)
    beside = solve_line(problem, solver, omega * (1.0 + 1e-6))
    assert np.abs(beside.receptance).max() < 1e6


@pytest.mark.parametrize("element", ["hex8i", "hex20"])
def test_free_tyre_at_0_hz_is_an_error_that_names_it(element):
    ring = tyre(element, n_cells=12, elements_along=4).with_free_rim()
    problem = ring.problem(loads(ring))

    with pytest.raises(SolveError, match=r"^0 Hz: .*fix the rim"):
        solve_line(problem, superposed(problem, 30), 0.0)
    with pytest.raises(SolveError, match=r"static_correction .*fix the rim"):
        superposed(problem, 30, static_correction=True)


def test_a_stiffness_of_nothing_leaves_no_answer_at_0_hz_to_correct_with():
    ring = tyre(n_cells=12, elements_along=4)
    nothing = {name: 0.0 * K for name, K in ring.cell.K.items()}
    problem = replace(ring.problem(loads(ring)), cell=replace(ring.cell, K=nothing))
    with pytest.raises(SingularError, match=r"there is none \(.*exactly singular"):
        at_rest_of(problem)


@pytest.mark.parametrize("omega", omegas(0.5, 300.0))
def test_all_modes_of_a_free_tyre_hold_its_rigid_motions(omega):
    ring = tyre(n_cells=12, elements_along=4).with_free_rim()
    problem = ring.problem(loads(ring))

    q, expected = (s.field(omega).q for s in (superposed(problem), Cyclic(problem)))

    assert section_error(q, expected, ring.cell.n_face) < 1e-7  # at 0.5 Hz: 1e-16 (1 kHz / f)^2


COUNTS = [250, 500, 1000, 2000, 4000]


@pytest.fixture(scope="module")
def paper():
    """The paper's homogeneous tyre, driven at mid-tread: a problem, and all its modes."""
    ring = tyre()
    problem = ring.problem(ring.point_loads((0, 29, R)))
    return problem, ring_modes(problem.cell, problem.n_cells, count=ALL)


def errors(paper, omega, static_correction):
    """(n_counts, n_cells) error of every section, with so many modes."""
    problem, modes = paper
    expected = Cyclic(problem).field(omega).q
    found = []
    for count in COUNTS:
        solver = Modal(problem, lowest(modes, count), static_correction=static_correction)
        difference = np.linalg.norm(solver.field(omega).q - expected, axis=1)
        found.append((difference / np.linalg.norm(expected, axis=1))[:, 0])
    return np.array(found)


@pytest.mark.parametrize("static_correction", [False, True])
@pytest.mark.parametrize("omega", omegas(50.0, 150.0, 400.0))
def test_more_modes_converge_to_the_other_solvers(paper, omega, static_correction):
    """At the section that is driven and at the opposite one, in every doubling of the number."""
    driven, opposite = errors(paper, omega, static_correction)[:, [0, 22]].T

    assert np.all(driven[1:] < 0.7 * driven[:-1])
    assert np.all(opposite[1:] < 0.7 * opposite[:-1])


@pytest.mark.parametrize("omega", omegas(50.0, 150.0, 400.0))
def test_a_driving_point_needs_more_modes_or_the_correction(paper, omega):
    """The correction leaves what is of second order in (omega/omega_last)^2."""
    last = [max(m.omega[-1] for m in lowest(paper[1], n) if len(m.omega)) for n in COUNTS]

    plain, corrected = (errors(paper, omega, how)[:, 0] for how in (False, True))

    assert plain[2] > 0.01  # with the paper's 1000
    assert np.all(corrected < (omega / np.array(last)) ** 4 * plain)


@pytest.mark.parametrize("slack", [0.0, 0.9])
@pytest.mark.parametrize("damping", ["full", "modal"])
def test_the_correction_is_of_second_order_in_what_changes(damping, slack):
    """Here a viscous damping that is not small: its forces grow as omega does.

    slack: of the lowest mode's stiffness, taken away by K_G.
    """
    ring = replace(mottled(), damping=Damping(alpha=3.0, beta=1e-4))
    problem = ring.problem(loads(ring))
    softest = min(w for m in ring_modes(ring.cell, ring.n_cells, count=1) for w in m.omega)
    slackened = replace(ring.cell, K_G=-slack * softest**2 * ring.cell.M)
    problem = replace(problem, cell=slackened)
    solver = superposed(problem, 60, damping=damping, static_correction=True)

    e = [
        section_error(solver.field(w).q, Cyclic(problem).field(w).q, ring.cell.n_face)
        for w in omegas(1.0, 2.0)
    ]

    assert np.log2(e[1] / e[0]) == pytest.approx(2.0, abs=0.1)


def test_forces_on_the_rim_need_the_correction_where_loss_factors_differ():
    """Steel without loss in the bead, between rubber with eta = 0.1 and the rim."""
    problem = build_model(load_case(LAYERED)).problem
    omega = omegas(100.0)[0]

    exact, plain, corrected = (
        solve_line(problem, solver, omega).receptance[-6:]
        for solver in (
            Cyclic(problem),
            superposed(problem, 600),
            superposed(problem, 600, static_correction=True),
        )
    )

    size = np.linalg.norm(exact, axis=0)
    assert np.all(np.linalg.norm(plain - exact, axis=0) > 0.01 * size)
    assert np.all(np.linalg.norm(corrected - exact, axis=0) < 1e-4 * size)
