"""Mutation testing of fem and solvers: does a test notice when a line is broken?

    .venv/bin/pip install --editable ".[mutation]"
    .venv/bin/python tests/mutation/run.py tyrefrf/solvers/chain.py   all mutants of these files
    .venv/bin/python tests/mutation/run.py --sample 20 --seed 1       20 of each file, at random
    .venv/bin/python tests/mutation/run.py --again --worth 60         what survived, once more
    .venv/bin/python tests/mutation/run.py --report                   README.md beside this, anew

mutmut changes one thing at a time, a sign, a comparison, a number, an argument, and runs the tests
that reach the changed function. Its settings are in pyproject.toml, its work in build/mutation,
where it is kept: what has its verdict is not run again, so the same command takes up what was
stopped with Ctrl-C. `reasons.toml` says why a mutant may live, and of which kinds none is run.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WORK = ROOT / "build" / "mutation"
LINKED = ("tyrefrf", "tests", "cases", "benchmarks", "docs", "README.md", "pyproject.toml")

VERDICTS = {0: "survived", 1: "killed", 3: "killed", 5: "no test", 33: "no test"}
"""Of mutmut's exit codes; any other is a mutant that ran out of time or crashed."""
NOTICED = ("killed", "out of time")
COLUMNS = (*NOTICED, "survived", "no test")


@dataclass(frozen=True, slots=True)
class Reason:
    """Why mutants live. pattern: of their changes. run: whether they are run at all."""

    why: str
    pattern: str
    run: bool = True


UNANSWERED = Reason("Not answered", "")


@dataclass(frozen=True, slots=True)
class Mutants:
    """The mutants of one file. verdicts: by name, of those that have been run."""

    file: str
    names: Sequence[str]
    verdicts: dict[str, str]


def main() -> None:
    """Run what the command line asks for, then write the report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="*", metavar="FILE")
    parser.add_argument("--sample", type=int, help="mutants of each file, at random; default: all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="mutants at a time")
    parser.add_argument("--worth", type=float, default=6.0, help="seconds of tests for a mutant")
    parser.add_argument("--again", action="store_true", help="what survived and has no reason")
    parser.add_argument("--report", action="store_true", help="README.md alone; run nothing")
    asked = parser.parse_args()
    prepare()
    if not asked.report:
        chosen = unanswered(asked.files) if asked.again else fresh(asked)
        shorten(asked.worth)
        if chosen:
            mutmut("run", "--max-children", str(asked.jobs), *chosen)
    (HERE / "README.md").write_text(report(), encoding="utf-8")


def prepare() -> None:
    """Lay out the work folder and go there; have mutmut make the mutants."""
    WORK.mkdir(parents=True, exist_ok=True)
    for name in LINKED:
        link(WORK / name, ROOT / name)
    link(WORK / "shared", ROOT.parent / "shared")  # where tests/reference looks for it
    os.chdir(WORK)
    if not any(mutants()):
        mutmut("run", "--max-children", "1", "none")  # there is no command that makes them alone


def link(name: Path, target: Path) -> None:
    """A link to what is there."""
    if target.exists() and not name.is_symlink():
        name.symlink_to(target)


def mutmut(*arguments: str) -> None:
    """Run mutmut, one BLAS thread to a process."""
    threads = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "MKL", "OMP")}
    command = [str(Path(sys.executable).with_name("mutmut")), *arguments]
    subprocess.run(command, env=os.environ | threads, check=False)


def shorten(worth: float) -> None:
    """Leave to every function the fastest of its tests; the others are kept aside."""
    notes, aside = Path("mutants/mutmut-stats.json"), Path("mutants/every-test.json")
    kept = json.loads(notes.read_text(encoding="utf-8"))
    known = json.loads(aside.read_text(encoding="utf-8")) if aside.exists() else {}
    seconds, tests_of = kept["duration_by_test"], kept["tests_by_mangled_function_name"]
    for function, tests in tests_of.items():
        known[function] = sorted(
            {*tests, *known.get(function, [])} & seconds.keys(), key=seconds.__getitem__
        )
        total = accumulate(seconds[test] for test in known[function])
        n = max(1, sum(t <= worth for t in total))
        tests_of[function] = known[function][:n]
    notes.write_text(json.dumps(kept), encoding="utf-8")
    aside.write_text(json.dumps(known), encoding="utf-8")


def mutants(files: Sequence[str] = ()) -> Iterator[Mutants]:
    """What mutmut keeps of every file, in the order of their names."""
    for meta in sorted(Path("mutants").glob("tyrefrf/*/*.meta")):
        file = str(meta.relative_to("mutants").with_suffix(""))
        codes = json.loads(meta.read_text(encoding="utf-8"))["exit_code_by_key"]
        verdicts = {k: VERDICTS.get(c, "out of time") for k, c in codes.items() if c is not None}
        if codes and (not files or file in files):
            yield Mutants(file, sorted(codes), verdicts)


def fresh(asked: argparse.Namespace) -> list[str]:
    """The names of the mutants that are asked for and have no verdict yet."""
    rng, given, chosen = random.Random(asked.seed), reasons(), list[str]()
    for one in mutants(asked.files):
        few = asked.sample is not None and asked.sample < len(one.names)
        names = rng.sample(one.names, asked.sample) if few else one.names
        unknown = [name for name in names if name not in one.verdicts]
        chosen += [name for name in unknown if answer(given, change(name, one.file)).run]
    return chosen


def unanswered(files: Sequence[str]) -> list[str]:
    """The names of the mutants that no test noticed and that have no reason to live."""
    given = reasons()
    return [
        name
        for one in mutants(files)
        for name, verdict in one.verdicts.items()
        if verdict not in NOTICED and answer(given, change(name, one.file)) is UNANSWERED
    ]


def change(name: str, file: str) -> str:
    """What a mutant changes: its file and function, and what stood there -> what stands there."""
    from mutmut.mutation.diff_apply import get_diff_for_mutant

    shown = get_diff_for_mutant(name, path=file).splitlines()
    lines = [x for x in shown if x[:1] in ("-", "+") and x[:3] not in ("---", "+++")]
    before, after = (" ".join(x[1:].strip() for x in lines if x[0] == sign) for sign in "-+")
    function = name.partition("__mutmut_")[0].rpartition(".")[2]
    function = function.removeprefix("x_").removeprefix("xǁ").replace("ǁ", ".")
    return f"{file.removeprefix('tyrefrf/')} {function}: {before} -> {after}"


def reasons() -> list[Reason]:
    """Those of reasons.toml."""
    text = (HERE / "reasons.toml").read_text(encoding="utf-8")
    return [Reason(**table) for table in tomllib.loads(text)["reason"]]


def answer(given: Sequence[Reason], text: str) -> Reason:
    """The first reason whose pattern a change has."""
    return next((one for one in given if re.search(one.pattern, text)), UNANSWERED)


def report() -> str:
    """README.md: the mutants by file, and why those that live may."""
    given, rows, answered = reasons(), list[list[object]](), dict[str, list[str]]()
    for one in mutants():
        counts = Counter(one.verdicts.values())
        for name, verdict in sorted(one.verdicts.items()):
            if verdict not in NOTICED:
                text = change(name, one.file)
                answered.setdefault(answer(given, text).why, []).append(text)
        rows.append([one.file, len(one.names), len(one.verdicts), *(counts[v] for v in COLUMNS)])
    total = [sum(row[k] for row in rows) for k in range(1, 3 + len(COLUMNS))]  # type: ignore[misc]
    order = [one.why for one in [*given, UNANSWERED]]
    return PAGE.format(
        head=" | ".join(COLUMNS),
        rule=" | ".join(["---"] * (3 + len(COLUMNS))),
        table="\n".join(f"| {' | '.join(map(str, row))} |" for row in [*rows, ["all", *total]]),
        answers="\n\n".join(
            f"{why}:\n\n" + "\n".join(f"    {text}" for text in answered[why])
            for why in dict.fromkeys(order)
            if why in answered
        ),
    )


PAGE = """\
# What the tests of fem and solvers do not notice

Made by `tests/mutation/run.py`, which says how. One thing at a time is changed, a sign, a
comparison, a number, an argument; the tests that reach the function are run, the fastest first, for
some seconds of them. Changed are the bodies of functions, but no texts of errors; and, as mutmut
leaves them alone, no constants of modules and nothing decorated (properties, caches). Of files not
run whole a random sample was drawn; where that was stopped, the mutants with the quickest tests
went first.

| file | mutants | run | {head} |
| {rule} |
{table}

## Those that live, and why they may

{answers}
"""


if __name__ == "__main__":
    main()
