"""What is asked of a file before it is read: whose it is, of which layout, and what it holds."""

from __future__ import annotations

from collections.abc import Container
from pathlib import Path
from typing import Any

import numpy as np

from tyrefrf.errors import ResultsError

PROGRAM = "tyrefrf"

LAYOUT = 1
"""Counts up where an older program would misread a newer file."""

UPGRADE = "upgrade it with `pip install --upgrade tyrefrf`"


def check_origin(path: Path, file: Any) -> None:
    """Raises ResultsError for a file of another program, or of no layout that this one reads."""
    program = file.attrs.get("program", "an unknown program")
    if not isinstance(program, str) or program != PROGRAM:
        raise ResultsError(f"{path}: HDF5 of {program}; expected results of tyrefrf")
    layout = file.attrs.get("layout")
    if not isinstance(layout, int | np.integer) or layout < 1:
        found = "no layout" if layout is None else f"layout {layout!r}, which is none"
        raise ResultsError(
            f"{path}: says of itself that it has {found}; expected one from 1 to {LAYOUT}: "
            "damaged, or changed by another program; run the case again"
        )
    if layout > LAYOUT:
        version = file.attrs.get("version", "of an unknown version")
        raise ResultsError(
            f"{path}: layout {layout}, written by tyrefrf {version}; this tyrefrf reads layouts"
            f" up to {LAYOUT}: {UPGRADE}"
        )


def content_of(path: Path, file: Any, known: Container[str]) -> str:
    """What an open file holds, one of those `known`. Raises ResultsError for anything else.

    The first files of layout 1 do not say: they are runs, or sweeps, which say what their points
    have of their own.
    """
    content = file.attrs.get("content", "sweep" if "point" in file else "run")
    if not isinstance(content, str) or content not in known:
        raise ResultsError(
            f"{path}: holds {content!r}, which this tyrefrf does not know: {UPGRADE}"
        )
    return content
