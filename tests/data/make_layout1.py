"""Results files of layout 1 as tyrefrf 0.1.0 wrote them, for tests/results/test_layout1.py.

Run once; the files in layout1/ are what users of that version have. They are never made again,
least of all to make a test pass: this says how they came about, and refuses to replace them. A
newer layout gets a script and files of its own.

The files are compressed by gzip: HDF5 takes 100 kB for the little that is in them. Beside each, its
passport: who wrote it, when, from which case, and what was in memory then (see tests/golden.py).

    python tests/data/make_layout1.py        # every content, by the program of version 0.1.0
    python tests/data/make_layout1.py first  # by that of commit f5b68a8, before 0.1.0, whose files
                                             # did not say what they hold
"""

from __future__ import annotations

import gzip
import json
import sys
import tempfile
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

TESTS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS))
from golden import told  # noqa: E402
from small import TEXT, case_with, text_with  # noqa: E402

from tyrefrf import results  # noqa: E402
from tyrefrf.case import make_grid  # noqa: E402
from tyrefrf.study.run import run, run_case  # noqa: E402
from tyrefrf.study.sweep import run_sweep  # noqa: E402

LAB = "frequency,real,imag\n40,2.0e-6,-3.0e-7\n150,1.0e-6,-6.0e-7\n420,-4.0e-7,-2.0e-7\n"
EVERYTHING = (
    ("[cell]", '[inflation]\npressure = "1 bar"\n\n[cell]'),
    ('name = "sidewall"\n', 'name = "sidewall"\nsensor_mass = "5 g"\n'),
    ("values = [0.0, 40.0, 150.0, 420.0]", "stop = 420.0\nstep = 7.0\nadaptive = true"),
)
CURVE = """
[[measured]]
file = "lab.csv"
load = "radial"
probe = "sidewall"
quantity = "receptance"
"""
Made = tuple[str, str, Any, Callable[[Path, Any], None]]
"""Name of the file, how the case was computed, what came out, and what writes it."""


def first() -> Iterator[Made]:
    """What the first programs could do."""
    done = run_case(case_with(), jobs=1, case_text=TEXT)
    yield "first_run", "run", done, results.write_results
    grid = make_grid(case_with(), {"cell.sector_angle": (24.0, 36.0)})
    swept = run_sweep(grid, jobs=1, case_text=TEXT)
    yield (
        "first_sweep",
        "sweep --param cell.sector_angle --values 24,36",
        swept,
        results.write_sweep,
    )


def every() -> Iterator[Made]:
    """Every content of a file, and every part that a run may have."""
    from tyrefrf.study.compare import compare
    from tyrefrf.study.dispersion import dispersion
    from tyrefrf.study.modes import modes

    with tempfile.TemporaryDirectory() as directory:
        small, all_of_it = Path(directory, "small.toml"), Path(directory, "everything.toml")
        small.write_text(TEXT)
        all_of_it.write_text(text_with(*EVERYTHING) + CURVE)
        Path(directory, "lab.csv").write_text(LAB)
        yield "run", "run", run(small, jobs=1), results.write_results
        done = run(all_of_it, jobs=1, certify=True)
        yield "everything", "run --certify", done, results.write_results
        grid = make_grid(case_with(), {"pressure": (0.0, 1e5), "sector_angle": (24.0, 36.0)})
        how = "sweep --param pressure=0,1e5 --param sector_angle=24,36"
        yield "sweep", how, run_sweep(grid, jobs=1, case_text=TEXT), results.write_sweep
        compared = compare(small, ["recursive", "modal"])
        yield "comparison", "compare --solvers recursive,modal", compared, results.write_comparison
        yield "modes", "modes --count 3", modes(small, count=3), results.write_modes
        waves = dispersion(small, lines=3, decay=2.0)
        yield "dispersion", "dispersion --lines 3 --decay 2", waves, results.write_dispersion


def keep(name: str, how: str, what: Any, write: Callable[[Path, Any], None]) -> None:
    """Write a file and its passport where there is none."""
    file, passport = (TESTS / "data/layout1" / f"{name}.{end}" for end in ("h5.gz", "json"))
    if file.exists():
        sys.exit(f"{file} is there; what 0.1.0 wrote is not to be made again")
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory, f"{name}.h5")
        write(path, what)
        file.write_bytes(gzip.compress(path.read_bytes(), mtime=0))
    facts = {
        "program": "tyrefrf",
        "version": version("tyrefrf"),
        "libraries": {library: version(library) for library in ("numpy", "scipy", "h5py")},
        "made": datetime.now(UTC).date().isoformat(),
        "command": how,
        "case": what.provenance.case_text,
        "held": told(what),
    }
    passport.write_text(json.dumps(facts, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    for made in first() if sys.argv[1:] == ["first"] else every():
        keep(*made)
