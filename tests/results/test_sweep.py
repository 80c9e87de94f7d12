"""The file of a sweep: a run's datasets with the parameters leading, for every reader."""

from __future__ import annotations

from dataclasses import fields, replace

import h5py
import numpy as np
import pytest
import synthetic
import xarray
from hdf5 import undescribed

from tyrefrf.case.axis import Axis
from tyrefrf.errors import ResultsError
from tyrefrf.mesh.section import SectionMesh
from tyrefrf.results import (
    SweepResults,
    load_any,
    load_results,
    load_sweep,
    sweep_layout,
    write_sweep,
)
from tyrefrf.results.field import Field
from tyrefrf.results.run_layout import fields_of

MODULUS = Axis("E_rubber", "materials.rubber.E", "Pa", "Young's modulus", (14e6, 28e6, 56e6))
CROWN = Axis("crown", "geometry.thickness.crown", "m", "thickness at mid-tread", (0.012, 0.014))
FEW = synthetic.LINES[::40]
ARRAYS = ("receptance", "mobility", "blocked_force", "solved", "residual", "solve_time", "failed")


def point(scale: float, thicker: float = 0.0, sector_angle: float = 8.0):
    """Responses of another size, perhaps on another mesh; loads move with it."""
    made = synthetic.results(FEW)
    section = replace(made.section, points=made.section.points + thicker)
    provenance = replace(
        made.provenance,
        case_hash=f"{scale} {thicker}",
        resolved_case=f"scale = {scale}",
        sector_angle=sector_angle,
        numbers={"ring_dofs": 7830},
    )
    return replace(
        made,
        loads=tuple(replace(load, r=load.r + thicker) for load in made.loads),
        receptance=made.receptance * scale,
        section=section,
        provenance=provenance,
    )


def by_modulus() -> SweepResults:
    points = [point(4.0), synthetic.with_failed(point(2.0), 3), point(1.0)]
    return SweepResults((MODULUS,), tuple(points), synthetic.PROVENANCE)


def by_both() -> SweepResults:
    points = tuple(point(scale, thicker) for scale in (4.0, 2.0, 1.0) for thicker in (0.0, 0.002))
    return SweepResults((MODULUS, CROWN), points, synthetic.PROVENANCE)


@pytest.fixture(params=[by_modulus, by_both], ids=["one", "two"])
def made(request) -> SweepResults:
    return request.param()


@pytest.fixture
def path(made, tmp_path):
    write_sweep(tmp_path / "sweep.h5", made)
    return tmp_path / "sweep.h5"


def test_arrays_have_the_parameters_as_leading_dimensions():
    assert by_both().mobility.shape == (3, 2, 2, 8, 11)
    assert by_both().residual.shape == (3, 2, 11)
    assert by_modulus().response("radial", "shoulder").shape == (3, 11)
    np.testing.assert_array_equal(by_both().receptance[1, 1], by_both().points[3].receptance)


def test_a_point_is_found_by_its_values():
    made = by_both()
    assert made.point(E_rubber=28e6, crown=0.014) is made.points[3]
    assert made.labels[3] == "E_rubber = 28 MPa, crown = 14 mm"


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"E_rubber": 28e6}, r"no value for crown; there are 0\.012, 0\.014 \[m\]"),
        ({"E_rubber": 3e6, "crown": 0.012}, r"no E_rubber = 3e\+06; there are 1\.4e\+07"),
        ({"E_ruber": 28e6}, "no parameter 'E_ruber' in the results; did you mean 'E_rubber'"),
    ],
)
def test_a_point_that_is_not_there_is_refused(values, message):
    with pytest.raises(ResultsError, match=message):
        by_both().point(**values)


def test_the_level_is_the_mean_of_decibels_over_lines_that_move():
    made = by_modulus()
    levels = made.level("radial")
    Y = np.abs(made.points[0].driving_point("radial")[1:])  # nothing moves at 0 Hz
    assert levels[0] == pytest.approx(np.mean(20.0 * np.log10(Y)))
    assert levels[0] - levels[2] == pytest.approx(20.0 * np.log10(4.0))
    Y = np.delete(np.abs(made.points[1].driving_point("radial")), [0, 3])
    assert levels[1] == pytest.approx(np.mean(20.0 * np.log10(Y)))


def test_points_that_do_not_belong_together_are_refused():
    points = by_modulus().points
    shifted = synthetic.results(FEW + 1.0)
    swapped = synthetic.results(FEW, loads=synthetic.LOADS[::-1])
    with pytest.raises(ResultsError, match="2 points; expected 3"):
        SweepResults((MODULUS,), points[:2], synthetic.PROVENANCE)
    with pytest.raises(ResultsError, match="different frequency lines"):
        SweepResults((MODULUS,), (*points[:2], shifted), synthetic.PROVENANCE)
    with pytest.raises(ResultsError, match="different loads or probes"):
        SweepResults((MODULUS,), (*points[:2], swapped), synthetic.PROVENANCE)


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_come_back_to_the_bit(made, path, name):
    np.testing.assert_array_equal(getattr(load_sweep(path), name), getattr(made, name), strict=True)


def test_every_point_comes_back(made, path):
    read = load_sweep(path)
    assert read.axes == made.axes
    assert read.provenance == made.provenance
    for written, back in zip(made.points, read.points, strict=True):
        assert back.provenance == written.provenance
        assert (back.loads, back.probes, back.remark) == (
            written.loads, written.probes, written.remark,
        )  # fmt: skip
        for field in fields(SectionMesh):
            np.testing.assert_array_equal(
                getattr(back.section, field.name), getattr(written.section, field.name)
            )


def test_xarray_opens_a_sweep_as_it_is(made, path):
    names = tuple(axis.name for axis in made.axes)
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert data["mobility"].dims == (*names, "load", "probe", "frequency")
        assert data["residual"].dims == (*names, "frequency")
        assert data["mobility"].dtype == np.complex128
        np.testing.assert_array_equal(data["mobility"], made.mobility)
        one = data["mobility"].sel(E_rubber=28e6, load="radial", probe="shoulder")
        np.testing.assert_array_equal(one, made.response("radial", "shoulder")[1])
        assert data["E_rubber"].attrs["units"] == "Pa"
        assert data["E_rubber"].attrs["long_name"] == "Young's modulus"
        assert data["E_rubber"].attrs["place"] == "materials.rubber.E"
        assert data.attrs["case_text"] == made.provenance.case_text


def test_xarray_opens_the_groups_of_a_sweep(made, path):
    with xarray.open_datatree(path, engine="h5netcdf") as tree:
        assert tree["point"]["case_hash"].dims == tuple(axis.name for axis in made.axes)
        assert tree["point"]["case_hash"].to_numpy().ravel().tolist() == [
            point.provenance.case_hash for point in made.points
        ]


def test_a_section_that_all_points_share_is_there_once(tmp_path):
    write_sweep(tmp_path / "one.h5", by_modulus())
    with h5py.File(tmp_path / "one.h5") as file:
        assert "section" in file
        assert "section_index" not in file
        assert file["load_r"].shape == (2,)


def test_different_sections_are_there_once_each_with_who_has_which(tmp_path):
    write_sweep(tmp_path / "two.h5", by_both())
    with h5py.File(tmp_path / "two.h5") as file:
        assert {name for name in file if name.startswith("section")} == {
            "section_0", "section_1", "section_index",
        }  # fmt: skip
        assert file["section_index"][...].tolist() == [[0, 1]] * 3
        assert file["load_r"].shape == (3, 2, 2)
        assert file["load_s"].shape == (2,)
        shift = file["section_1/points"][...] - file["section_0/points"][...]
        np.testing.assert_allclose(shift, 0.002)


def test_every_dataset_of_a_sweep_names_its_axes_units_and_meaning(path):
    with h5py.File(path) as file:
        assert file["mobility"].dims[0][0] == file["E_rubber"]
        assert file["mobility"].chunks == (*(1,) * (file["mobility"].ndim - 1), 11)
    assert undescribed(path) == []


@pytest.mark.parametrize("name", ["frequency", "point", "E_a/b", ".", "mobility"])
def test_a_parameter_s_name_never_hides_a_dataset(tmp_path, name):
    axis = replace(MODULUS, name=name)
    write_sweep(tmp_path / "sweep.h5", replace(by_modulus(), axes=(axis,)))
    assert load_sweep(tmp_path / "sweep.h5").axes == (axis,)


def test_a_sweep_and_a_run_are_not_taken_for_each_other(tmp_path):
    from tyrefrf.results import write_results

    write_sweep(tmp_path / "sweep.h5", by_modulus())
    write_results(tmp_path / "run.h5", synthetic.results(FEW))
    with pytest.raises(ResultsError, match="holds a sweep; read it with load_sweep"):
        load_results(tmp_path / "sweep.h5")
    with pytest.raises(ResultsError, match="holds a run; read it with load_results"):
        load_sweep(tmp_path / "run.h5")
    assert isinstance(load_any(tmp_path / "sweep.h5"), SweepResults)


def test_a_truncated_sweep_is_refused(tmp_path):
    write_sweep(tmp_path / "sweep.h5", by_modulus())
    whole = (tmp_path / "sweep.h5").read_bytes()
    (tmp_path / "sweep.h5").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ResultsError, match="truncated or damaged"):
        load_sweep(tmp_path / "sweep.h5")


def test_a_hub_less_sweep_comes_back(tmp_path):
    points = tuple(replace(p, blocked_force=p.blocked_force[:, :0]) for p in by_modulus().points)
    write_sweep(tmp_path / "sweep.h5", replace(by_modulus(), points=points))
    assert load_sweep(tmp_path / "sweep.h5").blocked_force.shape == (3, 2, 0, 11)


def test_what_differs_from_the_case_at_every_point_is_kept(tmp_path):
    """One sector angle, but not the case's: no two points differ, and yet it is theirs."""
    points = tuple(point(scale, sector_angle=6.0) for scale in (4.0, 2.0, 1.0))
    write_sweep(tmp_path / "sweep.h5", replace(by_modulus(), points=points))
    read = load_sweep(tmp_path / "sweep.h5")
    assert [p.provenance.sector_angle for p in read.points] == [6.0] * 3
    assert read.provenance.sector_angle == synthetic.PROVENANCE.sector_angle


def test_a_group_that_some_points_lack_is_there_for_the_others(tmp_path, monkeypatch):
    """As the inflation state is where the sweep of a pressure begins with none."""
    made = by_modulus()
    state = Field("state/step", ("state/step",), "int", "1", "made up", lambda _: [1, 2])

    def some(results):
        without = results is made.points[0]
        return fields_of(results) if without else (*fields_of(results), state)

    monkeypatch.setattr(sweep_layout, "fields_of", some)
    write_sweep(tmp_path / "sweep.h5", made)
    with h5py.File(tmp_path / "sweep.h5") as file:
        assert file["state_index"][...].tolist() == [-1, 0, 0]
        assert [sweep_layout.has_group(file, "state", (i,)) for i in range(3)] == [
            False, True, True,
        ]  # fmt: skip
        assert file[sweep_layout.stored_name(file, state, (2,))][...].tolist() == [1, 2]
        assert sweep_layout.has_group(file, "section", (0,))
    xarray.open_datatree(tmp_path / "sweep.h5", engine="h5netcdf").close()
