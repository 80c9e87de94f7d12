"""A comparison in memory and in its file: every solver's answers, and what they took."""

from __future__ import annotations

from dataclasses import fields, replace

import h5py
import numpy as np
import pytest
import synthetic
import xarray
from hdf5 import undescribed

import tyrefrf
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results import (
    Comparison,
    StaticState,
    load_any,
    load_comparison,
    load_results,
    write_comparison,
    write_results,
)
from tyrefrf.results.comparison import time_text
from tyrefrf.results.file import array_of
from tyrefrf.results.run_layout import RESPONSES

SOLVERS = ("recursive", "cyclic", "direct", "modal")
SHARES = (1 + 1e-12, 1 - 1e-13, 1.0, 1.01)
LINES = synthetic.LINES[::40]
ARRAYS = [
    field.name
    for field in fields(Comparison)
    if "Array" in str(field.type) and field.name != "samples"
]


def comparison(frequency=LINES, failure=("", "", "", "")) -> Comparison:
    """Made-up responses, those of every solver a share of the truth; samples at every third line.

    A solver with a failure has no answers; `cyclic` has none to line 2.
    """
    made = synthetic.results(frequency)
    n, dead = len(frequency), np.array([bool(why) for why in failure])
    receptance = np.array([share * made.receptance for share in SHARES])
    residual = np.array([np.full(n, 1e-13 * (i + 1)) for i in range(4)])
    receptance[1, ..., 2], residual[1, 2] = complex(np.nan, np.nan), np.nan
    receptance[dead], residual[dead] = complex(np.nan, np.nan), np.nan
    samples = np.arange(0, n, 3)
    apart = np.abs(np.subtract.outer(SHARES, SHARES))[..., None] * np.ones(len(samples))
    apart[..., 1] *= 2.0
    apart[dead], apart[:, dead] = np.nan, np.nan
    remark = [[""] * n for _ in SOLVERS]
    remark[0][4] = "a chain of cells nearly resonates here: solved by `cyclic`"
    remark[1][2] = f"{frequency[2]:g} Hz: an undamped resonance lies on this line"
    costs = {
        "seconds": np.outer([0.08, 0.02, 0.25, 0.003], np.linspace(1.0, 1.2, n)),
        "prepare_seconds": np.array([0.002, 0.001, 0.05, 41.0]),
        "peak_memory": np.array([130e6, 102e6, 171e6, 410e6]),
        "base_memory": np.full(4, 97e6),
        "disk": np.full(4, 0.32e6),
        "difference": np.outer(np.abs(np.array(SHARES) - 1.0), np.ones(n)),
    }
    for name in costs:
        costs[name][dead] = np.nan
    costs["difference"][1, 2] = np.nan
    return Comparison(
        frequency=made.frequency,
        solvers=SOLVERS,
        loads=made.loads,
        probes=made.probes,
        receptance=receptance,
        residual=residual,
        samples=samples,
        section_error=apart,
        remark=tuple(map(tuple, remark)),
        failure=failure,
        machine={"processor": "a made-up one", "cores": "2", "BLAS": "openblas 0.3, 1 thread(s)"},
        section=made.section,
        provenance=replace(synthetic.PROVENANCE, numbers={"ring_nodes": 2610, "ring_dofs": 7830}),
        **costs,
    )


@pytest.fixture
def made() -> Comparison:
    return comparison()


@pytest.fixture
def path(made, tmp_path):
    write_comparison(tmp_path / "comparison.h5", made)
    return tmp_path / "comparison.h5"


@pytest.mark.parametrize("name", [*ARRAYS, "mobility", "failed", "error", "pair_error"])
def test_arrays_come_back_to_the_bit_with_their_type(made, path, name):
    array = getattr(load_comparison(path), name)
    np.testing.assert_array_equal(array, getattr(made, name), strict=True)


@pytest.mark.parametrize(
    "name",
    ["solvers", "loads", "probes", "remark", "failure", "machine", "provenance", "reference"],
)
def test_the_rest_comes_back_equal(made, path, name):
    assert getattr(load_comparison(path), name) == getattr(made, name)


def test_the_lines_of_whole_sections_come_back(made, path):
    assert load_comparison(path).samples.tolist() == [0, 3, 6, 9]


@pytest.mark.parametrize("name", [field.name for field in fields(SectionMesh)])
def test_the_section_comes_back(made, path, name):
    read, written = getattr(load_comparison(path).section, name), getattr(made.section, name)
    np.testing.assert_array_equal(read, written, strict=True)


def test_a_tyre_under_pressure_comes_back(made, tmp_path):
    n, e = made.section.n_nodes, made.section.n_elements
    state = StaticState(
        2e5, np.ones((n, 2)), np.ones((e, 6)), np.ones(3), np.ones(1), np.array([4]), np.zeros(1)
    )
    write_comparison(tmp_path / "inflated.h5", replace(made, inflation=state))
    read = load_comparison(tmp_path / "inflated.h5").inflation
    assert read.pressure == 2e5
    np.testing.assert_array_equal(read.displacement, state.displacement)


def test_a_solver_without_answers_comes_back(tmp_path):
    killed = comparison(failure=("", "", "its process was killed (SIGKILL)", ""))
    write_comparison(tmp_path / "killed.h5", killed)
    read = load_comparison(tmp_path / "killed.h5")
    assert read.failure == killed.failure
    assert read.failed[2].all()
    assert read.reference == "recursive"


def test_arrays_are_read_only(made):
    for name in ARRAYS:
        assert not getattr(made, name).flags.writeable


def test_one_solver_is_a_run(made):
    run = made.of("cyclic")
    np.testing.assert_array_equal(run.receptance, made.receptance[1])
    np.testing.assert_array_equal(run.solve_time, made.seconds[1])
    assert run.n_failed == 1
    assert run.solved.tolist() == [line != 2 for line in range(11)]
    assert run.driving_point("radial") == pytest.approx(made.mobility[1, 0, 2], nan_ok=True)


def test_a_solver_that_is_not_there_is_refused(made):
    with pytest.raises(ResultsError, match="no solver 'cycle' in the results; did you mean 'cycli"):
        made.of("cycle")


def test_the_error_is_the_largest_against_direct(made):
    assert made.reference == "direct"
    assert made.error == pytest.approx([2e-12, 2e-13, 0.0, 0.02], rel=1e-3)
    assert made.pair_error[3, 0] == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("failure", "reference"),
    [
        (("", "", "", ""), "direct"),
        (("", "", "killed", ""), "recursive"),
        (("killed", "", "killed", ""), "cyclic"),
        (("killed",) * 4, "recursive"),
    ],
)
def test_the_reference_is_direct_or_the_first_that_has_answers(failure, reference):
    assert comparison(failure=failure).reference == reference


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0123456, "12.3 ms"), (0.9996, "1 s"), (0.9994, "999 ms"), (16.43, "16.4 s")],
)
def test_times_are_said_in_three_digits(seconds, text):
    assert time_text(seconds) == text


def test_shapes_that_do_not_agree_are_refused(made):
    with pytest.raises(ResultsError, match=r"disk has shape \(3,\); expected \(4,\)"):
        replace(made, disk=made.disk[:3])
    with pytest.raises(ResultsError, match="remarks or failures are not those of 4 solvers"):
        replace(made, failure=("",))


def test_xarray_opens_it_with_the_solvers_leading(made, path):
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert data["mobility"].dims == ("solver", "load", "probe", "frequency")
        cyclic = data["mobility"].sel(solver="cyclic", load="radial", probe="shoulder")
        np.testing.assert_array_equal(cyclic, made.mobility[1, 0, 0])
        assert data["peak_memory"].sel(solver="direct") == 171e6
        assert data["section_error"].sel(against="direct").dims == ("solver", "sample")
        assert data["sample"].values.tolist() == made.frequency[made.samples].tolist()
        assert data["machine"].sel(fact="cores") == "2"


def test_whatever_a_run_has_of_a_line_leads_with_the_solver(made, path):
    per_line = [field for field in RESPONSES if "frequency" in field.axes and not field.is_scale]
    assert len(per_line) >= 6
    with h5py.File(path) as file:
        for field in per_line:
            assert len(file[field.name]) == 4, field.name
            expected = field.of(made.of("modal"))
            np.testing.assert_array_equal(array_of(file[field.name], field.kind, 3), expected)


def test_every_dataset_names_its_axes_units_and_meaning(path):
    assert undescribed(path) == []
    with h5py.File(path) as file:
        assert file.attrs["content"] == "comparison"
        assert [file[name].attrs["units"] for name in ("disk", "solve_time")] == ["bytes", "s"]


def test_each_content_is_read_by_its_own_loader(made, path, tmp_path):
    assert isinstance(load_any(path), Comparison)
    assert tyrefrf.load_comparison is load_comparison
    with pytest.raises(ResultsError, match="holds a comparison; read it with load_comparison"):
        load_results(path)
    write_results(tmp_path / "run.h5", made.of("direct"))
    with pytest.raises(ResultsError, match="holds a run; read it with load_results"):
        load_comparison(tmp_path / "run.h5")
