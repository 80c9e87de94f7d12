"""`tyrefrf export --to vtk`: how the whole tyre moves, for ParaView.

Of a run, whose file has responses only, the case that it keeps is solved again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefrf.case import Case, build_case, case_hash, file_digests, parse_case, resolved
from tyrefrf.errors import CaseError, CommandError, Problem, ResultsError

if TYPE_CHECKING:
    from tyrefrf.results import Modes, Results

VTK = "vtk"
SHAPES = 6
"""Shapes without --shapes."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the command line says of fields.

    at: frequencies of a run's deflections. shapes: how many of modes. files: the directory of
    those that the run's case names.
    """

    at: tuple[str, ...] = ()
    shapes: int | None = None
    files: Path | None = None

    @property
    def given(self) -> list[str]:
        """The options that were given."""
        options = {"--at": self.at, "--shapes": self.shapes, "--files": self.files}
        return [name for name, value in options.items() if value not in ((), None)]

    def refuse_without(self, formats: Sequence[str]) -> None:
        """Raise CommandError for options of fields where no fields are wanted."""
        if self.given and VTK not in formats:
            raise CommandError(f"{self.given[0]} is an option of --to vtk")


@dataclass(frozen=True, slots=True)
class FieldPlan:
    """The files that will be written, and what writes them: those written, and what failed."""

    files: tuple[Path, ...]
    write: Callable[[], tuple[list[Path], list[str]]]


def plan_fields(results: Any, wanted: Wanted, directory: Path) -> FieldPlan:
    """Plan the fields of a run or of modes, to `directory/fields`.

    Raises CommandError for options that do not fit, or where a run's case cannot be solved again as
    it was, and ResultsError for results without fields.
    """
    from tyrefrf.results import Modes, Results

    if isinstance(results, Modes):
        _only(wanted, ("--shapes",), "is of a run's file; modes have frequencies of their own")
        return _of_modes(results, wanted.shapes or SHAPES, directory)
    if isinstance(results, Results):
        _only(wanted, ("--at", "--files"), "is of a file of modes (`tyrefrf modes`)")
        return _of_run(results, wanted, directory)
    kind = type(results).__name__.removesuffix("Results").lower()
    raise ResultsError(f"holds a {kind}, which has no fields; give results of a run, or modes")


def _only(wanted: Wanted, fitting: Sequence[str], reason: str) -> None:
    """Raise CommandError where another option was given than those that fit."""
    for option in wanted.given:
        if option not in fitting:
            raise CommandError(f"{option} {reason}")


def _of_modes(modes: Modes, count: int, directory: Path) -> FieldPlan:
    from tyrefrf.cli.fields import field_files, shapes_to_files
    from tyrefrf.results.deflection import field_stem
    from tyrefrf.study.model import build_mesh

    case = _case_of(modes)
    cell = None if case.geometry is None else build_mesh(case)
    lowest = modes.frequency[:count].tolist()
    stems = [field_stem(f"mode_{k}", f, of_mode=True) for k, f in enumerate(lowest, start=1)]
    return FieldPlan(
        tuple(path for stem in stems for path in field_files(stem, directory)),
        lambda: (shapes_to_files(modes, count, directory, (), cell), []),
    )


def _case_of(results: Modes | Results) -> Case:
    """The complete case that results keep.

    Raises ResultsError where this version of tyrefrf would not take it.
    """
    origin = results.provenance
    try:
        return parse_case(origin.resolved_case, "their case", origin.case_name)
    except CaseError as error:
        message = "another version of tyrefrf made these results"
        raise ResultsError(f"{message}; this one does not take {error}") from error


def _of_run(results: Results, wanted: Wanted, directory: Path) -> FieldPlan:
    from tyrefrf.cli.fields import field_files, load_names
    from tyrefrf.results.deflection import field_stem

    origin = results.provenance
    case = _case_of(results)
    frequencies = frequencies_of(case, wanted.at)
    if not frequencies:
        raise CommandError('--to vtk: at which frequencies? give --at "100 Hz", or several')
    case = case.beside(wanted.files or Path())
    refuse_other_files(case, origin.case_hash)
    stems = [
        field_stem(name, frequency, of_mode=False)
        for frequency in frequencies
        for name in load_names(case)
    ]

    def write() -> tuple[list[Path], list[str]]:
        from tyrefrf.cli.fields import deflections_to_files

        fields = deflections_to_files(case, origin.case_text, directory, (), frequencies)
        return list(fields.files), fields.facts["failed"]

    return FieldPlan(tuple(path for s in stems for path in field_files(s, directory)), write)


def refuse_other_files(case: Case, expected: str) -> None:
    """Raise CommandError where a file that a case names is not there, or not what it was.

    expected: the case's hash then.
    """
    try:
        there = file_digests(case)
    except CaseError as error:
        words = "the case of these results names what is not here"
        hint = "--files DIR says where it is: the directory of the case file"
        raise CommandError(f"{words}\n{error}\n{hint}") from None
    if there and case_hash(case) != expected:
        names = ", ".join(name for name, _ in there)
        raise CommandError(
            f"what the case of these results names ({names}) is not what it was when they were "
            "computed; run the case again"
        )


def frequencies_of(case: Case, at: Sequence[str]) -> tuple[float, ...]:
    """The frequencies of --at [Hz], or without any those of the case's own deflections.

    Raises CommandError where the case would not take them as its own.
    """
    if not at:
        return case.output.deflections
    data = resolved(case)
    data["output"]["deflections"] = [_number(text) for text in at]
    try:
        return build_case(data, case.name).output.deflections
    except CaseError as error:
        raise CommandError("\n".join(map(_of_option, error.problems))) from None


def _number(text: str) -> float | str:
    """A bare number is in hertz; what carries a unit is read as in a case."""
    try:
        return float(text)
    except ValueError:
        return text


def _of_option(problem: Problem) -> str:
    """A problem of a frequency as one of --at; any other at its place in the case."""
    if problem.key[:2] == ("output", "deflections"):
        return f"--at: {problem.message}"
    return f"--at: {problem.words}: {problem.message}"
