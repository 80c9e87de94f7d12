"""Compute what the paper's cells and its inflation leave out, and write the page beside this.

    python docs/validation/make_discretisation.py

Takes minutes, most of them for quadratic bricks; the numbers in the page are computed, never typed.
"""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "figures"))

from measures import case_of, first_peak, level  # noqa: E402  found by the line above

from tyrefrf.case import Case  # noqa: E402
from tyrefrf.results import Results  # noqa: E402
from tyrefrf.study.local import cores  # noqa: E402
from tyrefrf.study.run import run_case  # noqa: E402

BANDS = ((20, 300), (300, 1000), (1000, 2000))  # Hz
FOLLOWING = {"pressure_stiffness": True}

HEAD = """\
# How coarse the paper's cells are, and what its inflation leaves out

Made by `python docs/validation/make_discretisation.py`, numbers included.

## Finer cells and elements

At 2 kHz the rubber has 1.3 bricks of 6 degrees to its shortest wave, where 6 are recommended
(`tyrefrf check` of the paper's layered tyre says so). Mean radial mobility at point 1 of figure 7,
away from the force, whose own mobility at a node never converges:
"""

STATES = """\
## Pressure

The paper adds $K_G$ alone, on the shape at rest. At the force of its figure 8, under 2 bar, with
its bricks and with quadratic ones:
"""


def main() -> None:
    """Make the page."""
    page = HERE / "discretisation.md"
    parts = [HEAD, cells(), STATES, states()]
    page.write_text("\n".join(parts), encoding="utf-8")
    print(page)


def cells() -> str:
    """Levels at a point by cells of all sizes."""
    variants = {
        "hex8i, 6 degrees (the paper's)": {},
        "hex8i, 3 degrees": {"sector_angle": 3.0},
        "hex8i, 1.5 degrees": {"sector_angle": 1.5},
        "hex8i, 0.75 degrees": {"sector_angle": 0.75},
        "hex20r, 3 degrees": {"sector_angle": 3.0, "element": "hex20r"},
    }
    rows = []
    for name, cell in variants.items():
        found = solved(case_of(7, cell=cell, frequency={"start": 20.0, "step": 20.0}))
        rows.append([name, *(f"{level(found, 'point 1', *band):.2f} dB" for band in BANDS)])
    return table(["cells", *(f"{low}-{high} Hz" for low, high in BANDS)], rows)


def states() -> str:
    """First resonance and level of every state under pressure."""
    nonlinear = {"kind": "nonlinear", **FOLLOWING}
    variants = {
        "at rest": ("hex8i", {"pressure": 0.0}),
        "$K_G$ alone (the paper's)": ("hex8i", {}),
        "$K_G$ and $K_P$": ("hex8i", FOLLOWING),
        "hex20r: at rest": ("hex20r", {"pressure": 0.0}),
        "hex20r: linear, $K_G$ and $K_P$": ("hex20r", FOLLOWING),
        "hex20r: nonlinear, $K_G$ and $K_P$": ("hex20r", nonlinear),
    }
    rows = []
    for name, (element, inflation) in variants.items():
        frequency = {"stop": 500.0, "step": 2.5}
        cell = {"element": element}
        found = solved(case_of(8, cell=cell, inflation=inflation, frequency=frequency))
        mean = level(found, "radial.drive", 20, 500)
        rows.append([name, f"{first_peak(found):.1f} Hz", f"{mean:.2f} dB"])
    return table(["state", "first radial resonance", "mean level 20-500 Hz"], rows)


def solved(case: Case) -> Results:
    """A case by all cores."""
    return run_case(case, jobs=cores())


def table(header: list[str], rows: list[list[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


if __name__ == "__main__":
    main()
