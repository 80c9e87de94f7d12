"""Responses by name, in the three quantities of ISO 7626-1, that cannot change under a reader."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import synthetic

from tyrefrf.errors import ResultsError
from tyrefrf.results import Results


@pytest.fixture
def made() -> Results:
    return synthetic.results()


def test_velocity_of_a_growing_phasor_leads_its_displacement(made):
    omega = 2.0 * np.pi * 500.0
    H, Y, A = (
        made.response("radial", "shoulder", quantity)[100]
        for quantity in ("receptance", "mobility", "accelerance")
    )
    assert pytest.approx(1j * omega * H) == Y
    assert pytest.approx(1j * omega * Y) == A


def test_a_response_is_the_one_of_its_names(made):
    expected = made.receptance[1, 4]
    np.testing.assert_array_equal(made.response("tangential", "far side", "receptance"), expected)


@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
def test_one_response_is_to_the_bit_that_among_all(made, quantity):
    one = made.response("tangential", "sidewall", quantity)
    every = getattr(made, quantity)
    np.testing.assert_array_equal(one, every[1, [p.name for p in made.probes].index("sidewall")])


def test_the_driving_point_is_the_probe_named_after_its_load(made):
    expected = made.mobility[1, 3]
    np.testing.assert_array_equal(made.driving_point("tangential"), expected)


def test_pairs_are_every_load_with_every_probe(made):
    assert len(made.pairs) == 16
    assert made.pairs[9] == ("tangential", "sidewall")


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (("radail", "shoulder"), "no load 'radail' in the results; did you mean 'radial'?"),
        (("radial", "sholder"), "no probe 'sholder' in the results; did you mean 'shoulder'?"),
        (("z", "shoulder"), "no load 'z' in the results; there are: radial, tangential"),
        (
            ("radial", "shoulder", "mobilty"),
            "no quantity 'mobilty' in the results; did you mean 'mobility'?",
        ),
    ],
)
def test_a_wrong_name_is_answered_with_the_right_one(made, names, message):
    with pytest.raises(ResultsError) as error:
        made.response(*names)
    assert str(error.value) == message


def test_a_load_without_a_driving_point_says_so(made):
    lonely = replace(made, probes=made.probes[:2], receptance=made.receptance[:, :2])
    with pytest.raises(ResultsError, match=r"no probe 'radial\.drive'"):
        lonely.driving_point("radial")


def test_lines_without_an_answer_are_counted(made):
    failed = synthetic.with_failed(made, 0, 400)
    assert made.n_failed == 0
    assert failed.n_failed == 2
    assert np.flatnonzero(failed.failed).tolist() == [0, 400]


@pytest.mark.parametrize("name", ["frequency", "receptance", "blocked_force", "residual"])
def test_arrays_are_read_only(made, name):
    with pytest.raises(ValueError, match="read-only"):
        getattr(made, name)[...] = 0.0


@pytest.mark.parametrize("name", ["receptance", "blocked_force", "solved", "remark"])
def test_shapes_that_disagree_are_refused(made, name):
    with pytest.raises(ResultsError, match=name):
        replace(made, **{name: getattr(made, name)[:1]})


def test_hdf5_is_imported_only_when_a_file_is_read_or_written():
    code = "import sys, tyrefrf.results; sys.exit('h5py' in sys.modules)"
    command = [sys.executable, "-c", code]
    assert subprocess.run(command, check=False, cwd=Path(__file__).parents[2]).returncode == 0
