"""Static point loads: displacements of all ring nodes as CalculiX 2.20 prints them.

Radial, tangential and axial unit force at the crown of section 0 of the 45-cell ring, solved by
the recursion at 0 Hz without losses.
"""

from __future__ import annotations

import numpy as np
import pytest
from reference.calculix import (
    BRICK,
    LOADS,
    arrays,
    cartesian,
    facts,
    needs_reference,
    ring,
    their_loads,
)
from rings import by_recursion

from tyrefrf.fem.elements import ELEMENTS

pytestmark = needs_reference

DIGITS = 7  # ccx prints 7 significant digits
HALF_A_UNIT = 0.501 * 10.0 ** (1 - DIGITS)  # of the last digit; 0.500 and our rounding
ROUNDING = 1e-17  # of both solutions [m]; the largest displacement is 1.8e-5 m, and 1e6 x eps of it
CASES = {
    "A_C3D8I": BRICK,
    "A_C3D20-curved": ELEMENTS["hex20"],
    "A_C3D20-straight": ELEMENTS["hex20"],
    "A_C3D20R-curved": ELEMENTS["hex20r"],
    "A_C3D20R-straight": ELEMENTS["hex20r"],
}


@pytest.mark.parametrize("name", CASES)
def test_static_deflections_to_the_printed_digits(name):
    tyre = ring(name, CASES[name], eta=0.0)
    reference = arrays(name)
    printed = np.array([reference[f"static_{load}"] for load in LOADS])
    loads = their_loads(tyre, facts(name)["info"]["drive_node"])

    u = cartesian(tyre, by_recursion(tyre.problem(loads), 0.0))

    decade = 10.0 ** np.floor(np.log10(np.maximum(np.abs(printed), np.finfo(float).tiny)))
    np.testing.assert_array_less(np.abs(u - printed), HALF_A_UNIT * decade + 2.0 * ROUNDING)
    assert np.abs(u.imag).max() < ROUNDING  # orders are complex, and their sum is not
