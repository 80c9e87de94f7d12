"""The internal pressure and what is made of it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from tyrefrf.case.table import Table
from tyrefrf.case.units import STRESS, Quantity, zero_or_more


class Inflation(Table):
    """Pressure on the inner surface; the tyre vibrates about the shape that it gives."""

    pressure: Annotated[
        float, Quantity(STRESS, ge=0, le=1e8), AfterValidator(zero_or_more(1e-3, "Pa"))
    ] = Field(0.0, description="internal pressure above that outside [Pa]; 0: none")
    kind: Literal["linear", "nonlinear"] = Field(
        "linear",
        description="linear: stiffness on the shape at rest (the paper's); nonlinear: on the "
        "deformed shape, by Newton's method (hex20 and hex20r)",
    )
    pressure_stiffness: bool = Field(
        True,
        description="whether the pressure follows the surface as it turns; the paper leaves it out",
    )
