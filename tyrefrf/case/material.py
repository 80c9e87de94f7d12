"""Materials: linear, isotropic, with a loss factor of their own."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from tyrefrf.case.table import Table
from tyrefrf.case.units import DENSITY, STRESS, Quantity


class Material(Table):
    """An isotropic material; its stiffness is K (1 + i eta)."""

    E: Annotated[float, Quantity(STRESS, gt=0)] = Field(description="Young's modulus [Pa]")
    nu: float = Field(gt=-1, lt=0.5, description="Poisson's ratio [-]")
    rho: Annotated[float, Quantity(DENSITY, gt=0)] = Field(description="density [kg/m3]")
    eta: float = Field(0.0, ge=0, description="loss factor [-]")
