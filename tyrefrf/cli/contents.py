"""What `tyrefrf info` says of each kind of results that a file may hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefrf.cli.comparing import comparison_summary, describe_comparison
from tyrefrf.cli.dispersion import describe_dispersion_file, dispersion_summary
from tyrefrf.cli.modes import describe_modes_file, modes_summary
from tyrefrf.cli.report import describe, summary
from tyrefrf.cli.sweeping import describe_sweep, sweep_summary
from tyrefrf.results import Comparison, Dispersion, Modes, Results, SweepResults


@dataclass(frozen=True, slots=True)
class Told:
    """How results are told: facts for scripts, of the results and their files, and words."""

    facts: Callable[[Any, list[Path]], dict[str, Any]]
    words: Callable[[Any], str]


TOLD: dict[type, Told] = {
    Results: Told(summary, describe),
    Comparison: Told(
        comparison_summary, lambda found: describe_comparison(comparison_summary(found, []))
    ),
    SweepResults: Told(sweep_summary, lambda sweep: describe_sweep(sweep_summary(sweep, []))),
    Modes: Told(modes_summary, describe_modes_file),
    Dispersion: Told(dispersion_summary, describe_dispersion_file),
}
"""How each kind of results is told."""
