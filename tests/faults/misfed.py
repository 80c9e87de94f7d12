"""Inputs that are wrong on purpose, by name and by the thousand, and what the user is told."""

from __future__ import annotations

import gzip
import os
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py

from ..small import TEXT, text_with
from .cases import CPU_LIMIT, tried
from .rows import NOTHING, Row
from .starved import command, contents, plain

PART = "Misfed"
LINES = "values = [0.0, 40.0, 150.0, 420.0]"
ROOT = Path(__file__).parents[2]


def numbers(value: str) -> list[str]:
    """The small tyre with this in place of each of its numbers."""
    places = ("elements_along = 8", 'E = "80 MPa"', "nu = 0.42", "rho = 1200.0", "eta = 0.1")
    places = (*places, "sector_angle = 24.0", "s = 0.5", "angle = 100.0")
    return [text_with((place, f"{place.partition('=')[0]}= {value}")) for place in places]


CASES: dict[str, list[str | bytes]] = {
    "binary garbage": [os.urandom(5000) for _ in range(10)],
    "100 MB": [b"# all comment\n" * 7_500_000],
    "arrays in arrays, 10^5 deep": ["a = " + "[" * 99_999, TEXT + "a = " + "{a = " * 99_999],
    "NaN": numbers("nan"),
    "infinities": [*numbers("inf"), *numbers("-inf")],
    "zero and negative densities": [
        text_with(("rho = 1200.0", f"rho = {value}")) for value in ("0.0", "-1200.0")
    ],
    "nu = 0.5": [text_with(("nu = 0.42", "nu = 0.5"))],
    "zero, negative and endless sector angles": [
        text_with(("sector_angle = 24.0", f"sector_angle = {value}"))
        for value in ("0.0", "-8.0", "1e-9", "1e9")
    ],
    "10^9 lines": [
        text_with((LINES, lines))
        for lines in ("stop = 1e6\nstep = 1e-3", "stop = 1e6\ncount = 1000000000")
    ],
    "names with path separators": [
        f'name = "{name}"\n' + TEXT for name in ("../../etc/x", "/etc/x", "a/b", "..", "a\\\\b")
    ],
}
"""Case files by their fault."""


def of_case(fault: str, texts: list[str | bytes]) -> Row:
    """What `tyrefrf run` says of case files with one fault."""
    said, losses = [], []
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        for text in texts:
            data = text.encode() if isinstance(text, str) else text
            (directory / "tyre.toml").write_bytes(data)
            before = contents(directory)
            done = command("run", "tyre.toml", cwd=directory, timeout=100)
            said.append(first_line(done, directory))
            if done.returncode != 2 or "Traceback" in done.stderr:
                losses.append(f"status {done.returncode}")
            if contents(directory) != before:
                losses.append("something was written")
    return Row(PART, fault, len(texts), "; ".join(losses) or NOTHING, _example(said))


def first_line(done: subprocess.CompletedProcess[str], directory: Path) -> str:
    """The first of what the user saw, and the status."""
    lines = done.stderr.splitlines() or ["nothing"]
    return f"`{plain(lines[0], directory)[:160]}` ({done.returncode})"


def _example(said: list[str]) -> str:
    different = list(dict.fromkeys(said))
    return different[0] + (f", and {len(different) - 1} others" if len(different) > 1 else "")


def results_file() -> bytes:
    """A whole results file."""
    return gzip.decompress((ROOT / "tests/data/layout1/run.h5.gz").read_bytes())


def changed(change: Callable[[h5py.File], None]) -> bytes:
    """A results file with something changed in it."""
    with tempfile.NamedTemporaryFile(suffix=".h5") as file:
        Path(file.name).write_bytes(results_file())
        with h5py.File(file.name, "r+") as opened:
            change(opened)
        return Path(file.name).read_bytes()


def _truncated() -> list[bytes]:
    whole = results_file()
    return [whole[: len(whole) * k // 40] for k in range(40)]


FILES: dict[str, Callable[[], list[bytes]]] = {
    "a truncated results file, at 40 places": _truncated,
    "results of another program": lambda: [
        changed(lambda file: file.attrs.__setitem__("program", "other"))
    ],
    "results of a newer layout": lambda: [
        changed(lambda file: file.attrs.__setitem__("layout", 99))
    ],
    "something else under a results file's name": lambda: [b"", b"PK\3\4", TEXT.encode()],
}
"""Results files by their fault."""


def of_file(fault: str, files: list[bytes]) -> Row:
    """What `tyrefrf info` says of results files with one fault."""
    said, losses = [], []
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        for data in files:
            (directory / "tyre.h5").write_bytes(data)
            done = command("info", "tyre.h5", cwd=directory)
            said.append(first_line(done, directory))
            if done.returncode != 1 or "Traceback" in done.stderr:
                losses.append(f"status {done.returncode}")
    return Row(PART, fault, len(files), "; ".join(losses) or NOTHING, _example(said))


def generated(count: int, seed: int) -> Iterator[Row]:
    """A row for every kind of spoilt case, drawn at random."""
    for row in tried(count, seed, CPU_LIMIT, ROOT / "build/faults/cases"):
        seen = ", ".join(f"{what}: {n}" for what, n in row.outcomes.items())
        lost = f"{row.other} with anything else" if row.other else NOTHING
        fault = f"generated cases: {row.kind}"
        yield Row(PART, fault, row.generated, lost, f"{seen}; slowest {row.slowest:.0f} s")


def rows(count: int, seed: int) -> Iterator[Row]:
    """Every named fault, and `count` generated cases."""
    for fault, texts in CASES.items():
        yield of_case(fault, texts)
    for fault, files in FILES.items():
        yield of_file(fault, files())
    yield from generated(count, seed)
