"""Whether a tyre at rest is stable: no direction in which its static stiffness is negative.

A forced response about a buckled state solves its equations to rounding, and takes power at every
driving point: no proof of a line can tell it. But the tyre has left that state. So the negative
eigenvalues of the loss-free K + K_G + K_P are counted at every order before a line is solved.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from tyrefrf.fem.assembly import CellMatrices
from tyrefrf.solvers.inertia import unstable_orders

HALVINGS = 14  # of the load that a tyre bears: four digits


@dataclass(frozen=True, slots=True)
class Instability:
    """Where the static stiffness of a ring is indefinite.

    counts: negative eigenvalues by circumferential order h, h and N - h counted once. share: of
    K_G + K_P that the ring bears; 0 where K alone is indefinite.
    """

    counts: Mapping[int, int]
    share: float

    @property
    def words(self) -> str:
        """As "indefinite at circumferential order 2 (1 negative eigenvalue), 3 (2)"."""
        (first, count), *others = self.counts.items()
        plural = "s" if count > 1 else ""
        return (
            f"indefinite at circumferential order {first} ({count} negative eigenvalue{plural})"
            + "".join(f", {h} ({n})" for h, n in others)
        )


def instability(cell: CellMatrices, n_cells: int) -> Instability | None:
    """Where the static stiffness of a ring of cells is indefinite; None where it is stable."""
    counts = unstable_orders(cell, n_cells)
    return Instability(counts, _share_borne(cell, n_cells, counts)) if counts else None


def _share_borne(cell: CellMatrices, n_cells: int, orders: Mapping[int, int]) -> float:
    """The largest share of K_G + K_P at which none of the orders is indefinite.

    All that is smaller is stable too: the stiffnesses between two stable ones are.
    """

    def bears(share: float) -> bool:
        less = replace(cell, K_G=share * cell.K_G, K_P=share * cell.K_P)
        return not unstable_orders(less, n_cells, orders)

    if not bears(0.0):
        return 0.0
    stable, unstable = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (stable + unstable) / 2.0
        stable, unstable = (middle, unstable) if bears(middle) else (stable, middle)
    return stable
