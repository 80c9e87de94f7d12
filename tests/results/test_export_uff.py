"""Universal files as pyuff reads them: values, headers, and a geometry that means what it says.

The referee of the directions is a rigid translation T of the tyre: whatever the code and the
system of a node, the response read there is T along the direction that the file names.
"""

from __future__ import annotations

import importlib.util
from dataclasses import replace

import numpy as np
import pytest
import pyuff
import synthetic

from tyrefrf.errors import ResultsError
from tyrefrf.mesh.place import HUB
from tyrefrf.results.export import export
from tyrefrf.results.sweep import SweepResults

TWELVE_DIGITS = 1e-11  # of a value, E20.11
SIX_DIGITS = 5.0000001e-6  # of a frequency, E13.5: half of the last
COORDINATES = 2e-6  # [m] six digits of 0.3 m
T = np.array([1.0, -2.0, 4.0])  # a translation [m]

AROUND = tuple(
    synthetic.place(f"{direction} at {angle}", 0.4, direction, angle=angle)
    for angle in (0.0, 31.0, 90.0, 180.0, 200.0, 270.0)
    for direction in ("r", "y", "theta")
)


def written(directory, results, quantity="mobility"):
    (path,) = export(results, directory / "made", ["uff58"], quantity)
    return pyuff.UFF(str(path)).read_sets()


def of_type(sets, number):
    return [one for one in sets if one["type"] == number]


@pytest.fixture(scope="module")
def made():
    return synthetic.results()


@pytest.fixture(scope="module")
def sets(made, tmp_path_factory):
    return written(tmp_path_factory.mktemp("uff"), made)


def moving_as_one():
    """Results of a tyre that every load translates by T."""
    made = synthetic.results(np.array([10.0, 20.0, 30.0]), probes=AROUND)
    receptance = np.empty_like(made.receptance)
    for j, probe in enumerate(AROUND):
        c, s = np.cos(probe.angle), np.sin(probe.angle)
        axis = {"r": (c, 0.0, s), "y": (0.0, 1.0, 0.0), "theta": (-s, 0.0, c)}
        receptance[:, j] = np.dot(axis[probe.direction], T)
    return replace(made, receptance=receptance)


def global_axes(sets):
    """The axes X, Y, Z of every node's displacement system, in global components, and its place."""
    systems = {0: np.eye(3)}
    for one in of_type(sets, 18):
        for k, x, xz in zip(one["cs_num"], one["x_point"], one["xz_point"], strict=True):
            z = xz / np.linalg.norm(xz)
            systems[int(k)] = np.array([x, np.cross(z, x), z])
    (nodes,) = of_type(sets, 15)
    points = np.transpose([nodes["x"], nodes["y"], nodes["z"]])
    return {
        int(number): (systems[int(system)], point)
        for number, system, point in zip(nodes["node_nums"], nodes["disp_cs"], points, strict=True)
    }


def direction(axes, code):
    return np.sign(code) * axes[abs(code) - 1]


def test_a_rigid_translation_is_the_same_at_every_node(tmp_path):
    read = written(tmp_path, moving_as_one(), "receptance")
    nodes = global_axes(read)
    responses = [one for one in of_type(read, 58) if one["ordinate_spec_data_type"] == 8]
    assert len(responses) == 2 * len(AROUND)
    for one in responses:
        along = direction(nodes[one["rsp_node"]][0], one["rsp_dir"])
        np.testing.assert_allclose(one["data"], along @ T, atol=2e-5)  # axes have six digits


def test_at_quarter_turns_directions_are_global_in_every_reader(tmp_path):
    """A reader that ignores displacement systems takes all axes for the global ones."""
    read = written(tmp_path, moving_as_one(), "receptance")
    for one in of_type(read, 58)[: len(AROUND)]:
        angle = float(one["id5"].rpartition(" ")[2])
        if angle % 90.0 == 0.0 or one["id5"].startswith("y"):
            assert one["data"][0] == pytest.approx(direction(np.eye(3), one["rsp_dir"]) @ T)


def test_values_and_lines_are_read_back(made, sets):
    functions = of_type(sets, 58)
    expected = [
        *(Y for i in (0, 1) for Y in (*made.mobility[i], *made.blocked_force[i])),
    ]
    assert len(functions) == len(expected) == 28
    for one, Y in zip(functions, expected, strict=True):
        np.testing.assert_allclose(one["data"], Y, rtol=TWELVE_DIGITS)
        np.testing.assert_allclose(one["x"], made.frequency, rtol=1e-12)
        assert one["abscissa_spacing"] == 1


@pytest.mark.parametrize(
    ("quantity", "code", "label", "units"),
    [
        ("receptance", 8, "Displacement", "m"),
        ("mobility", 11, "Velocity", "m/s"),
        ("accelerance", 12, "Acceleration", "m/s^2"),
    ],
)
def test_the_header_says_what_was_divided_by_what(made, tmp_path, quantity, code, label, units):
    one = of_type(written(tmp_path, made, quantity), 58)[2]
    assert one["func_type"] == 4
    assert (one["abscissa_spec_data_type"], one["abscissa_axis_units_lab"]) == (18, "Hz")
    assert one["ordinate_spec_data_type"] == code
    assert (one["ordinate_axis_lab"], one["ordinate_axis_units_lab"]) == (label, units)
    assert (one["orddenom_spec_data_type"], one["orddenom_axis_units_lab"]) == (13, "N")
    np.testing.assert_allclose(one["data"], getattr(made, quantity)[0, 2], rtol=TWELVE_DIGITS)


def test_the_file_is_in_si_and_says_where_it_comes_from(made, sets):
    (units,) = of_type(sets, 164)
    assert (units["units_code"], units["length"], units["force"]) == (1, 1.0, 1.0)
    (header,) = of_type(sets, 151)
    assert header["model_name"] == "made_up"
    assert header["description"] == made.provenance.title
    assert header["program"] == "tyrefrf 0.1.0"
    assert header["date_db_created"] == "22-Nov-26"


def test_no_header_field_is_left_out(sets):
    for one in of_type(sets, 58):
        assert all(
            value not in (None, "") for key, value in one.items() if key not in ("x", "data")
        )


def test_a_load_and_its_driving_point_are_one_degree_of_freedom(made, sets):
    drives = [one for one in of_type(sets, 58) if one["id5"] == f"{one['id4']}.drive"]
    assert [one["id4"] for one in drives] == ["radial", "tangential"]
    for one in drives:
        assert (one["rsp_node"], one["rsp_dir"]) == (one["ref_node"], one["ref_dir"])
    signs = [one["data"].real.min() >= 0.0 for one in drives]
    assert signs == [True, True]


def test_loads_at_one_place_share_its_node_and_a_disc_has_its_own(sets):
    """`radial` is a disc of 10 mm; `tangential` and the probe `crown y` are at one point."""
    node = {one["id5"]: one["rsp_node"] for one in of_type(sets, 58)}
    assert node["tangential.drive"] == node["crown y"]
    assert node["radial.drive"] != node["crown y"]


def test_probes_of_one_degree_of_freedom_are_counted(made, tmp_path):
    twice = (*made.probes, replace(made.probes[0], name="again"))
    functions = of_type(written(tmp_path, synthetic.results(probes=twice)), 58)
    counts = {one["id5"]: one["ver_num"] for one in functions if one["id4"] == "radial"}
    assert (counts["shoulder"], counts["again"], counts["sidewall"]) == (1, 2, 1)


def test_nodes_stand_where_the_places_are(made, sets):
    nodes = global_axes(sets)
    for one, probe in zip(of_type(sets, 58)[:8], made.probes, strict=True):
        x, z = probe.r * np.cos(probe.angle), probe.r * np.sin(probe.angle)
        np.testing.assert_allclose(nodes[one["rsp_node"]][1], [x, probe.y, z], atol=COORDINATES)


def test_trace_lines_run_through_the_places_along_the_outline(made, sets):
    nodes = global_axes(sets)
    lines = {one["id"]: one["nodes"].astype(int) for one in of_type(sets, 82)}
    outline = lines["outer surface at 0 deg"]
    assert set(outline.tolist()) <= set(nodes)
    assert {1, 2, 3, 4} <= set(outline.tolist())  # the loads, the shoulder and the sidewall
    points = np.array([nodes[number][1] for number in outline])
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    section = made.section.points[made.section.outer]
    length = np.linalg.norm(section[:, 1] - section[:, 0], axis=1).sum()
    assert steps.sum() == pytest.approx(length, rel=1e-3)  # no way back along the line


def test_rings_are_closed_circles_through_their_places(made, sets):
    nodes = global_axes(sets)
    probe = made.probes[0]
    (ring,) = [
        one["nodes"].astype(int)
        for one in of_type(sets, 82)
        if one["id"] == f"ring at r = {probe.r:.4f} m, y = {probe.y:.4f} m"
    ]
    assert ring[0] == ring[-1]
    assert 3 in ring  # the shoulder's
    points = np.array([nodes[number][1] for number in ring])
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 2]), probe.r, atol=COORDINATES)
    turns = np.unwrap(np.arctan2(points[:, 2], points[:, 0]))
    assert turns[-1] - turns[0] == pytest.approx(2 * np.pi)


def test_many_places_make_lines_that_readers_bear(tmp_path):
    """At most 125 nodes in a line (MODAL-PLUS), and node numbers below 8000."""
    grid = [(0.4 + 0.1 * (k % 2), 2.0 * (k // 2)) for k in range(2 * 180)]
    scattered = [(0.2 + 0.6 * k / 1000, 0.35 * k) for k in range(1000)]
    probes = tuple(
        synthetic.place(f"{s} {angle}", s, "r", angle=angle) for s, angle in grid + scattered
    )
    made = synthetic.results(np.array([100.0, 200.0]))
    read = written(
        tmp_path, replace(made, probes=probes, receptance=np.ones((2, len(probes), 2), complex))
    )
    longest = max(len(one["nodes"]) for one in of_type(read, 82))
    (nodes,) = of_type(read, 15)
    assert len(of_type(read, 58)) == 2 * (1360 + 6)
    assert 100 < longest <= 125
    assert max(nodes["node_nums"]) < 8000


def test_the_blocked_hub_is_a_node_at_the_wheel_s_centre(sets):
    nodes = global_axes(sets)
    hub = [one for one in of_type(sets, 58) if one["id5"].startswith("hub ")]
    assert [one["id5"] for one in hub] == [f"hub {name}" for name in HUB] * 2
    assert [one["rsp_dir"] for one in hub] == [1, 2, 3, 4, 5, 6] * 2
    assert {one["ordinate_spec_data_type"] for one in hub} == {9}
    np.testing.assert_array_equal(nodes[hub[0]["rsp_node"]][1], np.zeros(3))


THIRDS = np.arange(1, 3001) / 3.0


def test_a_step_that_six_digits_do_not_hold_is_stored_line_by_line(tmp_path):
    one = of_type(written(tmp_path, synthetic.results(THIRDS)), 58)[0]
    assert one["abscissa_spacing"] == 0
    np.testing.assert_allclose(one["x"], THIRDS, rtol=SIX_DIGITS)
    np.testing.assert_allclose(one["data"], synthetic.results(THIRDS).mobility[0, 0], rtol=1e-11)


def test_errors_of_such_lines_do_not_add_up(tmp_path):
    """Stored as first line and step, the last of 3000 lines would be off by 3000 roundings."""
    one = of_type(written(tmp_path, synthetic.results(THIRDS)), 58)[0]
    assert abs(one["x"] - THIRDS)[-1] == pytest.approx(0.0, abs=1e-9)  # 1000 Hz


def test_even_lines_of_few_digits_keep_their_step(tmp_path):
    lines = 1000.0 + 0.001 * np.arange(2000)
    one = of_type(written(tmp_path, synthetic.results(lines)), 58)[0]
    assert one["abscissa_spacing"] == 1
    np.testing.assert_allclose(one["x"], lines, rtol=1e-12)


def test_lines_that_six_digits_cannot_tell_apart_are_refused(made, tmp_path):
    lines = np.array([500.0, 1000.0, 1000.001, 2000.0])
    with pytest.raises(ResultsError, match=r"1000 and 1000\.001 Hz are the same"):
        written(tmp_path, synthetic.results(lines))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("lines", [[440.0], [440.0, 441.0]], ids=len)
def test_one_or_two_lines_will_do(tmp_path, lines):
    one = of_type(written(tmp_path, synthetic.results(np.array(lines))), 58)[0]
    np.testing.assert_allclose(one["x"], lines)
    assert one["num_pts"] == len(lines)


def test_lines_without_an_answer_are_left_out_and_said(made, tmp_path):
    """As NaN, pyuff would write them as zeros."""
    failed = synthetic.with_failed(made, 7, 100)
    one = of_type(written(tmp_path, failed), 58)[0]
    np.testing.assert_allclose(one["x"], np.delete(made.frequency, [7, 100]))
    expected = np.delete(made.mobility[0, 0], [7, 100])
    np.testing.assert_allclose(one["data"], expected, rtol=TWELVE_DIGITS)
    assert one["id1"].endswith("2 lines without answer left out")


def test_nothing_but_failed_lines_is_refused(tmp_path):
    made = synthetic.results(np.array([10.0, 20.0]))
    with pytest.raises(ResultsError, match="no line has an answer"):
        written(tmp_path, synthetic.with_failed(made, 0, 1))


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ('tread, "left"', 'tread, "left"'),
        ("Lauffläche Ø 10 µm", "Laufflache ? 10 um"),
        ("タイヤ", "???"),
        ("x" * 100, "x" * 80),
        ("    -1", "-1"),
        ("a" * 74 + "    -1", "a" * 74 + " -1"),
        ("   ", "NONE"),
    ],
)
def test_awkward_names_are_lines_of_80_ascii_characters(tmp_path, name, line):
    probes = (replace(synthetic.PROBES[0], name=name), *synthetic.PROBES[1:])
    made = synthetic.results(np.array([10.0, 20.0, 30.0]), probes=probes)
    functions = of_type(written(tmp_path, made), 58)
    assert len(functions) == 28
    assert functions[0]["id5"] == line
    text = (tmp_path / "made.uff").read_bytes()
    assert text.isascii()
    assert max(map(len, text.splitlines())) <= 80


def test_a_sweep_has_a_file_for_every_point_that_names_it(made, tmp_path):
    sweep = sweep_of(made)
    files = export(sweep, tmp_path / "made_sweep", ["uff58"])
    assert [path.name for path in files] == ["made_sweep_1.uff", "made_sweep_2.uff"]
    (header,) = of_type(pyuff.UFF(str(files[1])).read_sets(), 151)
    assert header["description"].startswith("E_rubber = 56 MPa; ")
    one = of_type(pyuff.UFF(str(files[1])).read_sets(), 58)[0]
    np.testing.assert_allclose(one["data"], 2 * made.mobility[0, 0], rtol=TWELVE_DIGITS)
    assert one["id2"].startswith("E_rubber = 56 MPa, made_up")


def sweep_of(made):
    """Two points; at the second everything moves twice as far."""
    from tyrefrf.case.axis import Axis

    axis = Axis("E_rubber", "materials.rubber.E", "Pa", "Young's modulus", (28e6, 56e6))
    points = (made, replace(made, receptance=2 * made.receptance))
    return SweepResults((axis,), points, made.provenance)


def test_without_pyuff_the_message_says_what_to_install(made, tmp_path, monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(
        "tyrefrf.results.export.files.find_spec",
        lambda name: None if name == "pyuff" else found(name),
    )
    with pytest.raises(ResultsError, match=r'pip install "tyrefrf\[uff\]"'):
        export(made, tmp_path / "made", ["csv", "uff58"])
    assert list(tmp_path.iterdir()) == []
    assert export(made, tmp_path / "made", ["mat"])


def test_existing_files_are_replaced_whole(made, tmp_path):
    (tmp_path / "made.uff").write_text("an older and longer file\n" * 100_000)
    assert len(written(tmp_path, made)) == 3 + 8 + 28
