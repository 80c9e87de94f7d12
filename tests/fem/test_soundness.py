"""What is said of matrices that another program assembled, and from which figure on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array

from tyrefrf.errors import MeshError
from tyrefrf.fem.soundness import Soundness, _check_mass

SOUND = Soundness(mass=(7.0, 7.0, 7.0), density=300.0, translation=1e-9, rotation=1e-9)


def test_sound_matrices_need_no_warning():
    assert SOUND.warnings() == ()
    nearly = replace(SOUND, mass=(7.0, 7.0 + 5e-6, 7.0), translation=9e-7, rotation=9e-7)
    assert nearly.warnings() == ()


def test_springs_to_the_ground_are_told_by_their_translations_whatever_rotations_say():
    (said,) = replace(SOUND, translation=2e-6, rotation=0.5).warnings()
    assert said == (
        "rigid translations strain the cell (K u is 2.0e-06 of |K| |u|): K has springs to the "
        "ground, or rows that were held are gone from it"
    )


def test_a_loaded_state_is_told_by_its_rotations_alone():
    (said,) = replace(SOUND, rotation=2e-6).warnings()
    assert said == (
        "rigid rotations strain the cell (K u is 2.0e-06 of |K| |u|), though translations do not: "
        "K holds the stress of a loaded state, or the rows or directions belong to other nodes "
        "than `dofs` and `nodes` say"
    )


@pytest.mark.parametrize("mass", [(7.0, 7.0, 6.9), (6.9, 7.0, 7.0), (7.0, 7.0, 7.0 + 9e-6)])
def test_a_mass_that_depends_on_the_direction_is_told(mass):
    (said,) = replace(SOUND, mass=mass).warnings()
    listed = ", ".join(f"{m:.6g}" for m in mass)
    assert said == (
        f"the mass is not the same along x, y and z: {listed} kg; rows that were held are gone "
        "from M"
    )


def mass_matrix(size: float, excess: float) -> csr_array:
    """Of two dofs, coupled by more than sqrt(M_11 M_22), in shares of the largest entry."""
    coupling = 2.0 + 4.0 * excess
    return csr_array(size * np.array([[1.0, coupling], [coupling, 4.0]]))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_a_motion_of_negative_kinetic_energy_is_found_in_the_coupling_alone(size):
    _check_mass(mass_matrix(size, 1e-10))  # rounding
    with pytest.raises(MeshError, match="M is no mass"):
        _check_mass(mass_matrix(size, 1e-8))


def test_a_small_negative_mass_is_none_beside_a_large_one():
    with pytest.raises(MeshError, match="M is no mass"):
        _check_mass(csr_array(np.diag([1.0, -1e-12])))
