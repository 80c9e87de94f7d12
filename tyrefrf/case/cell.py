"""The angular cell that the tyre repeats around its axle."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from tyrefrf.case.faults import Fault, refusal
from tyrefrf.case.table import Table
from tyrefrf.case.units import ANGLE, Quantity

MAX_CELLS = 100_000
ROUND_OFF = 1e-9  # an angle written with ten digits, such as 7.058823529, divides 360

Element = Literal["hex8i", "hex8", "hex20", "hex20r"]


def _divides_the_turn(angle: float) -> float:
    count = 360 / angle
    if count > MAX_CELLS * (1 + ROUND_OFF):
        limit = f"at least {360 / MAX_CELLS:.10g} deg ({MAX_CELLS} cells)"
        raise refusal(Fault((), f"{angle:.10g} deg is too small; must be {limit}"))
    if abs(round(count) * angle - 360) > 360 * ROUND_OFF:
        n = _nearest_count(angle)
        nearest = f"nearest: {360 / n:.10g} deg ({n} cell{'s' if n > 1 else ''})"
        raise refusal(Fault((), f"{angle:.10g} deg does not divide 360 deg; {nearest}"))
    return angle


def _nearest_count(angle: float) -> int:
    """Return the number of cells nearest to `angle`, if possible with a short decimal.

    7 deg -> 50 (7.2 deg), rather than 51 (7.058823529 deg).
    """
    count = 360 / angle
    near = range(max(1, int(0.9 * count)), min(MAX_CELLS, int(1.1 * count) + 1) + 1)
    short = [n for n in near if 360_000 % n == 0]
    return min(short or near, key=lambda n: abs(360 / n - angle))


class Cell(Table):
    """One angular cell; 360/sector_angle of them make the tyre."""

    sector_angle: Annotated[
        float, Quantity(ANGLE, gt=0, le=360), AfterValidator(_divides_the_turn)
    ] = Field(description="angle of a cell [deg]; divides 360 deg")
    elements_around: int = Field(1, ge=1, le=100, description="elements around, in one cell")
    element: Element = Field(
        "hex8i",
        description="hex8i: brick with incompatible modes (the paper's); hex8: B-bar brick; "
        "hex20, hex20r: quadratic brick, fully or reduced integrated",
    )

    @property
    def n_cells(self) -> int:
        """Number of cells around the tyre."""
        return round(360 / self.sector_angle)

    def _faults(self) -> Iterator[Fault]:
        needed = -(-3 // self.n_cells)
        if self.elements_around < needed:
            yield Fault(
                ("elements_around",),
                f"{self.n_cells * self.elements_around} elements around the tyre enclose "
                f"no volume; must be at least {needed} with {self.n_cells} cell(s)",
            )
