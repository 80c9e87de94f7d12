"""`tyrefrf sweep`: from parameters on the command line to files and a summary."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from typer.core import TyperCommand

from tyrefrf.errors import CaseError, CommandError

if TYPE_CHECKING:
    from tyrefrf.case import Case, Grid, Values
    from tyrefrf.results import Results, SweepResults
    from tyrefrf.results.proof import Measure
    from tyrefrf.study.executor import Executor

Given = Sequence[tuple[str, str]]
"""Options with their texts in the order of the command line: ("param", "E_rubber"), ..."""

OPTIONS = ("param", "values", "range", "log")
MOST_LISTED = 8  # values of a parameter that the summary lists
MOST_LEVELS = 20  # points whose levels the summary lists

_WITH_UNIT = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?\s*(?P<unit>\D.*)", re.IGNORECASE)


class InOrder(TyperCommand):
    """A command that keeps the order of its options: each --values belongs to a --param."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse as usual, and note the order in `ctx.meta`."""
        texts, _, order = self.make_parser(ctx).parse_args(args=list(args))
        taken = {name: iter(found) for name, found in texts.items() if isinstance(found, list)}
        ctx.meta["given"] = [
            (option.name.strip("_"), next(taken[option.name]))  # `range_` is Python's
            for option in order
            if option.name.strip("_") in OPTIONS
        ]
        return super().parse_args(ctx, args)


def sweep_to_files(
    case_file: Path | None,
    given: Given,
    output: Path | None,
    solver: str | None,
    jobs: int | None,
    scheduler: str | None,
    formats: Sequence[str],
    *,
    resume: bool = False,
    force: bool,
    json: bool,
) -> int:
    """Sweep a case, write results and plots, print the summary; the exit status, 0 or 1.

    resume: as `run_to_files`.
    """
    from tyrefrf.case import make_grid
    from tyrefrf.cli.exporting import check_exports, exported
    from tyrefrf.cli.running import read_case, status_of, workers_of
    from tyrefrf.cli.target import new_target

    start = time.perf_counter()
    if case_file is None and Path("case.toml").exists():
        case_file = Path("case.toml")
    case, text = read_case(case_file, solver)
    wanted = parameters_of(given) or _only_own(case)
    with _of_sweep(case_file, text):
        grid = make_grid(case, wanted)
    check_exports(case.output.export)
    with new_target(output, f"{case.name}_sweep", force=force, resume=resume) as target:
        n_lines = len(grid.cases) * len(case.frequency.lines())
        with workers_of(jobs, scheduler, n_lines) as workers, _of_sweep(case_file, text):
            # Imported while the processes start.
            from tyrefrf.cli.journal import beside_results
            from tyrefrf.cli.report import as_json
            from tyrefrf.plots import draw_plots

            sweep = _solved(grid, wanted, text, target, workers, resume=resume)
        with beside_results(target):
            drawn = draw_plots(sweep, target.parent / "plots", formats or case.output.plots)
            drawn += exported(sweep, target, case.output.export)
    facts = sweep_summary(sweep, [target, *drawn]) | {"seconds": time.perf_counter() - start}
    typer.echo(as_json(facts) if json else describe_sweep(facts))
    return status_of(facts)


def _solved(
    grid: Grid,
    wanted: Mapping[str, Values | None],
    text: str,
    target: Path,
    workers: Executor,
    *,
    resume: bool,
) -> SweepResults:
    """The results of a sweep, in their file; what an earlier one has solved is not solved again."""
    from tyrefrf.case import make_grid
    from tyrefrf.cli.journal import as_another, is_done, journalled, take_up
    from tyrefrf.cli.progress import progress_of
    from tyrefrf.results import SweepResults, write_sweep
    from tyrefrf.study.resume import check_axes
    from tyrefrf.study.sweep import run_sweep

    case, left = take_up(target, grid.base, SweepResults) if resume else (grid.base, None)
    if left is not None:
        grid = make_grid(case, wanted)
        with as_another(target):
            check_axes(grid.axes, left)
        if is_done(target, left):
            assert isinstance(left.results, SweepResults)  # `take_up` saw to it
            return left.results
    n_points = len(grid.cases)
    n_lines = n_points * len(case.frequency.lines())
    said = f"{case.name}, {n_points} points"
    with (
        journalled(target, left) as journal,
        progress_of(n_lines, said, len(journal.known)) as progress,
    ):
        sweep = run_sweep(grid, jobs=workers, case_text=text, progress=progress, record=journal)
        write_sweep(target, sweep)
        journal.remove()
    return sweep


@contextmanager
def _of_sweep(case_file: Path | None, text: str) -> Iterator[None]:
    """Say of errors that the case was not alone to blame, and where they stand in it."""
    try:
        yield
    except CaseError as error:
        from tyrefrf.case import in_sweep
        from tyrefrf.cli.running import with_notes

        called = f"sweep of {case_file or 'built-in tyre'}"
        raise with_notes(in_sweep(error, text, called), error) from None


def parameters_of(given: Given) -> dict[str, Values | None]:
    """The parameters and values that the command line gives; None for those of the case.

    Raises CommandError where values belong to no parameter, or cannot be read.
    """
    wanted: dict[str, Values | None] = {}
    name = ""
    for option, text in given:
        if option == "param":
            name, equals, values = (part.strip() for part in text.partition("="))
            if name in wanted:
                raise CommandError(f"--param {name} is given twice")
            wanted[name] = (
                _values("range" if ":" in values else "values", values) if equals else None
            )
        elif not name:
            raise CommandError(f"--{option} {text!r} belongs to no --param; name one before it")
        elif wanted[name] is not None:
            raise CommandError(f"--{option} {text!r}: {name} has values already; give one kind")
        else:
            wanted[name] = _values(option, text)
    return wanted


def _values(option: str, text: str) -> Values:
    """A list "a,b,c", or the range "a:b:n" of --range and --log."""
    from tyrefrf.case import Range

    if option == "values":
        return tuple(_written(text.split(",")))
    try:
        low, high, count = text.split(":")
        ends = _written([low, high])
        spacing = "log" if option == "log" else "linear"
        return Range.model_validate({"range": ends, "count": int(count), "spacing": spacing})
    except ValueError:  # pydantic's too
        raise CommandError(
            f"--{option} {text!r} is not a range; give first:last:count, "
            'such as 1e6:4e6:4 or "1:4 MPa:4", with a count from 2 to 1000'
        ) from None


def _written(texts: Sequence[str]) -> list[float | str]:
    """Bare numbers as such, others as text; a unit that only the last has is that of all."""
    texts = [text.strip() for text in texts]
    if not all(texts):
        raise CommandError("a value is empty; separate values by single commas")
    last = _WITH_UNIT.fullmatch(texts[-1])
    if last and _float(texts[-1]) is None and all(_float(text) is not None for text in texts[:-1]):
        texts = [*(f"{text} {last['unit']}" for text in texts[:-1]), texts[-1]]
    return [text if (number := _float(text)) is None else number for text in texts]


def _float(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _only_own(case: Case) -> dict[str, Values | None]:
    """The one parameter of the case's [sweep], where nothing is named."""
    if len(case.sweep) == 1:
        return dict.fromkeys(case.sweep)
    has = f"has {', '.join(case.sweep)}" if case.sweep else "is empty"
    raise CommandError(f"no --param; name one of the case's parameters (its [sweep] {has})")


def sweep_summary(sweep: SweepResults, files: Sequence[Path]) -> dict[str, Any]:
    """The facts of a sweep that a script wants to know."""
    from tyrefrf.cli.report import adaptive_words, median, probe_labels
    from tyrefrf.results.proof import MEASURES, breaches
    from tyrefrf.results.results import MISSING

    origin = sweep.provenance
    named = list(zip(sweep.labels, sweep.points, strict=True))
    remarks = [
        (f"{label}: {_with_frequency(frequency, remark)}", bool(failed))
        for label, point in named
        for frequency, remark, failed in zip(
            point.frequency, point.remark, point.failed, strict=True
        )
        if remark and remark != MISSING
    ]
    return {
        "case": origin.case_name,
        "title": origin.title,
        "solver": origin.solver,
        "parameters": [
            {
                "name": axis.name,
                "place": axis.place,
                "meaning": axis.meaning,
                "units": axis.units,
                "values": list(axis.values),
                "texts": [axis.text(i) for i in range(len(axis.values))],
            }
            for axis in sweep.axes
        ],
        **origin.numbers,
        "labels": list(sweep.labels),
        "lines": len(sweep.frequency),
        "missing_lines": sweep.n_missing,
        "first_frequency": float(sweep.frequency[0]),
        "last_frequency": float(sweep.frequency[-1]),
        "loads": [place.label for place in sweep.loads],
        "probes": probe_labels(sweep.probes),
        "blocked_force": list(sweep.hub),
        "levels": {load.name: sweep.level(load.name).ravel().tolist() for load in sweep.loads},
        "largest_residual": _largest(sweep.residual[sweep.solved]),
        "proof": {name: _worst_of(named, measure) for name, measure in MEASURES.items()},
        "breaches": [f"{label}: {reason}" for label, point in named for reason in breaches(point)],
        "adaptive": [
            f"{label}: {words}"
            for label, point in named
            if (words := adaptive_words(point.provenance.numbers, len(point.frequency)))
        ],
        "seconds_per_line": median(sweep.solve_time),
        "failed": [text for text, failed in remarks if failed],
        "remarks": [text for text, failed in remarks if not failed],
        "files": [str(path) for path in files],
    }


def _worst_of(named: Sequence[tuple[str, Results]], measure: Measure) -> dict[str, Any] | None:
    """The worst of all points, with the point."""
    import numpy as np

    found = [
        asdict(worst) | {"point": label}
        for label, point in named
        if (worst := measure.worst_of(point)) is not None
    ]
    values = np.array([worst["value"] for worst in found])
    return found[int(measure.worst(values))] if found else None


def describe_sweep(facts: dict[str, Any]) -> str:
    """The summary at the end of a sweep, and what a sweep's file holds."""
    from tyrefrf.cli.report import (
        missing_lines,
        picked_lines,
        proof_lines,
        resumed_lines,
        time_line,
    )

    n_failed = len(facts["failed"])
    lines = [
        facts["title"],
        *(
            f"  parameter {p['name']} ({p['meaning']}): {_listed(p['texts'])}"
            for p in facts["parameters"]
        ),
        f"  lines     {facts['points']} x {facts['lines']}, {facts['first_frequency']:g} to "
        f"{facts['last_frequency']:g} Hz" + (f", {n_failed} FAILED" if n_failed else ""),
        *(f"  adaptive  {words}" for words in facts["adaptive"]),
        *missing_lines(facts["missing_lines"]),
        *resumed_lines(facts),
        time_line(facts),
        *picked_lines(facts),
        *proof_lines(facts),
        *_levels(facts),
        *(f"  remark    {remark}" for remark in facts["remarks"]),
        *(f"  wrote     {path}" for path in facts["files"]),
    ]
    return "\n".join(lines)


def _listed(texts: list[str]) -> str:
    """All values, or how many there are between which."""
    if len(texts) <= MOST_LISTED:
        return ", ".join(texts)
    return f"{len(texts)} values, {texts[0]} to {texts[-1]}"


def _levels(facts: dict[str, Any]) -> list[str]:
    """Mean levels of the driving points, a line for every point."""
    if len(facts["labels"]) > MOST_LEVELS:
        return []
    head = "  level     of the mobility, mean over the lines [dB re 1 m/(s N)]"
    points = zip(facts["labels"], *facts["levels"].values(), strict=True)
    return [
        head,
        *(
            f"            {label}: "
            + ", ".join(
                f"{load} {level:.2f}" for load, level in zip(facts["levels"], levels, strict=True)
            )
            for label, *levels in points
        ),
    ]


def _with_frequency(frequency: float, remark: str) -> str:
    """A remark that names its line; a failed line's does already."""
    return remark if " Hz: " in remark else f"{frequency:.6g} Hz: {remark}"


def _largest(values: Any) -> float | None:
    return float(values.max()) if len(values) else None
