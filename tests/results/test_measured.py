"""Measured responses: read from a laboratory's files, held against computed ones, and kept.

One response is written in every form that a laboratory may choose, and has to come back the same.
"""

from __future__ import annotations

import sys
from dataclasses import fields, replace

import h5py
import numpy as np
import pytest
import pyuff
import synthetic
import xarray
from hdf5 import undescribed

from tyrefrf.case import MeasuredFile
from tyrefrf.case.axis import Axis
from tyrefrf.errors import CaseError, ResultsError
from tyrefrf.results import (
    Measured,
    SweepResults,
    agreements,
    load_results,
    load_sweep,
    read_measured,
    write_results,
    write_sweep,
)
from tyrefrf.results.measured import frac, interpolated, level, within

DIGITS = 1e-9  # of numbers written with ten digits
F = np.array([10.0, 12.5, 15.0, 20.0])
H = np.array([3e-3 - 1e-3j, -2e-3 + 5e-4j, 1e-4j, -4e-3 - 2e-3j])
TABLE = {"file": "lab.csv", "load": "radial", "probe": "shoulder", "quantity": "mobility"}
PHASE = np.degrees(np.angle(H))


def table(**keys):
    return MeasuredFile.model_validate(TABLE | keys)


def read(directory, **keys):
    (curve,) = read_measured([table(**keys)], directory)
    return curve


def refused(directory, **keys):
    """What is said of a file, without the directory."""
    with pytest.raises(CaseError) as caught:
        read(directory, **keys)
    (problem,) = caught.value.problems
    assert problem.key == ("measured", 0, "file")
    return problem.message.replace(f"{directory}/", "")


def text(columns, separator=",", header="", comma=False):
    lines = [separator.join(f"{x:.10g}" for x in row) for row in zip(*columns, strict=True)]
    body = "\n".join(lines) + "\n"
    return header + (body.replace(".", ",") if comma else body)


REAL_IMAG = [F, H.real, H.imag]
FORMS = {
    "commas": (text(REAL_IMAG), {}),
    "blanks": (text(REAL_IMAG, "   "), {}),
    "tabs and a header": (text(REAL_IMAG, "\t", "f\tre\tim\n"), {}),
    "semicolons and decimal commas": (text(REAL_IMAG, ";", "f;re;im\n", comma=True), {}),
    "tabs and decimal commas": (text(REAL_IMAG, "\t", comma=True), {}),
    "comments": (text(REAL_IMAG, header="# run 7\n% 20 C\n\n") + "// end, 3\n", {}),
    "a quoted header in words": (text(REAL_IMAG, header='"Hz","re, Y","im"\n'), {}),
    "Windows' ends of lines": (text(REAL_IMAG).replace("\n", "\r\n"), {}),
    "columns in another order": (
        text([H.imag, F, np.zeros(4), H.real]),
        {"frequency": 2, "real": 4, "imag": 1},
    ),
    "columns by their names": (
        text([H.imag, F, H.real], header="im,f [Hz],re\n"),
        {"frequency": "f [Hz]", "real": "re", "imag": "im"},
    ),
    "magnitude and phase": (text([F, np.abs(H), PHASE]), {"magnitude": 2, "phase": 3}),
    "decibels and phase": (
        text([F, 20.0 * np.log10(np.abs(H)), PHASE]),
        {"level": 2, "phase": 3},
    ),
}


@pytest.mark.parametrize(("written", "columns"), FORMS.values(), ids=FORMS)
def test_every_form_of_a_text_file_is_the_same_response(tmp_path, written, columns):
    (tmp_path / "lab.csv").write_text(written, newline="")
    curve = read(tmp_path, **({"columns": columns} if columns else {}))
    np.testing.assert_allclose(curve.frequency, F, rtol=DIGITS)
    np.testing.assert_allclose(curve.response, H, rtol=DIGITS, atol=DIGITS * 1e-3)
    assert (curve.name, curve.load, curve.probe) == ("lab", "radial", "shoulder")


@pytest.mark.parametrize("encoding", ["utf-8-sig", "latin-1", "utf-8"])
def test_a_degree_sign_in_the_header_is_no_obstacle(tmp_path, encoding):
    (tmp_path / "lab.csv").write_bytes(text(REAL_IMAG, header="# 20 °C\n").encode(encoding))
    np.testing.assert_allclose(read(tmp_path).response, H, rtol=DIGITS)


def test_the_scale_turns_a_sensor_around(tmp_path):
    (tmp_path / "lab.csv").write_text(text(REAL_IMAG))
    np.testing.assert_allclose(read(tmp_path, scale=-2.0).response, -2.0 * H, rtol=DIGITS)


BAD = {
    "missing": (None, {}, "lab.csv cannot be read: No such file or directory"),
    "empty": ("", {}, "lab.csv: has no line of numbers"),
    "words": ("no\nnumbers\n", {}, "lab.csv: has no line of numbers"),
    "cut off": (
        "1,2,3\n2,3,4\n3,4\n",
        {},
        "lab.csv:3: no column 3, the line has 2; wrong columns, or a file cut off",
    ),
    "wrong columns": (
        "f,re,im\n1,2,3\n",
        {"columns": {"real": 3, "imag": 4}},
        "lab.csv:2: no column 4, the line has 3; wrong columns, or a file cut off",
    ),
    "unknown column": (
        "f,real Y,imag Y\n1,2,3\n",
        {"columns": {"real": "real y", "imag": 3}},
        "lab.csv: no column 'real y'; did you mean 'real Y'?",
    ),
    "unnamed columns": (
        "1,2,3\n",
        {"columns": {"real": "re", "imag": 3}},
        "lab.csv: no column 're'; the file has no header above its numbers",
    ),
    "NaN": ("1,2,3\n2,nan,4\n", {}, "lab.csv:2: 'nan' in column 2 is not a finite number"),
    "a word": ("# c\n1,2,3\n2,3,x\n", {}, "lab.csv:3: 'x' in column 3 is not a finite number"),
    "two points": (
        "1;2;3\n2;1.234,5;4\n",
        {},
        "lab.csv:2: '1.234,5' in column 2 is not a finite number",
    ),
    "falling": (
        "1,2,3\n20,3,4\n\n15,3,4\n",
        {},
        "lab.csv:4: 15 Hz after 20 Hz; frequencies have to increase",
    ),
    "twice": ("1,2,3\n1,3,4\n", {}, "lab.csv:2: 1 Hz after 1 Hz; frequencies have to increase"),
    "negative": ("-1,2,3\n1,3,4\n", {}, "lab.csv:1: a frequency of -1 Hz"),
}


@pytest.mark.parametrize(("written", "keys", "message"), BAD.values(), ids=BAD)
def test_a_wrong_text_file_is_refused_by_its_line(tmp_path, written, keys, message):
    if written is not None:
        (tmp_path / "lab.csv").write_text(written)
    assert refused(tmp_path, **keys) == message


def test_all_wrong_files_are_named_at_once(tmp_path):
    with pytest.raises(CaseError) as caught:
        read_measured([table(), table(file="b.csv")], tmp_path)
    assert [problem.key for problem in caught.value.problems] == [
        ("measured", 0, "file"),
        ("measured", 1, "file"),
    ]


# universal files


def record(**more):
    """A data set 58 of the response as pyuff writes it: accelerance of 5 z by 1 -x."""
    header = {key: 0 if value is None else value for key, value in pyuff.prepare_58().items()}
    header |= {f"{end}_ent_name": "NONE" for end in ("rsp", "ref")}
    header |= {
        "type": 58,
        "func_type": 4,
        "rsp_node": 5,
        "rsp_dir": 3,
        "ref_node": 1,
        "ref_dir": -1,
    }
    header |= {"abscissa_spec_data_type": 18, "orddenom_spec_data_type": 13}
    header |= {"ordinate_spec_data_type": 12, "ord_data_type": 6, "num_pts": len(F)}
    return header | {"abscissa_spacing": 0, "x": F, "data": H, "binary": 0} | more


def write_uff(path, *sets):
    pyuff.UFF(str(path)).write_sets(list(sets), mode="add")


LAB = {"file": "lab.uff", "quantity": None}
EVEN = {"abscissa_spacing": 1, "abscissa_min": 10.0, "abscissa_inc": 2.5}


@pytest.mark.parametrize("precision", [5, 6])
def test_a_universal_file_is_the_same_response(tmp_path, precision):
    dset = record(ord_data_type=precision)
    pyuff.UFF(str(tmp_path / "lab.uff")).write_sets([dset], mode="add", force_double=False)
    curve = read(tmp_path, **LAB)
    np.testing.assert_allclose(curve.frequency, F, rtol=1e-5)  # as the format has digits
    np.testing.assert_allclose(curve.response, H, rtol=1e-5)
    assert curve.quantity == "accelerance"


@pytest.mark.parametrize(("order", "code"), [("<", 1), (">", 2)])
def test_a_binary_universal_file_is_the_same_response_to_the_bit(tmp_path, order, code):
    """Data set 58b as the format says: the mark at its end follows the values at once."""
    write_uff(tmp_path / "lab.uff", record())
    head = (tmp_path / "lab.uff").read_text().splitlines(keepends=True)[:13]
    values = np.stack([F, H.real, H.imag], axis=1).astype(f"{order}f8").tobytes()
    head[1] = f"    58b{code:6}{2:6}{11:12}{len(values):12}{0:6}{0:6}{0:12}{0:12}\n"
    (tmp_path / "lab.uff").write_bytes("".join(head).encode() + values + b"    -1\n")
    curve = read(tmp_path, **LAB)
    np.testing.assert_array_equal(curve.frequency, F)
    np.testing.assert_array_equal(curve.response, H)


def test_even_lines_begin_and_step_as_the_header_says(tmp_path):
    write_uff(tmp_path / "lab.uff", record(**EVEN))
    np.testing.assert_allclose(read(tmp_path, **LAB).frequency, [10.0, 12.5, 15.0, 17.5])


@pytest.mark.parametrize(
    ("code", "quantity"), [(8, "receptance"), (11, "mobility"), (12, "accelerance")]
)
def test_the_header_says_the_quantity_and_the_case_may_say_it_better(tmp_path, code, quantity):
    write_uff(tmp_path / "lab.uff", record(ordinate_spec_data_type=code))
    assert read(tmp_path, **LAB).quantity == quantity
    assert read(tmp_path, **LAB | {"quantity": "mobility"}).quantity == "mobility"


def test_units_of_the_file_become_si(tmp_path):
    """Factors of data set 164: a metre is 1000 of the file's units of length."""
    units = {"type": 164, "units_code": 5, "temp": 1.0, "temp_offset": 0.0}
    units |= {"units_description": "mm, N", "length": 1000.0, "force": 1.0}
    write_uff(tmp_path / "lab.uff", units, record())
    np.testing.assert_allclose(read(tmp_path, **LAB).response, 1e-3 * H, rtol=1e-6)


@pytest.fixture
def several(tmp_path):
    """A file with an FRF, its coherence, and the FRF of another point, of twice the size."""
    coherence = record(func_type=6, ord_data_type=4, data=np.abs(H), ordinate_spec_data_type=0)
    other = record(rsp_node=7, rsp_dir=-2, data=2.0 * H)
    write_uff(tmp_path / "lab.uff", record(), coherence, other)
    return tmp_path


@pytest.mark.parametrize(
    "choice",
    [
        {"record": 3},
        {"response": {"node": 7, "direction": "-y"}},
        {
            "response": {"node": 7, "direction": "-y"},
            "reference": {"node": 1, "direction": "-x"},
        },
    ],
)
def test_a_record_is_chosen_by_number_or_by_its_points(several, choice):
    np.testing.assert_allclose(read(several, **LAB, **choice).response, 2.0 * H, rtol=1e-6)


HELD = (
    "1: FRF of 5 z by 1 -x, accelerance; 2: coherence of 5 z by 1 -x, quantity unknown; "
    "3: FRF of 7 -y by 1 -x, accelerance"
)
ASK = "name one by record, or response and reference"


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ({}, f"lab.uff: 2 records fit; {ASK}: {HELD}"),
        ({"record": 4}, f"lab.uff: no record fits; {ASK}: {HELD}"),
        (
            {"response": {"node": 7, "direction": "y"}},
            f"lab.uff: no record fits; {ASK}: {HELD}",
        ),
        (
            {"record": 2},
            "lab.uff: not a frequency response: record 2: coherence of 5 z by 1 -x, "
            "quantity unknown",
        ),
    ],
)
def test_a_choice_that_does_not_fit_lists_what_the_file_holds(several, choice, message):
    assert refused(several, **LAB, **choice) == message


BROKEN = {
    "falling": ({"x": F[::-1]}, "lab.uff:1: record 1: 15 Hz is out of order; frequencies have to"),
    "real": ({"ord_data_type": 4, "data": np.abs(H)}, "lab.uff:1: record 1: its values are real"),
    "time": ({"abscissa_spec_data_type": 17}, "lab.uff:1: record 1: its abscissa is no frequency"),
    "transmissibility": (
        {"orddenom_spec_data_type": 12},
        "lab.uff:1: record 1: its reference is no force",
    ),
    "no quantity": (
        {"ordinate_spec_data_type": 0},
        "lab.uff: the record does not say its quantity",
    ),
}


@pytest.mark.parametrize(("header", "message"), BROKEN.values(), ids=BROKEN)
def test_a_wrong_record_is_refused(tmp_path, header, message):
    write_uff(tmp_path / "lab.uff", record(**header))
    assert refused(tmp_path, **LAB).startswith(message)


def test_a_value_that_is_no_number_is_refused(tmp_path):
    write_uff(tmp_path / "lab.uff", record())
    written = (tmp_path / "lab.uff").read_text()
    assert written.count("-2.00000000000e-03") == 2
    broken = written.replace("-2.00000000000e-03", "               NaN", 1)
    (tmp_path / "lab.uff").write_text(broken)
    assert refused(tmp_path, **LAB) == "lab.uff:1: record 1: value 2 is not a finite number"


def test_a_universal_file_that_is_cut_off_is_refused_by_the_line(tmp_path):
    write_uff(tmp_path / "lab.uff", record(), record(rsp_node=6))
    whole = (tmp_path / "lab.uff").read_text().splitlines(keepends=True)
    begins = [n for n, line in enumerate(whole, start=1) if line == "    -1\n"][2]
    (tmp_path / "lab.uff").write_text("".join(whole[:-2]))
    expected = f"lab.uff:{begins}: the data set that begins here has no end: the file is cut off"
    assert refused(tmp_path, **LAB) == expected


def test_a_record_that_lacks_values_is_refused(tmp_path):
    write_uff(tmp_path / "lab.uff", record())
    whole = (tmp_path / "lab.uff").read_text().splitlines(keepends=True)
    (tmp_path / "lab.uff").write_text("".join(whole[:-2] + whole[-1:]))
    expected = "lab.uff:1: record 1: has 3 of 4 values: the file is cut off"
    assert refused(tmp_path, **LAB) == expected


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("1,2,3\n", "lab.uff: not a universal file: no data set begins, by a line of -1"),
        ("    -1\n    15\n    -1\n", "lab.uff: a universal file without a data set 58 (functions)"),
        (
            "    -1\n    58\nshort\n    -1\n",
            "lab.uff:1: the data set 58 that begins here cannot be read: "
            "Error when reading data-set(s).",
        ),
    ],
)
def test_what_is_no_universal_file_is_refused(tmp_path, content, message):
    (tmp_path / "lab.uff").write_text(content)
    assert refused(tmp_path, **LAB) == message


def test_without_pyuff_the_message_says_what_brings_it(tmp_path, monkeypatch):
    write_uff(tmp_path / "lab.uff", record())
    monkeypatch.setitem(sys.modules, "pyuff", None)
    expected = 'universal files need pyuff: `pip install "tyrefrf[uff]"` brings it'
    assert refused(tmp_path, **LAB) == expected


# agreement


LINES = np.arange(0.0, 401.0, 2.5)


def measured_from(results, **more):
    """The computed response of the shoulder, as if it had been measured."""
    response = results.response("radial", "shoulder", "accelerance").copy()
    curve = Measured("lab", "radial", "shoulder", "accelerance", results.frequency, response)
    return replace(curve, **more)


@pytest.fixture
def computed():
    return synthetic.results(LINES)


def against(results, curve):
    (found,) = agreements(replace(results, measured=(curve,)))
    return found


@pytest.mark.parametrize(("factor", "decibels"), [(1.0, 0.0), (2.0j, -6.0206), (-0.5, 6.0206)])
def test_the_criterion_is_blind_to_a_factor_and_the_level_is_not(computed, factor, decibels):
    curve = measured_from(computed)
    found = against(computed, replace(curve, response=factor * curve.response))
    assert found.frac == pytest.approx(1.0, abs=1e-12)
    assert found.level == pytest.approx(decibels, abs=1e-4)
    assert (found.first, found.last, found.n_lines) == (0.0, 400.0, 161)
    assert found.quantity == "accelerance"


def test_the_criterion_is_its_formula():
    a, b = np.array([1.0, 2.0j, 0.0]), np.array([1.0 + 1.0j, 1.0, 3.0])
    assert frac(a, b) == pytest.approx(abs((1 + 1j) - 2j) ** 2 / (5.0 * 12.0))
    assert frac(a, np.array([2.0j, 1.0, 0.0])) == pytest.approx(0.0, abs=1e-15)  # orthogonal
    assert level(a, b) == pytest.approx(np.mean([20 * np.log10(2**0.5), -20 * np.log10(2.0)]))


def test_the_computed_curve_goes_to_the_measured_lines(computed):
    """A cubic in frequency on uneven computed lines is met to rounding between them."""
    lines = np.array([0.0, 1.0, 3.0, 4.0, 8.0, 9.0, 20.0])
    f = np.array([0.5, 2.0, 6.0, 15.0])

    def cubic(x):
        return x**3 - 2j * x**2 + 5.0

    np.testing.assert_allclose(interpolated(f, lines, cubic(lines)), cubic(f), rtol=1e-12)


def test_half_of_the_computed_lines_change_the_criterion_little(computed):
    curve = measured_from(computed)
    coarse = synthetic.results(LINES[::2])
    found = against(coarse, curve)
    assert found.n_lines == 161
    assert 1.0 - found.frac < 1e-3  # a peak's bandwidth is a few lines


def test_only_lines_between_answered_ones_count():
    lines, answered = np.array([0.0, 10.0, 20.0, 30.0]), np.array([True, True, False, True])
    f = np.array([-1.0, 0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 31.0])
    expected = [False, True, True, True, False, False, False, True, False]
    np.testing.assert_array_equal(within(f, lines, answered), expected)


@pytest.mark.parametrize(("f", "n_lines"), [((390.0, 900.0), 1), ((800.0, 900.0), 0)])
def test_with_less_than_two_common_lines_there_is_no_criterion(computed, f, n_lines):
    curve = measured_from(computed, frequency=np.array(f), response=np.ones(2) + 0j)
    found = against(computed, curve)
    assert found.n_lines == n_lines
    assert np.isnan([found.frac, found.level]).all()


@pytest.mark.parametrize("quantity", ["receptance", "mobility", "accelerance"])
def test_every_quantity_is_the_same_mobility(computed, quantity):
    response = computed.response("radial", "shoulder", quantity).copy()
    curve = Measured("lab", "radial", "shoulder", quantity, computed.frequency, response)
    expected = computed.response("radial", "shoulder")
    np.testing.assert_allclose(curve.mobility[1:], expected[1:], rtol=1e-14)
    assert np.isnan(curve.mobility[0]) == (quantity == "accelerance")


def test_a_response_of_another_shape_is_refused():
    with pytest.raises(ResultsError, match="measured 'lab': a response of shape"):
        Measured("lab", "radial", "shoulder", "mobility", F, H[:3])


# the results file


@pytest.fixture
def kept(computed):
    short = Measured("CSV, 'run 7'", "radial", "radial.drive", "mobility", F, H)
    return replace(computed, measured=(measured_from(computed), short))


def assert_same(read, written):
    for field in fields(Measured):
        one, other = getattr(read, field.name), getattr(written, field.name)
        np.testing.assert_array_equal(one, other, strict=True)


def test_measured_responses_come_back_to_the_bit(kept, tmp_path):
    write_results(tmp_path / "run.h5", kept)
    read_back = load_results(tmp_path / "run.h5").measured
    assert len(read_back) == 2
    assert_same(read_back[0], kept.measured[0])
    assert_same(read_back[1], kept.measured[1])
    assert agreements(replace(kept, measured=read_back)) == agreements(kept)


def test_a_file_with_measured_responses_describes_itself(kept, tmp_path):
    write_results(tmp_path / "run.h5", kept)
    assert undescribed(tmp_path / "run.h5") == []
    with xarray.open_datatree(tmp_path / "run.h5", engine="h5netcdf") as tree:
        curve = tree["measured"]["1"]
        np.testing.assert_array_equal(curve["response"].sel(line=12.5), H[1])
        assert curve["quantity"].item() == "mobility"


def test_without_measured_responses_the_file_has_no_such_group(computed, tmp_path):
    write_results(tmp_path / "run.h5", computed)
    assert load_results(tmp_path / "run.h5").measured == ()
    with h5py.File(tmp_path / "run.h5") as file:
        assert "measured" not in file
        assert "probe_sensor_mass" not in file


def test_the_mass_of_a_sensor_comes_back_with_its_probe(computed, tmp_path):
    shoulder = replace(computed.probes[0], sensor_mass=0.005)
    sensed = replace(computed, probes=(shoulder, *computed.probes[1:]))
    write_results(tmp_path / "run.h5", sensed)
    assert load_results(tmp_path / "run.h5").probes == sensed.probes
    assert shoulder.label == "shoulder: r at outer 0.320, 0°, sensor 5 g"


def test_points_of_a_sweep_keep_them_once(kept, tmp_path):
    axis = Axis("pressure", "inflation.pressure", "Pa", "internal pressure", (1e5, 2e5))
    write_sweep(tmp_path / "sweep.h5", SweepResults((axis,), (kept, kept), kept.provenance))
    read_back = load_sweep(tmp_path / "sweep.h5")
    assert all(len(point.measured) == 2 for point in read_back.points)
    assert_same(read_back.points[-1].measured[1], kept.measured[1])
    with h5py.File(tmp_path / "sweep.h5") as file:
        assert file["measured/1/response"].shape == (4,)
