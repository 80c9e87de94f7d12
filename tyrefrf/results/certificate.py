"""What a second look at a run found: another solver, and a ring of finer cells."""

from __future__ import annotations

from dataclasses import dataclass, fields

from tyrefrf.arrays import FloatArray, frozen


@dataclass(frozen=True, slots=True, eq=False)
class Certificate:
    """A run's lines solved once more; l loads and p probes, its arrays are read-only.

    solver: who solved k of the lines again. frequency: (k,) [Hz]. residual: (k,) its own.
    difference: (l, k) ||H' - H|| / ||H|| over the probes, NaN where it has no answer.
    cell_difference: (l, k) the largest ||q' - q|| / ||q|| of any cell, over its left section and
        interior; NaN where the run's own solver is truncated.
    n_cells: of the refined ring, which is the same but for twice the cells, or twice the elements
        around in every cell with grooves; 0 where there is none.
    refined_frequency: (m,) [Hz].
    level_change: (l, p, m) 20 log10 |H refined / H| [dB], NaN where the probe does not move. The
        change from refining around the axle alone: no bound of the discretisation error.
    left_out: why there is no refined ring; "" where there is one.
    """

    solver: str
    frequency: FloatArray
    residual: FloatArray
    difference: FloatArray
    cell_difference: FloatArray
    n_cells: int
    refined_frequency: FloatArray
    level_change: FloatArray
    left_out: str

    def __post_init__(self) -> None:
        for attribute in fields(self):
            if attribute.type == "FloatArray":
                frozen(getattr(self, attribute.name))
