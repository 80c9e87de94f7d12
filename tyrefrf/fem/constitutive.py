"""Materials of a case as the elements see them: elasticity in the layer's axes, and density.

The axes of a layer are 1 around the tyre, 2 along the profile, 3 through the thickness; where
they point in a brick is `fem.orientation`'s.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from tyrefrf.arrays import ComplexArray, FloatArray
from tyrefrf.fem.elasticity import isotropic, orthotropic
from tyrefrf.fem.plies import Solid, homogenised, in_layer, ply_elasticity
from tyrefrf.fem.viscoelastic import Constant, Modulus, modulus_of

if TYPE_CHECKING:
    from tyrefrf.case import Isotropic, Material, Orthotropic, Ply, Transverse


class Constitutive(Protocol):
    """What a material is made of, mechanically."""

    @property
    def rho(self) -> float:
        """Density [kg/m3]."""
        ...

    @property
    def is_isotropic(self) -> bool:
        """Whether the elasticity is the same along all axes."""
        ...

    @property
    def size(self) -> float:
        """What `form` is multiplied by."""
        ...

    @property
    def form(self) -> FloatArray:
        """Loss-free elasticity (6, 6) of vibration over its size: the same for all moduli E."""
        ...

    @property
    def reference(self) -> FloatArray:
        """Loss-free elasticity (6, 6) [Pa] of vibration: at 0 Hz, without the loss factor."""
        ...

    @property
    def static(self) -> FloatArray:
        """Elasticity (6, 6) [Pa] of inflation."""
        ...

    def elasticity(self, omega: float) -> ComplexArray:
        """Complex elasticity (6, 6) [Pa]; omega [rad/s]."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Scaled:
    """A material whose elasticity only changes its scale: C(omega) = modulus.scale(omega) C."""

    rho: float
    form: FloatArray
    static: FloatArray
    modulus: Modulus
    is_isotropic: bool
    size: float = 1.0

    @property
    def reference(self) -> FloatArray:
        """The form in its size."""
        return self.size * self.form

    def elasticity(self, omega: float) -> ComplexArray:
        """The scaled reference."""
        return self.modulus.scale(omega) * self.reference


@dataclass(frozen=True, slots=True, eq=False)
class Laminate:
    """Plies of elastic cords in lossy rubber: their elasticity changes its form with frequency.

    volume_fraction: of the cords in every ply. angles: of each ply's cords [rad]. shares: of the
    thickness, their sum 1. E_static: the rubber's modulus for inflation [Pa].
    """

    rho: float
    cord: Solid
    rubber: Modulus
    nu: float
    volume_fraction: float
    angles: tuple[float, ...]
    shares: tuple[float, ...]
    E_static: float

    @property
    def is_isotropic(self) -> bool:
        """Never known to be."""
        return False

    @property
    def size(self) -> float:
        """The form is the reference."""
        return 1.0

    @property
    def form(self) -> FloatArray:
        """With the rubber's real modulus at 0 Hz."""
        return self._with_rubber(self.rubber.static).real

    @property
    def reference(self) -> FloatArray:
        """The same."""
        return self.form

    @property
    def static(self) -> FloatArray:
        """With the rubber's modulus for inflation."""
        return self._with_rubber(self.E_static).real

    def elasticity(self, omega: float) -> ComplexArray:
        """With the rubber's complex modulus."""
        return self._with_rubber(self.rubber.static * self.rubber.scale(omega))

    def _with_rubber(self, E: complex) -> ComplexArray:
        """Of the layer, with rubber of modulus E [Pa]."""
        C = ply_elasticity(self.cord, Solid(complex(E), self.nu), self.volume_fraction)
        return homogenised([in_layer(C, angle) for angle in self.angles], self.shares)


def constitutive(stuff: Material) -> Constitutive:
    """The constitutive law of a material of the case."""
    match stuff.kind:
        case "isotropic":
            return _isotropic(stuff)
        case "orthotropic":
            return _orthotropic(stuff)
        case "transverse":
            return _transverse(stuff)
        case "ply":
            return _laminate(stuff)


def _isotropic(stuff: Isotropic) -> Scaled:
    modulus = modulus_of(stuff)
    E_static = modulus.static if stuff.E_static is None else stuff.E_static
    return Scaled(
        rho=stuff.rho,
        form=isotropic(1.0, stuff.nu),
        static=isotropic(E_static, stuff.nu),
        modulus=modulus,
        is_isotropic=True,
        size=modulus.static,
    )


def _orthotropic(stuff: Orthotropic) -> Scaled:
    C = orthotropic(
        (stuff.E_1, stuff.E_2, stuff.E_3),
        (stuff.nu_12, stuff.nu_13, stuff.nu_23),
        (stuff.G_12, stuff.G_13, stuff.G_23),
    )
    return _turned(stuff, C)


def _transverse(stuff: Transverse) -> Scaled:
    C = orthotropic(
        (stuff.E_1, stuff.E_2, stuff.E_2),
        (stuff.nu_12, stuff.nu_12, stuff.nu_23),
        (stuff.G_12, stuff.G_12, stuff.E_2 / (2.0 * (1.0 + stuff.nu_23))),
    )
    return _turned(stuff, C)


def _turned(stuff: Orthotropic | Transverse, C: FloatArray) -> Scaled:
    """With elasticity C (6, 6) in the material's axes."""
    turned = in_layer(C, float(np.deg2rad(stuff.angle)))
    return Scaled(
        rho=stuff.rho,
        form=turned,
        static=turned,
        modulus=Constant(1.0, stuff.eta),
        is_isotropic=False,
    )


def _laminate(stuff: Ply) -> Laminate:
    rubber, v_f = modulus_of(stuff.rubber), stuff.volume_fraction
    shares = np.array(stuff.shares or [1.0] * len(stuff.angles))
    return Laminate(
        rho=v_f * stuff.cord.rho + (1.0 - v_f) * stuff.rubber.rho,
        cord=Solid(stuff.cord.E, stuff.cord.nu),
        rubber=rubber,
        nu=stuff.rubber.nu,
        volume_fraction=v_f,
        angles=tuple(float(a) for a in np.deg2rad(stuff.angles)),
        shares=tuple(float(share) for share in shares / shares.sum()),
        E_static=rubber.static if stuff.rubber.E_static is None else stuff.rubber.E_static,
    )
