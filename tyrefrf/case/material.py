"""Materials: isotropic, orthotropic, transversely isotropic, and plies of cords in rubber.

The axes of a layer are the circumferential, the profile's and the thickness direction at every
point (`fem.orientation`). Material axis 1, the cord's, lies in the layer at `angle` from the
circumferential direction (growing theta), turned towards the profile direction (from the rim at
y < 0 to the rim at y > 0); axis 2 lies in the layer across it, axis 3 through the thickness.
Poisson's ratio nu_12 is the contraction along 2 over the stretch along 1, under stress along 1.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, Tag

from tyrefrf.case.faults import Fault, number_text, refusal
from tyrefrf.case.modulus import LossFactor, Modulus, ModulusLaw
from tyrefrf.case.table import Table, by_kind
from tyrefrf.case.units import ANGLE, DENSITY, Quantity

Density = Annotated[float, Quantity(DENSITY, ge=1e-3, le=1e6)]
"""From what is lighter than any foam to what is heavier than any metal."""
Angle = Annotated[float, Quantity(ANGLE, ge=-90, le=90)]

MOST_APART = 1e10
"""Largest modulus of one material over its smallest, up to which 16 digits hold both."""

_LEAST_DET = 1e-8  # of the compliance scaled to ones: that of an isotropic nu of 0.499999998

_RHO = "density [kg/m3]"
_ETA = "loss factor [-]"
_NU = "Poisson's ratio [-]"
_ANGLE = (
    "angle of axis 1 from the circumferential direction [deg], turned towards the profile "
    "direction (rim at y < 0 to rim at y > 0)"
)


def _with_digits_left(nu: float) -> float:
    """Refuse a nu that leaves no digits to the softer stiffness, of volume or of shape."""
    least, most = -0.9999999, 0.4999999
    if not least <= nu <= most:
        end = "0.5" if nu > 0.0 else "-1"
        message = f"{nu!r} is too near to {end}; must be from {least} to {most}"
        raise refusal(Fault((), message))
    return nu


PoissonsRatio = Annotated[float, Field(gt=-1, lt=0.5), AfterValidator(_with_digits_left)]
"""Of an isotropic material."""


class Viscoelastic(Table):
    """An isotropic solid with a constant nu: K (1 + i eta), or K scaled by a complex modulus."""

    E: Modulus | None = Field(None, description="Young's modulus [Pa]")
    nu: PoissonsRatio = Field(description=_NU)
    rho: Density = Field(description=_RHO)
    eta: LossFactor = Field(0.0, description=_ETA)
    modulus: ModulusLaw | None = Field(
        None, description="complex modulus that depends on frequency, instead of E and eta"
    )
    E_static: Modulus | None = Field(
        None, description="Young's modulus for inflation [Pa]; default: E, or the modulus at 0 Hz"
    )

    def _faults(self) -> Iterator[Fault]:
        if self.modulus is None:
            if self.E is None:
                yield Fault(("E",), "missing: Young's modulus [Pa]")
            return
        for key in ("E", "eta"):
            if getattr(self, key) != type(self).model_fields[key].default:
                yield Fault((key,), f"not together with modulus, which gives {key}")


class Isotropic(Viscoelastic):
    """An isotropic material."""

    # Not written out: a case without other kinds reads, and hashes, as it did before they came.
    kind: Literal["isotropic"] = Field(
        "isotropic", exclude=True, description="the same in all directions"
    )


class Orthotropic(Table):
    """An orthotropic material in the layer's axes, turned by `angle`; K (1 + i eta)."""

    kind: Literal["orthotropic"] = Field(description="orthotropic in the layer's axes")
    E_1: Modulus = Field(description="Young's modulus along axis 1 [Pa]")
    E_2: Modulus = Field(description="Young's modulus along axis 2 [Pa]")
    E_3: Modulus = Field(description="Young's modulus along axis 3, through the thickness [Pa]")
    nu_12: float = Field(description=f"{_NU}: contraction along 2 under stress along 1")
    nu_13: float = Field(description=f"{_NU}: contraction along 3 under stress along 1")
    nu_23: float = Field(description=f"{_NU}: contraction along 3 under stress along 2")
    G_12: Modulus = Field(description="shear modulus in the layer's plane [Pa]")
    G_13: Modulus = Field(description="shear modulus between axes 1 and 3 [Pa]")
    G_23: Modulus = Field(description="shear modulus between axes 2 and 3 [Pa]")
    rho: Density = Field(description=_RHO)
    eta: LossFactor = Field(0.0, description=_ETA)
    angle: Angle = Field(0.0, description=_ANGLE)

    def _faults(self) -> Iterator[Fault]:
        E = {"1": self.E_1, "2": self.E_2, "3": self.E_3}
        yield from indefinite(E, {"12": self.nu_12, "13": self.nu_13, "23": self.nu_23})
        yield from _too_far_apart(self, ("E_1", "E_2", "E_3", "G_12", "G_13", "G_23"))


class Transverse(Table):
    """Transversely isotropic about axis 1, the fibres'; K (1 + i eta)."""

    kind: Literal["transverse"] = Field(description="transversely isotropic about axis 1")
    E_1: Modulus = Field(description="Young's modulus along the fibres [Pa]")
    E_2: Modulus = Field(description="Young's modulus across the fibres [Pa]")
    nu_12: float = Field(description=f"{_NU}: contraction across the fibres, stress along them")
    nu_23: float = Field(gt=-1, lt=1, description=f"{_NU} in the plane across the fibres")
    G_12: Modulus = Field(description="shear modulus along the fibres [Pa]")
    rho: Density = Field(description=_RHO)
    eta: LossFactor = Field(0.0, description=_ETA)
    angle: Angle = Field(0.0, description=_ANGLE)

    def _faults(self) -> Iterator[Fault]:
        E = {"1": self.E_1, "2": self.E_2, "3": self.E_2}
        nu = {"12": self.nu_12, "13": self.nu_12, "23": self.nu_23}
        yield from (fault for fault in indefinite(E, nu) if fault.key != ("nu_13",))
        yield from _too_far_apart(self, ("E_1", "E_2", "G_12"))


class Cord(Table):
    """The cords of a ply: isotropic and free of loss."""

    E: Modulus = Field(description="Young's modulus [Pa]")
    nu: PoissonsRatio = Field(description=_NU)
    rho: Density = Field(description=_RHO)


Share = Annotated[float, Field(ge=1e-6, le=1e6)]


class Ply(Table):
    """Plies of parallel cords in rubber, stacked through the layer's thickness.

    Each ply's constants come from cord and rubber by Halpin and Tsai's equations, the layer's
    from its plies by homogenisation (`fem.plies`).
    """

    kind: Literal["ply"] = Field(description="cords in rubber, in one or more plies")
    cord: Cord = Field(description="the cords")
    rubber: Viscoelastic = Field(description="the rubber around the cords")
    volume_fraction: float = Field(gt=0, lt=1, description="volume of cords in that of a ply [-]")
    angles: Annotated[tuple[Angle, ...], Field(strict=False, min_length=1, max_length=100)] = Field(
        description="angle of each ply's cords from the circumferential direction [deg], turned "
        "towards the profile direction (rim at y < 0 to rim at y > 0)"
    )
    shares: Annotated[tuple[Share, ...], Field(strict=False)] | None = Field(
        None, description="thickness of each ply relative to the others; default: all equal"
    )

    def _faults(self) -> Iterator[Fault]:
        if self.shares is not None and len(self.shares) != len(self.angles):
            found = f"has {len(self.shares)} entries"
            yield Fault(("shares",), f"{found}; must have {len(self.angles)}, as many as angles")


Material = Annotated[
    Annotated[Isotropic, Tag("isotropic")]
    | Annotated[Orthotropic, Tag("orthotropic")]
    | Annotated[Transverse, Tag("transverse")]
    | Annotated[Ply, Tag("ply")],
    by_kind("isotropic"),
]


def indefinite(E: dict[str, float], nu: dict[str, float]) -> Iterator[Fault]:
    """Yield why these constants store no positive energy.

    E: by axis "1", "2", "3"; nu: by pair "12", "13", "23".
    Source: Lempriere, Poisson's ratio in orthotropic materials, AIAA J. 6 (1968), 2226-2227.
    """
    over = {(i, j): nu[i + j] * math.sqrt(E[j] / E[i]) for i, j in combinations("123", 2)}
    wild = [pair for pair, ratio in over.items() if abs(ratio) >= 1.0]
    for i, j in wild:
        limit = number_text(math.sqrt(E[i] / E[j]))
        yield Fault(
            (f"nu_{i}{j}",),
            f"{number_text(nu[i + j])} is out of range; with these E_{i} and E_{j} its size must "
            f"be below sqrt(E_{i}/E_{j}) = {limit}",
        )
    a, b, c = over.values()
    det = 1.0 - a * a - b * b - c * c - 2.0 * a * b * c
    if det <= _LEAST_DET and not wild:
        definite = "not positive definite" if det <= 0.0 else "hardly positive definite"
        least = 0.0 if det <= 0.0 else _LEAST_DET
        yield Fault(
            (),
            f"the stiffness is {definite}: 1 - nu_12 nu_21 - nu_23 nu_32 - nu_13 nu_31 "
            f"- 2 nu_12 nu_23 nu_31 = {det:.3g} must be above {least:g}; make a Poisson's ratio "
            "smaller",
        )


def _too_far_apart(stuff: Table, names: Sequence[str]) -> Iterator[Fault]:
    """Yield why the largest of a material's moduli would take all digits from the smallest."""
    moduli = {name: getattr(stuff, name) for name in names}
    softest = min(moduli, key=moduli.__getitem__)
    stiffest = max(moduli, key=moduli.__getitem__)
    if moduli[stiffest] > MOST_APART * moduli[softest]:
        limit = f"must be at most {MOST_APART:g} times {softest} = {number_text(moduli[softest])}"
        yield Fault((stiffest,), f"{number_text(moduli[stiffest])} Pa is too stiff; {limit} Pa")
