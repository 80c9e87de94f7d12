"""Complex Young's moduli that depend on frequency, for the phasor exp(+i omega t).

All are passive: E has no negative imaginary part for omega > 0.
Source: Tschoegl, The Phenomenological Theory of Linear Viscoelastic Behavior (1989), chapter 3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from tyrefrf.case import ModulusLaw, Viscoelastic


class Modulus(Protocol):
    """E(omega) = static * scale(omega)."""

    @property
    def static(self) -> float:
        """The real modulus that the others are relative to [Pa]: that at 0 Hz."""
        ...

    def scale(self, omega: float) -> complex:
        """E(omega)/static; omega [rad/s], zero or positive."""
        ...


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant loss factor: E (1 + i eta), hysteretic, at 0 Hz too."""

    static: float
    eta: float

    def scale(self, omega: float) -> complex:
        """1 + i eta."""
        return 1.0 + 1j * self.eta


@dataclass(frozen=True, slots=True)
class Tabled:
    """Rows of frequency [Hz], storage modulus [Pa] and loss factor; the end rows hold beyond.

    Between the rows log E and eta are linear in log f.
    """

    frequencies: tuple[float, ...]
    E: tuple[float, ...]
    eta: tuple[float, ...]

    @property
    def static(self) -> float:
        """The first row's."""
        return self.E[0]

    def scale(self, omega: float) -> complex:
        """E (1 + i eta) of the interpolated row."""
        log_f = math.log(max(omega / (2.0 * math.pi), self.frequencies[0]))
        rows = np.log(self.frequencies)
        E = float(np.exp(np.interp(log_f, rows, np.log(self.E))))
        eta = float(np.interp(log_f, rows, self.eta))
        return E / self.static * (1.0 + 1j * eta)


@dataclass(frozen=True, slots=True)
class Prony:
    """E_0 (1 - sum of g/(1 + i omega tau)): a generalised Maxwell model.

    E_0: instantaneous modulus [Pa]; g: share of E_0 that each term relaxes; tau: its time [s].
    """

    E_0: float
    g: tuple[float, ...]
    tau: tuple[float, ...]

    @property
    def static(self) -> float:
        """E_inf, what is left when all terms have relaxed."""
        return self.E_0 * (1.0 - sum(self.g))

    def scale(self, omega: float) -> complex:
        """1 + E_0/E_inf sum of g i omega tau/(1 + i omega tau)."""
        x = 1j * omega * np.array(self.tau)
        return complex(1.0 + self.E_0 / self.static * np.sum(np.array(self.g) * x / (1.0 + x)))


@dataclass(frozen=True, slots=True)
class Zener:
    """The fractional Zener model, (E_0 + E_inf x)/(1 + x) with x = (i omega tau)^alpha.

    E_0: modulus at 0 Hz [Pa]; E_inf >= E_0: limit of high frequency [Pa]; 0 < alpha <= 1.
    Source: Pritz, Analysis of four-parameter fractional derivative model of real solid materials,
    J. Sound Vib. 195 (1996), 103-115.
    """

    E_0: float
    E_inf: float
    tau: float
    alpha: float

    @property
    def static(self) -> float:
        """E_0."""
        return self.E_0

    def scale(self, omega: float) -> complex:
        """1 + (E_inf/E_0 - 1) x/(1 + x)."""
        x = (1j * omega * self.tau) ** self.alpha
        return 1.0 + (self.E_inf / self.E_0 - 1.0) * x / (1.0 + x)


@dataclass(frozen=True, slots=True)
class Shifted:
    """Another modulus at another temperature: E(a_T omega)."""

    at_reference: Modulus
    a_T: float

    @property
    def static(self) -> float:
        """The same at every temperature."""
        return self.at_reference.static

    def scale(self, omega: float) -> complex:
        """That of the shifted frequency."""
        return self.at_reference.scale(self.a_T * omega)


def modulus_of(stuff: Viscoelastic) -> Modulus:
    """The complex Young's modulus of a material of the case."""
    if stuff.modulus is None:
        assert stuff.E is not None  # the case's rules saw to it
        return Constant(stuff.E, stuff.eta)
    return modulus_by_law(stuff.modulus)


def modulus_by_law(law: ModulusLaw) -> Modulus:
    """A law of the case at the temperature of the tyre."""
    modulus = _at_reference(law)
    return Shifted(modulus, law.shift.factor) if law.shift else modulus


def _at_reference(law: ModulusLaw) -> Modulus:
    """A law of the case at the temperature of its measurement."""
    match law.kind:
        case "table":
            return Tabled(law.frequencies, law.E, law.eta)
        case "prony":
            relaxed = 1.0 - sum(law.g)
            E_0 = law.E_0 if law.E_inf is None else law.E_inf / relaxed
            assert E_0 is not None  # the case's rules saw to it
            return Prony(E_0, law.g, law.tau)
        case "zener":
            return Zener(law.E_0, law.E_inf, law.tau, law.alpha)
