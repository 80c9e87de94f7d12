"""`tyrefrf run` and `tyrefrf check`: from a case file to files and a summary."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import typer

from tyrefrf.case import Case, Solver, builtin_text, parse_case, read_text, with_lines
from tyrefrf.cli.target import new_target
from tyrefrf.errors import CaseError, CommandError, MeshError

Raised = TypeVar("Raised", bound=BaseException)

if TYPE_CHECKING:
    from tyrefrf.results import Results
    from tyrefrf.study.executor import Executor


def run_to_files(
    case_file: Path | None,
    output: Path | None,
    solver: str | None,
    jobs: int | None,
    scheduler: str | None,
    formats: Sequence[str],
    *,
    certify: bool = False,
    resume: bool = False,
    force: bool,
    json: bool,
) -> int:
    """Run a case, write results and plots, print the summary; the exit status, 0 or 1.

    resume: whether lines that an earlier run has solved are taken from its journal or results.
    """
    from tyrefrf.cli.exporting import check_exports, exported

    start = time.perf_counter()
    case, text = read_case(case_file, solver)
    check_exports(case.output.export)
    with new_target(output, case.name, force=force, resume=resume) as target:
        n_lines = len(case.frequency.lines())
        with workers_of(jobs, scheduler, n_lines) as workers:
            # Imported while the processes start.
            from tyrefrf.cli.fields import check_fields, deflections_to_files, load_names
            from tyrefrf.cli.journal import beside_results
            from tyrefrf.cli.report import as_json, describe_run, summary
            from tyrefrf.plots import draw_plots

            if case.output.deflections:
                check_fields(target.parent, load_names(case), force=force or resume)
            with in_file(case_file, text):
                _warn_of_matrices(case)
                results = _solved(case, text, target, workers, resume=resume, certify=certify)
        with beside_results(target):
            if case.output.deflections:
                _refuse_other_files(case, results)
            drawn = draw_plots(results, target.parent / "plots", formats or case.output.plots)
            drawn += exported(results, target, case.output.export)
            fields = deflections_to_files(case, text, target.parent, formats or case.output.plots)
    facts = summary(results, [target, *drawn, *fields.files])
    facts |= {"deflections": fields.facts, "seconds": time.perf_counter() - start}
    with beside_results(target):
        typer.echo(as_json(facts) if json else describe_run(facts))
    return status_of(facts)


def _solved(
    case: Case, text: str, target: Path, workers: Executor, *, resume: bool, certify: bool
) -> Results:
    """The results of a case, in their file; what an earlier run has solved is not solved again."""
    from tyrefrf.cli.journal import beside_results, is_done, journalled, take_up
    from tyrefrf.cli.progress import progress_of
    from tyrefrf.results import Results, write_results
    from tyrefrf.study.run import run_case

    case, left = take_up(target, case, Results) if resume else (case, None)
    if left is not None and is_done(target, left):
        results = left.results
    else:
        n_lines = len(case.frequency.lines())
        with (
            journalled(target, left) as journal,
            progress_of(n_lines, case.name, len(journal.known)) as progress,
        ):
            results = run_case(
                case, jobs=workers, case_text=text, progress=progress, record=journal
            )
            write_results(target, results)
            journal.remove()
    assert isinstance(results, Results)  # `take_up` saw to it
    if certify and results.certificate is None:
        with beside_results(target):
            _refuse_other_files(case, results)
            results = _certified(case, results, workers)
            write_results(target, results)
    return results


def _refuse_other_files(case: Case, results: Results) -> None:
    """Raise CommandError where files that the case names are not those that were computed with."""
    from tyrefrf.cli.exporting_fields import refuse_other_files
    from tyrefrf.study.choose import with_solver

    origin = results.provenance
    refuse_other_files(with_solver(case, origin.solver), origin.case_hash)


@contextmanager
def workers_of(jobs: int | None, scheduler: str | None, n_tasks: int) -> Iterator[Executor]:
    """Who works: so many processes of this machine, or the scheduler's; all ends with the context.

    Raises CommandError where both are given, or nobody is there.
    """
    from tyrefrf.study.executor import executor_of
    from tyrefrf.study.local import cores

    if scheduler is None:
        workers = executor_of(jobs or cores(), n_tasks)
        try:
            yield workers
        finally:
            workers.stop()
        return
    if jobs is not None:
        raise CommandError(
            "--jobs counts processes of this machine, --scheduler brings its own; give one of them"
        )
    from tyrefrf.study.cluster import cluster

    with cluster(scheduler) as workers:
        yield workers


def _certified(case: Case, results: Results, workers: Executor) -> Results:
    """The results with their certificate; what it costs goes to stderr before."""
    from tyrefrf.cli.progress import progress_of
    from tyrefrf.study.certify import certified, plan_certificate

    plan = plan_certificate(case, results)
    print(plan.words(workers.jobs), file=sys.stderr)
    with progress_of(plan.n_lines, f"{case.name}, certify") as progress:
        return certified(plan, workers, progress)


def _warn_of_matrices(case: Case) -> None:
    """Say on stderr, before anything is solved, what may be a mistake in a case's own matrices."""
    if case.matrices is None:
        return
    from tyrefrf.study.brought import bring_matrices

    for warning in bring_matrices(case).warnings:
        print(f"warning: {warning}", file=sys.stderr)


def status_of(facts: dict[str, Any]) -> int:
    """The exit status of a run or sweep; its failed lines and breaches go to stderr."""
    from tyrefrf.cli.report import first_of

    breaches = facts.get("breaches", [])  # a comparison has none
    failed = [*facts["failed"], *facts.get("deflections", {}).get("failed", [])]
    for line in (*failed, *first_of(breaches)):
        print(line, file=sys.stderr)
    return 1 if failed or breaches else 0


def check_case(case_file: Path | None, solver: str | None, jobs: int | None, *, json: bool) -> None:
    """Print what a case would compute."""
    from tyrefrf.cli.report import as_json, describe_estimate
    from tyrefrf.study.estimate import estimate
    from tyrefrf.study.local import cores

    case, text = read_case(case_file, solver)
    with in_file(case_file, text):
        found = estimate(case, jobs or cores())
    typer.echo(as_json(asdict(found)) if json else describe_estimate(case, found, jobs or cores()))


def read_case(case_file: Path | None, solver: str | None) -> tuple[Case, str]:
    """The case of a file, or the built-in tyre, and its text; with another solver if named."""
    text = builtin_text() if case_file is None else read_text(case_file)
    case = parse_case(text, _called(case_file), case_file.stem if case_file else "tyre")
    if solver not in (None, case.solver.name):  # its own keeps its options
        case = case.model_copy(update={"solver": Solver.model_validate({"name": solver})})
    return case.beside(case_file.parent) if case_file else case, text


@contextmanager
def in_file(case_file: Path | None, text: str) -> Iterator[None]:
    """Give the errors of meshing and placing their file and line."""
    try:
        yield
    except CaseError as error:
        raise with_notes(with_lines(error, text, _called(case_file)), error) from None
    except MeshError as error:
        raise with_notes(MeshError(f"{_called(case_file)}: {error}"), error) from error


def with_notes(error: Raised, first: BaseException) -> Raised:
    """The error, with the notes of the one that it stands for."""
    for note in getattr(first, "__notes__", ()):
        error.add_note(note)
    return error


def _called(case_file: Path | None) -> str:
    """What messages call the case."""
    return str(case_file) if case_file else "built-in tyre"
