"""A parameter's values along an axis of a sweep, and how they are written."""

from __future__ import annotations

from dataclasses import dataclass

_PREFIXED = {
    "Pa": (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)),
    "m": (("m", 1.0), ("mm", 1e-3)),
    "s": (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)),
}
"""Units in which a value is short, largest first."""


@dataclass(frozen=True, slots=True)
class Axis:
    """The values of one parameter.

    name: short, as `E_rubber`. place: in the case, as `materials.rubber.E`.
    units: of the values, the unit of a bare number in a case file; "1" for none.
    meaning: in words. values: in the order in which they were given.
    """

    name: str
    place: str
    units: str
    meaning: str
    values: tuple[float, ...]

    @property
    def scale(self) -> tuple[str, float]:
        """The unit in which these values are written, and its size; the same for all of them."""
        largest = max(map(abs, self.values))
        fitting = [unit for unit in _PREFIXED.get(self.units, ()) if unit[1] <= largest]
        return fitting[0] if fitting else (self.units, 1.0)

    def text(self, index: int) -> str:
        """A value with its unit: `28 MPa`."""
        unit, size = self.scale
        number = f"{self.values[index] / size:.6g}"
        return number if unit == "1" else f"{number} {unit}"

    def label(self, index: int) -> str:
        """A value with the parameter's name: `E_rubber = 28 MPa`."""
        return f"{self.name} = {self.text(index)}"


def number_of(value: object) -> float | None:
    """The value if it is a number, which true and false are not."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return value
