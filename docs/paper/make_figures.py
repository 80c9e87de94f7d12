"""Compute every figure of the paper's section 3 from `cases/paper/` and write the page beside this.

    python docs/paper/make_figures.py

Writes the figures and README.md here; the numbers in the page are computed, never typed. Uses the
`cyclic` solver, which gives the digits of `recursive` (both are compared below) in less time.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.case import Case, build_case, load_case, resolved
from tyrefrf.plots import draw_plots
from tyrefrf.results import Results, SweepResults
from tyrefrf.solvers import SOLVERS
from tyrefrf.study.model import build_model
from tyrefrf.study.run import run_case
from tyrefrf.study.sweep import sweep

HERE = Path(__file__).parent
CASES = HERE.parents[1] / "cases" / "paper"
LINES = np.linspace(5.0, 2000.0, 5)  # Hz, at which solvers are compared


def main() -> None:
    """Make everything."""
    parts = [figure_5(), figure_6(), figure_7(), figure_8(), figure_9(), figure_10(), cells()]
    page = HERE / "README.md"
    page.write_text("\n\n".join([HEAD, *parts]) + "\n", encoding="utf-8")
    print(page)


HEAD = """\
# The paper's figures

Duhamel, Erlicher and Nguyen (2011), section 3, from the cases in `cases/paper/`. The paper's
figures themselves are lost; what stands beside each of ours is what its text says. The page is
made by `python docs/paper/make_figures.py`, numbers included."""


def case_of(number: int, **changes: object) -> Case:
    """A figure's case, every line solved by `cyclic`, with other keys of its tables."""
    data = resolved(load_case(CASES / f"figure{number:02d}.toml"))
    data["solver"] = {"name": "cyclic"}
    data["frequency"]["adaptive"] = False
    for table, values in changes.items():
        data[table] = {**data.get(table, {}), **values}  # type: ignore[dict-item]
    return build_case(data, data["name"])


def keep(found: Results | SweepResults, wanted: dict[str, str]) -> None:
    """Draw everything, and keep the figures wanted under the names given to them."""
    scratch = HERE / "scratch"
    drawn = {path.stem: path for path in draw_plots(found, scratch)}
    for stem, name in wanted.items():
        drawn[stem].replace(HERE / f"{name}.png")
    shutil.rmtree(scratch)


def decibels(Y: ComplexArray) -> FloatArray:
    """Levels of mobilities [dB re 1 m/(s N)]; the line at 0 Hz is left out by callers."""
    return 20.0 * np.log10(np.abs(Y))


def level(results: Results, probe: str, low: float, high: float, load: str = "radial") -> float:
    """Mean level [dB] of a mobility over the lines in a band."""
    band = (results.frequency >= low) & (results.frequency <= high) & (results.frequency > 0)
    return float(decibels(results.response(load, probe)[band]).mean())


def first_peak(results: Results, load: str = "radial") -> tuple[float, float]:
    """Frequency [Hz] and magnitude of the driving point's first resonance, by a parabola."""
    f, Y = results.frequency, decibels(results.driving_point(load)[1:])
    k = int(np.flatnonzero((Y[1:-1] > Y[:-2]) & (Y[1:-1] >= Y[2:]))[0]) + 1
    curve = np.polynomial.Polynomial.fit(f[k : k + 3], Y[k - 1 : k + 2], 2)
    top = float(curve.deriv().roots()[0].real)
    return top, float(10.0 ** (curve(top) / 20.0))


def against_direct(case: Case) -> dict[str, float]:
    """Largest difference of the other solvers to `direct`, at every section (design's measure)."""
    problem = build_model(case).problem
    worst = {"recursive": 0.0, "cyclic": 0.0}
    solvers = {name: build(problem) for name, build in SOLVERS.items()}
    for omega in 2.0 * np.pi * LINES:
        q = solvers["direct"].field(omega).q
        for name in worst:
            difference = np.linalg.norm(solvers[name].field(omega).q - q, axis=1)
            worst[name] = max(worst[name], float((difference / np.linalg.norm(q, axis=1)).max()))
    return worst


def section(number: int, title: str, figures: list[str], says: str, ours: str) -> str:
    """One part of the page."""
    pictures = "\n\n".join(f"![{name}]({name}.png)" for name in figures)
    return f"## Figure {number}: {title}\n\n{pictures}\n\n**The paper:** {says}\n\n**Ours:** {ours}"


def figure_5() -> str:
    """Point mobilities of the homogeneous tyre."""
    case = case_of(5)
    results = run_case(case)
    keep(results, _mobilities("figure05"))
    radial, tangential = (first_peak(results, load) for load in ("radial", "tangential"))
    error = against_direct(case)
    return section(
        5,
        "homogeneous tyre, point mobilities at the force",
        ["figure05_radial", "figure05_tangential"],
        "the periodic model and the full three-dimensional one are very close; the largest "
        "relative error is of order 4e-6.",
        f"the recursion and the assembled ring differ by at most {error['recursive']:.0e} at any "
        f"section ({len(LINES)} lines, 5-2000 Hz), `cyclic` by {error['cyclic']:.0e}. First "
        f"resonances at {radial[0]:.0f} Hz (radial) and {tangential[0]:.0f} Hz (tangential); "
        f"mean radial level {level(results, 'radial.drive', 1000, 2000):.1f} dB re 1 m/(s N) in "
        "1-2 kHz.",
    )


def _mobilities(figure: str) -> dict[str, str]:
    """Names of the mobility plots of both loads."""
    return {f"mobility_{load}": f"{figure}_{load}" for load in ("radial", "tangential")}


def figure_6() -> str:
    """Influence of the angle of the cell."""
    study = sweep(case_of(6), {"sector_angle": None})
    names = {
        "mobility_radial_point_5_r": "figure06_radial",
        "mobility_tangential_point_5_theta": "figure06_tangential",
    }
    keep(study, names)
    finest, *coarser = study.points
    rows = ["| cell | " + " | ".join(f"{a}, {b}" for a, b in _FIGURE_6) + " |"]
    rows.append("|---" * (len(_FIGURE_6) + 1) + "|")
    for label, point in zip(study.labels[1:], coarser, strict=True):
        cells = [_deviation(point, finest, *column) for column in _FIGURE_6]
        rows.append(f"| {label} | " + " | ".join(f"{d:.2f} dB" for d in cells) + " |")
    return section(
        6,
        "angle of the cell, response at point 5",
        sorted(names.values()),
        "the influence of the angle is important only for high frequencies, and higher for the "
        "radial component than for the tangential part.",
        "mean absolute difference to the finest cell of 0.5 degrees:\n\n" + "\n".join(rows),
    )


_BANDS = {"20-300 Hz": (20.0, 300.0), "300-1000 Hz": (300.0, 1000.0), "1-2 kHz": (1e3, 2e3)}
_PARTS = {"radial": ("radial", "point 5 r"), "tangential": ("tangential", "point 5 theta")}
_FIGURE_6 = [(part, band) for part in _PARTS for band in _BANDS]


def _deviation(point: Results, finest: Results, part: str, band: str) -> float:
    """Mean absolute difference of levels [dB] in a band."""
    low, high = _BANDS[band]
    lines = (point.frequency >= low) & (point.frequency <= high)
    Y = [results.response(*_PARTS[part])[lines] for results in (point, finest)]
    return float(abs(decibels(Y[0]) - decibels(Y[1])).mean())


def figure_7() -> str:
    """The layered tyre at rest, along the section."""
    case = case_of(7)
    results = run_case(case)
    keep(results, {"mobility_radial": "figure07", "section": "figure03_section"})
    error = against_direct(case)
    bands = {"20-60 Hz": (20.0, 60.0), "60-300 Hz": (60.0, 300.0), "1-2 kHz": (1e3, 2e3)}
    rows = ["| lines | points 1-3, on the tread | points 1-5 | force over point 1 |"]
    rows.append("|---|---|---|---|")
    for name, band in bands.items():
        tread, every = (_spread(results, n, *band) for n in (3, 5))
        over = level(results, "radial.drive", *band) - level(results, "point 1", *band)
        rows.append(f"| {name} | {tread:.1f} dB | {every:.1f} dB | {over:.1f} dB |")
    return section(
        7,
        "layered tyre at rest, along the section",
        ["figure03_section", "figure07"],
        "the responses are close for low frequencies except at the position of the force; the "
        "differences increase with the frequency.",
        "spread of the levels, largest less smallest at each line, and how far the force's own "
        "mobility stands above the nearest point's:\n\n" + "\n".join(rows) + "\n\nThe force's "
        "position stands out, more and more with frequency, as the paper says. Where its points "
        "stand is not known; ours on the sidewall (4 and 5, along the axle) are not close to those "
        "on the tread even at low frequency. Recursion and assembled ring differ by "
        f"{error['recursive']:.0e} at most.",
    )


def _spread(results: Results, n_points: int, low: float, high: float) -> float:
    """Mean over a band's lines of the largest less the smallest level of points 1 to n [dB]."""
    band = (results.frequency >= low) & (results.frequency <= high)
    levels = [
        decibels(results.response("radial", f"point {k}")[band]) for k in range(1, n_points + 1)
    ]
    return float((np.max(levels, axis=0) - np.min(levels, axis=0)).mean())


def figure_8() -> str:
    """The layered tyre under 2 bar, and what the paper leaves out."""
    case = case_of(8)
    results = run_case(case)
    keep(results, {"mobility_radial": "figure08"})
    error = against_direct(case)
    states = {
        "at rest": case_of(8, inflation={"pressure": 0.0}),
        "K_G alone (the paper's)": case,
        "K_G and K_P": case_of(8, inflation={"pressure_stiffness": True}),
        "hex20r: at rest": case_of(8, inflation={"pressure": 0.0}, cell={"element": "hex20r"}),
        "hex20r: linear, K_G and K_P": case_of(
            8, inflation={"pressure_stiffness": True}, cell={"element": "hex20r"}
        ),
        "hex20r: nonlinear, K_G and K_P": case_of(
            8,
            inflation={"pressure_stiffness": True, "kind": "nonlinear"},
            cell={"element": "hex20r"},
        ),
    }
    rows = ["| state | first radial resonance | mean level 20-500 Hz |", "|---|---|---|"]
    for name, state in states.items():
        data = resolved(state)
        data["frequency"] = {"start": 0.0, "stop": 500.0, "step": 2.5}
        found = run_case(build_case(data, "state"))
        mean = level(found, "radial.drive", 20, 500)
        rows.append(f"| {name} | {first_peak(found)[0]:.1f} Hz | {mean:.2f} dB |")
    return section(
        8,
        "layered tyre, 2 bar",
        ["figure08"],
        "perfect agreement with the modal synthesis, up to 800 Hz, the limit of the latter.",
        f"recursion and assembled ring differ by {error['recursive']:.0e} at most, 5-2000 Hz. What "
        "the paper leaves out, at the force:\n\n" + "\n".join(rows),
    )


def figure_9() -> str:
    """Influence of the modulus of the rubber."""
    study = sweep(case_of(9), {"E_rubber": None})
    keep(study, {"mobility_radial_drive": "figure09"})
    rows = ["| modulus | mean level 20-2000 Hz | first resonance |", "|---|---|---|"]
    for label, point in zip(study.labels, study.points, strict=True):
        mean = level(point, "radial.drive", 20, 2000)
        rows.append(f"| {label} | {mean:.2f} dB | {first_peak(point)[0]:.1f} Hz |")
    return section(
        9,
        "modulus of the rubber",
        ["figure09"],
        "as expected, the mobilities decrease with the value of the rubber modulus.",
        "\n\n" + "\n".join(rows) + "\n\nThe mobility falls as the modulus grows.",
    )


def figure_10() -> str:
    """Influence of the internal pressure."""
    study = sweep(case_of(10), {"pressure": None})
    keep(study, {"mobility_radial_drive": "figure10"})
    rows = ["| pressure | first resonance | mean level 20-500 Hz | 1-3 kHz |", "|---|---|---|---|"]
    for label, point in zip(study.labels, study.points, strict=True):
        low, high = (level(point, "radial.drive", *b) for b in ((20, 500), (1000, 3000)))
        rows.append(f"| {label} | {first_peak(point)[0]:.1f} Hz | {low:.2f} dB | {high:.2f} dB |")
    return section(
        10,
        "internal pressure",
        ["figure10"],
        "changing the pressure mainly shifts the resonance frequencies, from the increase in "
        "rigidity as the pressure increases.",
        "\n\n" + "\n".join(rows),
    )


def cells() -> str:
    """What the paper's own discretisation costs at high frequency."""
    case = case_of(7)
    variants = {"hex8i, 6 degrees (the paper's)": case}
    for angle in (3.0, 1.5, 0.75):
        variants[f"hex8i, {angle:g} degrees"] = case_of(7, cell={"sector_angle": angle})
    variants["hex20r, 3 degrees"] = case_of(7, cell={"sector_angle": 3.0, "element": "hex20r"})
    band = ((20, 300), (300, 1000), (1000, 2000))
    rows = ["| cells | " + " | ".join(f"{a}-{b} Hz" for a, b in band) + " |", "|---|---|---|---|"]
    for name, variant in variants.items():
        data = resolved(variant)
        data["frequency"] = {"start": 20.0, "stop": 2000.0, "step": 20.0}
        found = run_case(build_case(data, "cells"))
        levels = [level(found, "point 1", a, b) for a, b in band]
        rows.append(f"| {name} | " + " | ".join(f"{x:.2f} dB" for x in levels) + " |")
    return (
        "## How coarse the paper's cells are\n\nAt 2 kHz the rubber has 1.3 bricks of 6 degrees to "
        "its shortest wave, where 6 are recommended (`tyrefrf check cases/paper/figure07.toml`). "
        "Mean radial mobility at point 1, away from the force, whose own mobility at a node never "
        "converges:\n\n" + "\n".join(rows)
    )


if __name__ == "__main__":
    main()
