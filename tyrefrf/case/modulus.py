"""Moduli that depend on frequency: tables, Prony series, fractional Zener; and their WLF shift."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, Tag

from tyrefrf.case.faults import Fault
from tyrefrf.case.table import Table, by_kind
from tyrefrf.case.units import FREQUENCY, STRESS, TIME, Quantity, Units

CELSIUS: Units = {"degC": "1"}
KELVIN: Units = {"K": "1"}
MAX_DECADES = 30.0
"""Decades that a shift may span: more is a slip of the pen near the formula's pole."""

Modulus = Annotated[float, Quantity(STRESS, ge=1.0, le=1e15)]
"""From what is softer than any gel to what is stiffer than any solid: diamond has 1.2e12 Pa."""
LossFactor = Annotated[float, Field(ge=0, le=100)]
Seconds = Annotated[float, Quantity(TIME, ge=1e-15, le=1e15)]
Hertz = Annotated[float, Quantity(FREQUENCY, ge=1e-15, le=1e15)]
Temperature = Annotated[float, Quantity(CELSIUS, ge=-273.15, le=1e4)]


class Shift(Table):
    """Time-temperature superposition after Williams, Landel and Ferry (1955).

    E(f, temperature) = E(a_T f, T_ref) with log10 a_T = -C1 (T - T_ref)/(C2 + T - T_ref).
    """

    C1: float = Field(gt=0, le=1e4, description="first constant of Williams, Landel and Ferry [-]")
    C2: Annotated[float, Quantity(KELVIN, ge=1e-3, le=1e4)] = Field(
        description="second constant [K]"
    )
    T_ref: Temperature = Field(description="temperature at which the modulus was measured [degC]")
    temperature: Temperature = Field(description="temperature of the tyre [degC]")

    @property
    def factor(self) -> float:
        """a_T: what the frequency is multiplied by."""
        return float(10.0**self._decades)

    @property
    def _decades(self) -> float:
        warmer = self.temperature - self.T_ref
        return -self.C1 * warmer / (self.C2 + warmer)

    def _faults(self) -> Iterator[Fault]:
        lowest = self.T_ref - self.C2
        if self.temperature <= lowest:
            yield Fault(
                ("temperature",),
                f"{self.temperature:.6g} degC is too cold for the shift; "
                f"must be above T_ref - C2 = {lowest:.6g} degC",
            )
        elif abs(self._decades) > MAX_DECADES:
            yield Fault(
                ("temperature",),
                f"{self.temperature:.6g} degC shifts the frequency by {self._decades:.3g} decades; "
                f"must be at most {MAX_DECADES:g}",
            )


class Law(Table):
    """A complex modulus E' + i E'' that depends on frequency."""

    shift: Shift | None = Field(None, description="shift of the frequency by temperature (WLF)")


class TabledModulus(Law):
    """Measured storage modulus and loss factor: rows of frequency, E and eta.

    Between the rows log E and eta are linear in log f.
    """

    kind: Literal["table"] = Field(description="rows of frequency, E and eta")
    frequencies: Annotated[tuple[Hertz, ...], Field(strict=False, min_length=2)] = Field(
        description="frequencies of the rows [Hz], increasing"
    )
    E: Annotated[tuple[Modulus, ...], Field(strict=False)] = Field(
        description="storage modulus of each row [Pa]"
    )
    eta: Annotated[tuple[LossFactor, ...], Field(strict=False)] = Field(
        description="loss factor of each row [-]"
    )
    extrapolate: bool = Field(
        False, description="whether the first and the last row hold beyond the table"
    )

    def _faults(self) -> Iterator[Fault]:
        for i, (before, here) in enumerate(pairwise(self.frequencies), start=1):
            if here <= before:
                found = f"{here:.10g} Hz after {before:.10g} Hz"
                yield Fault(("frequencies", i), f"{found}; list the rows in increasing order")
                break
        yield from _lengths(len(self.frequencies), "frequencies", E=self.E, eta=self.eta)


class PronySeries(Law):
    """A generalised Maxwell model: E(omega) = E_inf + E_0 sum of g i omega tau/(1 + i omega tau).

    E_inf = E_0 (1 - sum of g); as in the time domain, E_0 is the modulus at t = 0.
    """

    kind: Literal["prony"] = Field(description="Prony series (generalised Maxwell model)")
    E_0: Modulus | None = Field(
        None, description="instantaneous modulus [Pa], the limit of high frequency"
    )
    E_inf: Modulus | None = Field(None, description="relaxed modulus [Pa], the modulus at 0 Hz")
    g: Annotated[
        tuple[Annotated[float, Field(gt=0, lt=1)], ...], Field(strict=False, min_length=1)
    ] = Field(description="share of E_0 that each term relaxes [-]")
    tau: Annotated[tuple[Seconds, ...], Field(strict=False)] = Field(
        description="relaxation time of each term [s]"
    )

    def _faults(self) -> Iterator[Fault]:
        if self.E_0 is None and self.E_inf is None:
            yield Fault((), "has no modulus; give E_inf (at 0 Hz) or E_0 (instantaneous)")
        if self.E_0 is not None and self.E_inf is not None:
            yield Fault(("E_0",), "not together with E_inf; g gives one from the other")
        if sum(self.g) >= 1.0:
            found = f"the terms relax {sum(self.g):.6g} of E_0"
            yield Fault(("g",), f"{found}; their sum must be below 1")
        yield from _lengths(len(self.g), "g", tau=self.tau)


class FractionalZener(Law):
    """E(omega) = (E_0 + E_inf (i omega tau)^alpha)/(1 + (i omega tau)^alpha).

    As in the frequency domain, E_0 is the modulus at 0 Hz.
    """

    kind: Literal["zener"] = Field(description="fractional Zener model")
    E_0: Modulus = Field(description="static modulus [Pa], the modulus at 0 Hz")
    E_inf: Modulus = Field(description="modulus in the limit of high frequency [Pa]")
    tau: Seconds = Field(description="relaxation time [s]")
    alpha: float = Field(1.0, gt=0, le=1, description="order of the derivative [-]; 1: Zener's own")

    def _faults(self) -> Iterator[Fault]:
        if self.E_inf < self.E_0:
            found = f"{self.E_inf:.6g} Pa is too small; must be at least E_0 = {self.E_0:.6g} Pa"
            yield Fault(("E_inf",), f"{found}: a passive material stiffens with frequency")


ModulusLaw = Annotated[
    Annotated[TabledModulus, Tag("table")]
    | Annotated[PronySeries, Tag("prony")]
    | Annotated[FractionalZener, Tag("zener")],
    by_kind(None),
]


def _lengths(n: int, of: str, **lists: tuple[float, ...]) -> Iterator[Fault]:
    for name, values in lists.items():
        if len(values) != n:
            yield Fault((name,), f"has {len(values)} entries; must have {n}, as many as {of}")
