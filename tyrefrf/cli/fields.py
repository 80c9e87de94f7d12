"""Fields of the whole tyre beside other results: files for ParaView in `fields/`, and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from glob import escape
from pathlib import Path
from typing import Any

from tyrefrf.case import Case
from tyrefrf.errors import CommandError
from tyrefrf.mesh.cell import CellMesh
from tyrefrf.results import Modes
from tyrefrf.results.deflection import Deflection
from tyrefrf.results.names import file_names


@dataclass(frozen=True, slots=True)
class Fields:
    """What was written of a case's deflections: the files, and what a script wants to know."""

    files: tuple[Path, ...]
    facts: dict[str, Any]


def load_names(case: Case) -> list[str]:
    """The loads by the names that their files begin with."""
    return file_names(load.name for load in case.loads)


def check_fields(directory: Path, names: Sequence[str], *, force: bool) -> None:
    """Raises CommandError where `fields/` has files of these names and nothing may be replaced."""
    for name in names:
        for there in sorted((directory / "fields").glob(f"{escape(name)}_*Hz.vt*")):
            if not force:
                raise CommandError(
                    f"{there} exists; --force replaces it, --output DIR writes somewhere else"
                )


def deflections_to_files(
    case: Case,
    text: str,
    directory: Path,
    formats: Sequence[str],
    frequencies: Sequence[float] | None = None,
) -> Fields:
    """Solve, write and draw the deflections that a case asks for, one frequency at a time.

    text: the case as its author wrote it. directory: of the run's results. frequencies: others
    than the case's [Hz].
    """
    from tyrefrf.cli.progress import progress_of
    from tyrefrf.study.deflection import deflected

    wanted = case.output.deflections if frequencies is None else frequencies
    files: list[Path] = []
    residuals: dict[float, float] = {}
    failed: list[str] = []
    if wanted:
        with progress_of(len(wanted), f"{case.name}, deflections") as progress:
            for line in deflected(case, wanted, case_text=text):
                for deflection in line.deflections:
                    files += field_to_files(deflection, directory, formats)
                    residuals[line.frequency] = deflection.residual
                if line.failure:
                    failed.append(f"deflection at {line.failure}")
                progress(1)
    largest = max(residuals.values(), default=None)
    facts = {"frequencies": [*residuals], "largest_residual": largest, "failed": failed}
    return Fields(tuple(files), facts)


def shapes_to_files(
    modes: Modes, count: int, directory: Path, formats: Sequence[str], cell: CellMesh | None
) -> list[Path]:
    """Write and draw the shapes of the `count` lowest modes, or of all there are; the files.

    cell: the case's mesh; needed where that is not the modes' section revolved.
    """
    from tyrefrf.results.deflection import mode_deflection

    written: list[Path] = []
    for number in range(1, min(count, len(modes.frequency)) + 1):
        written += field_to_files(mode_deflection(modes, number, cell), directory, formats)
    return written


def field_to_files(deflection: Deflection, directory: Path, formats: Sequence[str]) -> list[Path]:
    """Write one motion as VTKHDF and VTU, and draw it beside the other plots; the files."""
    from tyrefrf.plots import draw_plots
    from tyrefrf.results.vtkhdf import write_vtkhdf
    from tyrefrf.results.vtu import write_vtu

    files = field_files(deflection.stem, directory)
    write_vtkhdf(files[0], deflection)
    write_vtu(files[1], deflection)
    return [*files, *draw_plots(deflection, directory / "plots", formats)]


def field_files(stem: str, directory: Path) -> list[Path]:
    """The VTKHDF and the VTU file of one motion, beside other results."""
    return [directory / "fields" / f"{stem}.{form}" for form in ("vtkhdf", "vtu")]
