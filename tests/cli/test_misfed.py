"""Files and cases that nobody would give on purpose: a message, status 2 or 1, never a traceback,
never a hang.
"""

from __future__ import annotations

import os
import re
import tomllib

import numpy as np
import pytest
import tomli_w
from command import command_here, tyrefrf_command
from hdf5 import seal_again
from small import TEXT

from tests.faults.bases import bases, lay_out
from tyrefrf.case import parse_case
from tyrefrf.errors import CaseError

NONE_DRAWN = "[output]\nplots = []\n"


def refused(done, *words: str) -> None:
    """Status 2, every line of stderr at a line of the case, and these words."""
    assert done.status == 2, done
    lines = done.stderr.splitlines()
    assert lines
    assert all(re.match(r"case\.toml:[1-9][0-9]*: \S", line) for line in lines), lines
    for word in words:
        assert word in done.stderr


@pytest.fixture
def told(tmp_path):
    """What a command says of the text, or bytes, of a case."""

    def told(case: str | bytes, *words: str):
        data = case.encode() if isinstance(case, str) else case
        (tmp_path / "case.toml").write_bytes(data)
        return command_here(*(words or ("run",)), "case.toml", cwd=tmp_path)

    return told


# --- the case file itself ---


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (bytes(range(256)) * 100, "is not UTF-8 text: byte 0x80"),
        (np.random.default_rng(0).bytes(100_000), "is not UTF-8 text"),
        (b"\x00" * 1000, "not valid TOML"),
        (b"", "missing"),
        (b"\x89HDF\r\n\x1a\n" + bytes(1000), "is not UTF-8 text: byte 0x89"),
    ],
    ids=["all bytes", "random bytes", "zeros", "nothing", "HDF5"],
)
def test_binary_garbage(told, data, words):
    refused(told(data), words)


def test_a_case_file_of_a_hundred_megabytes(tmp_path):
    with (tmp_path / "case.toml").open("wb") as file:
        for _ in range(100):
            file.write(b"# all comment\n" * 75_000)
    done = tyrefrf_command("run", "case.toml", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (
        2, "case.toml: is larger than 10 MB; not a case file\n",
    )  # fmt: skip


NESTED = {
    "arrays": "a = " + "[" * 99_999,
    "closed arrays": "a = " + "[" * 99_999 + "]" * 99_999,
    "more arrays": "a = " + "[" * 1_000_000,
    "inline tables": "a = " + "{a = " * 99_999,
    "closed inline tables": "a = " + "{a = " * 99_999 + "1" + "}" * 99_999,
    "a dotted key": "a" + ".a" * 100_000 + " = 1",
    "a dotted header": "[a" + ".a" * 100_000 + "]",
    "a quoted dotted key": '"a"' + '. "a"' * 100_000 + " = 1",
}


@pytest.mark.parametrize("text", NESTED.values(), ids=NESTED)
def test_deep_nesting(told, text):
    done = told(TEXT + text)
    refused(done)
    assert len(done.stderr) < 200


MANY = {
    "keys": "".join(f"k{i} = 1\n" for i in range(400_000)),
    "tables": "".join(f"[t{i}]\n" for i in range(400_000)),
    "values": "a = [" + "1," * 1_300_000 + "]",
}


@pytest.mark.parametrize("text", MANY.values(), ids=MANY)
def test_what_would_keep_the_parser_busy_for_minutes_is_refused_at_once(told, text):
    refused(told(text), "too much for a case")


def test_a_thousand_mistakes_are_a_hundred_messages(told):
    done = told(TEXT + "".join(f"k{i} = 1\n" for i in range(1000)))
    refused(done, "more problems than these 100")
    assert len(done.stderr.splitlines()) == 101


# --- numbers ---


def numbers_of(data, key=()):
    """The places of all numbers in a case, with a unit or without."""
    for part, value in data.items() if isinstance(data, dict) else enumerate(data):
        if isinstance(value, dict | list):
            yield from numbers_of(value, (*key, part))
        elif re.match(r"[0-9.]+( |$)", str(value)) and value is not True:
            yield (*key, part)


def with_value(data, key, value):
    """The data with another value at a place."""
    data = tomllib.loads(tomli_w.dumps(data))
    here = data
    for part in key[:-1]:
        here = here[part]
    here[key[-1]] = value
    return data


@pytest.mark.parametrize("name", bases())
def test_nan_and_infinities_are_refused_wherever_a_number_may_stand(name):
    data = tomllib.loads(bases()[name])
    places = [key for key in numbers_of(data) if "columns" not in key]  # those may be words
    assert len(places) > 5
    for key in places:
        for value in (float("nan"), float("inf"), float("-inf"), "nan Pa", "1e999 MPa"):
            text = tomli_w.dumps(with_value(data, key, value))
            with pytest.raises(CaseError) as caught:
                parse_case(text, "case.toml", "case")
            assert all(problem.line > 0 for problem in caught.value.problems), key


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("rho = 1200.0", "rho = 0", "rho: 0 kg/m3 is out of range; must be at least 0.001 kg/m3"),
        ("rho = 1200.0", "rho = -0.0", "rho: -0.0 kg/m3 is out of range"),
        ("rho = 1200.0", "rho = -1200", "rho: -1200 kg/m3 is out of range"),
        ("rho = 1200.0", "rho = 5e-324", "rho: 5e-324 kg/m3 is out of range"),
        ("nu = 0.42", "nu = 0.5", "nu: 0.5 is out of range; must be below 0.5"),
        ("nu = 0.42", "nu = 0.49999999", "nu: 0.49999999 is too near to 0.5; must be from"),
        ("nu = 0.42", "nu = -1", "nu: -1 is out of range; must be above -1"),
        ("nu = 0.42", "nu = -0.99999999", "nu: -0.99999999 is too near to -1"),
        ('E = "80 MPa"', "E = 0.0", "E: 0.0 Pa is out of range; must be at least 1 Pa"),
        ('E = "80 MPa"', "E = 1e300", "E: 1e+300 Pa is out of range; must be at most 1e+15 Pa"),
        ("eta = 0.1", "eta = -1e-9", "eta: -1e-09 is out of range"),
        ("sector_angle = 24.0", "sector_angle = 0", "sector_angle: 0 deg is out of range"),
        ("sector_angle = 24.0", "sector_angle = -24", "sector_angle: -24 deg is out of range"),
        ("sector_angle = 24.0", "sector_angle = 1e-300", "sector_angle: 1e-300 deg is too small"),
        ("sector_angle = 24.0", "sector_angle = 1e-3", "sector_angle: 0.001 deg is too small"),
        ("sector_angle = 24.0", "sector_angle = 1e300", "sector_angle: 1e+300 deg is out of range"),
        ("elements_along = 8", "elements_along = 10_000_000", "elements_along: 10000000 is out of"),
        (
            "elements_along = 8",
            f"elements_along = {10**400}",
            "a huge number is out of range",
        ),
    ],
)
def test_numbers_that_no_tyre_has(told, old, new, words):
    assert old in TEXT
    refused(told(TEXT.replace(old, new)), words)


def test_poisson_s_ratio_just_below_a_half_is_judged_by_the_residual(told):
    text = TEXT.replace("nu = 0.42", "nu = 0.4999999") + NONE_DRAWN
    done = told(text, "run", "--jobs", "1")
    assert done.status == 1, done
    assert re.search(r"420 Hz: residual .* is above 1e-08", done.stderr)
    assert told(text.replace("9999", "9"), "run", "--jobs", "1", "--force").status == 0


VALUES = "values = [0.0, 40.0, 150.0, 420.0]"


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("stop = 1000\nstep = 1e-6", "step: 1e-06 Hz is out of range; must be at least 0.001 Hz"),
        ("stop = 1e6\nstep = 1e-3", "step: makes 1000000001 lines; must make at most 1000000"),
        ("stop = 1000\ncount = 1_000_000_000", "count: 1000000000 is out of range"),
        ("stop = 1000\nstart = 1\nspacing = 'log'\ncount = 1_000_000_000", "count: 1000000000 is"),
        ("values = [" + "1.0," * 1_250_000 + "]", "too much for a case"),
        ("values = [" + "0.5," * 1_100_000 + "]", "1100000 entries are too many"),
        ("values = [0.0, 5e-324, 1e-300]", "values[1]: 4.94066e-324 Hz is too near to 0"),
    ],
    ids=["tiny step", "small step", "count", "log", "list", "long list", "denormal"],
)
def test_a_thousand_million_lines(told, lines, words):
    refused(told(TEXT.replace(VALUES, lines)), words)


# --- names ---

HOSTILE = {
    "path": "../../up",
    "absolute": "/tmp/away",
    "backslashes": "..\\up",
    "dots": "..",
    "dot": ".",
    "hidden": ".ssh",
    "nothing": "",
    "blank": " ",
    "reserved": "CON",
    "reserved with ending": "nul.txt",
    "long": "x" * 100,
    "too long": "x" * 101,
    "right to left": "a\u202eb",
    "accents": "a\u0301" * 40,
    "Chinese": "轮胎",
    "emoji": "🛞",
    "quotes": "\"'`",
    "dollar": "$HOME ${x} $(x) $a^{b$",
    "percent": "%s %d {0} {x!r}",
    "option": "--force",
    "stars": "*?[a]",
    "line separator": "a\u2028b",
    "next line": "a\x85b",
}
REFUSED_NAMES = {"nul": "a\x00b", "newline": "a\nb", "escape": "a\x1b[31mb", "delete": "a\x7fb"}


def quoted(name: str) -> str:
    return tomli_w.dumps({"x": name}).strip().removeprefix("x = ")


@pytest.mark.parametrize("name", [*HOSTILE.values(), *REFUSED_NAMES.values()], ids=repr)
def test_a_case_s_name_is_one_that_any_file_system_takes(told, name):
    done = told(f"name = {quoted(name)}\n{TEXT}", "check")
    reserved = name.lower() in ("con", "nul.txt")
    if re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}", name) and not reserved:
        assert done.status == 0, done
    else:
        refused(done, "name: ")


@pytest.mark.parametrize("name", HOSTILE.values(), ids=HOSTILE)
def test_names_of_loads_probes_and_materials_are_labels_and_no_paths(tmp_path, told, name):
    """The whole run, with plots, tables and universal file, where the name is accepted at all."""
    text = TEXT.replace('"radial"', quoted(name)).replace('"sidewall"', quoted(f"{name}2"))
    text = text.replace('"rubber"', quoted(name)).replace("materials.rubber", "materials.stuff")
    data = tomllib.loads(text)
    data["materials"] = {name: data["materials"]["stuff"]}
    data["output"] = {"plots": ["png"], "export": ["csv", "mat", "uff58"]}
    data["frequency"] = {"values": [100.0, 200.0]}
    done = told(tomli_w.dumps(data), "run", "--jobs", "1")
    if 0 < len(name) < 100:
        assert done.status == 0, done
        there = {path.relative_to(tmp_path).parts[0] for path in tmp_path.rglob("*")}
        assert there == {"case.toml", "results"}
    else:
        refused(done, "is not valid; expected: ")


@pytest.mark.parametrize("name", REFUSED_NAMES.values(), ids=REFUSED_NAMES)
@pytest.mark.parametrize("where", ['"radial"', '"sidewall"', '"rubber"'])
def test_names_that_would_break_a_line_are_refused_and_not_printed_raw(told, name, where):
    done = told(TEXT.replace(where, quoted(name)), "check")
    refused(done)
    assert not set(done.stderr) & set("\x00\x1b\x7f\x85")


@pytest.mark.parametrize("name", [*HOSTILE.values(), *REFUSED_NAMES.values()], ids=repr)
def test_a_name_of_a_parameter_that_is_none_is_refused(told, name):
    entry = tomli_w.dumps({"sweep": {name: [1.0, 2.0]}})
    refused(told(TEXT + entry, "check"))


@pytest.mark.parametrize("name", [*HOSTILE.values(), *REFUSED_NAMES.values()], ids=repr)
@pytest.mark.parametrize("key", ["plots", "export"])
def test_formats_are_those_that_there_are(told, key, name):
    refused(told(TEXT + tomli_w.dumps({"output": {key: [name]}}), "check"), f"output.{key}[0]: ")


# --- files that a case names ---

FILES = {
    "mesh": ("mesh_section", "meshes/section.inp", "mesh.file"),
    "Gmsh": ("gmsh", "section.msh", "mesh.file"),
    "Ansys": ("ansys", "section.cdb", "mesh.file"),
    "matrix": ("brought", "K.mtx", "matrices.K"),
    "nodes": ("brought", "nodes.csv", "matrices.nodes"),
    "set": ("brought", "rim.txt", "matrices.rim"),
    "CSV": ("measured", "curve.csv", "measured[0].file"),
    "UFF": ("measured", "curve.uff", "measured[1].file"),
}
COMMANDS = (("check",), ("run", "--jobs", "1"), ("modes",))


@pytest.fixture(scope="module")
def laid_out(tmp_path_factory):
    directory = tmp_path_factory.mktemp("files")
    lay_out(directory)
    return directory


def missing(path):
    """There is no such file."""


def a_directory(path):
    path.mkdir()


def a_pipe(path):
    os.mkfifo(path)


def endless(path):
    path.symlink_to("/dev/zero")


def empty_device(path):
    path.symlink_to("/dev/null")


def a_loop(path):
    path.symlink_to(path.name)


def broken(path):
    path.symlink_to("nowhere")


def empty(path):
    path.write_bytes(b"")


def garbage(path):
    path.write_bytes(np.random.default_rng(1).bytes(50_000))


def zeros(path):
    path.write_bytes(bytes(50_000))


CONTENTS = (empty, garbage, zeros)


def huge(path):
    with path.open("wb") as file:
        file.truncate(3_000_000_000)


@pytest.mark.parametrize(
    "make",
    [missing, a_directory, a_pipe, endless, empty_device, a_loop, broken, *CONTENTS, huge],
)
@pytest.mark.parametrize("kind", FILES)
def test_a_file_that_is_none_is_refused_at_its_key(kind, make, laid_out):
    base, file, key = FILES[kind]
    path = laid_out / file
    whole = path.read_bytes()
    path.unlink()
    (laid_out / "case.toml").write_text(bases()[base])
    try:
        make(path)
        for command in COMMANDS if kind not in ("CSV", "UFF") else COMMANDS[:2]:
            refused(command_here(*command, "case.toml", "--output", "o", cwd=laid_out)
                    if command[0] != "check" else command_here("check", "case.toml", cwd=laid_out),
                    f": {key}")  # fmt: skip
    finally:
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        else:
            path.unlink(missing_ok=True)
        path.write_bytes(whole)


@pytest.mark.parametrize("name", ["/dev/zero", "/dev/stdin", "", "a\x00b", "..", "/", "x" * 5000])
@pytest.mark.parametrize("kind", FILES)
def test_names_of_files_that_are_none(kind, name, laid_out):
    base, file, _ = FILES[kind]
    text = bases()[base]
    assert f'"{file}"' in text
    (laid_out / "case.toml").write_text(text.replace(f'"{file}"', quoted(name)))
    refused(command_here("check", "case.toml", cwd=laid_out))


INCLUDES = {
    "itself": {"a.inp": "*INCLUDE, INPUT=a.inp\n"},
    "each other": {"a.inp": "*INCLUDE, INPUT=b.inp\n", "b.inp": "*INCLUDE, INPUT=a.inp\n"},
    "itself on a winding way": {"a.inp": "*INCLUDE, INPUT=meshes/../a.inp\n"},
    "a pipe": {"a.inp": "*INCLUDE, INPUT=pipe\n"},
    "a device": {"a.inp": "*INCLUDE, INPUT=/dev/zero\n"},
    "nothing": {"a.inp": "*INCLUDE\n"},
    "twice, and that twice": {
        f"{'a' if k == 0 else k}.inp": f"*INCLUDE, INPUT={k + 1}.inp\n" * 2 for k in range(40)
    },
    "a long chain": {
        f"{'a' if k == 0 else k}.inp": f"*INCLUDE, INPUT={k + 1}.inp\n" for k in range(60)
    },
}


@pytest.mark.parametrize("files", INCLUDES.values(), ids=INCLUDES)
def test_files_that_include(files, tmp_path):
    lay_out(tmp_path)
    os.mkfifo(tmp_path / "pipe")
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    text = bases()["mesh_section"].replace("meshes/section.inp", "a.inp")
    (tmp_path / "case.toml").write_text(text)
    refused(command_here("run", "case.toml", cwd=tmp_path), "mesh.file")


RANGES = {
    "a range of all numbers": "*NSET, NSET=R, GENERATE\n1, 900000000000, 1\n",
    "many ranges": "*NSET, NSET=R, GENERATE\n" + "1, 9999999, 1\n" * 1000,
    "a set of itself twice over": "*ELSET, ELSET=D\nRUBBER\n" + "*ELSET, ELSET=D\nD, D\n" * 60,
    "a number of 5000 digits": "*NSET, NSET=R\n" + "9" * 5000 + "\n",
    "a number beyond 64 bits": "*NODE\n99999999999999999999999, 0., 0., 0.\n",
    "a superscript": "*NSET, NSET=R\n\u00b2\n",
    "signs": "*NSET, NSET=R\n+-+5\n",
}


@pytest.mark.parametrize("more", RANGES.values(), ids=RANGES)
def test_sets_that_grow_without_end(more, tmp_path):
    lay_out(tmp_path)
    path = tmp_path / "meshes" / "section.inp"
    path.write_text(path.read_text() + more)
    (tmp_path / "case.toml").write_text(bases()["mesh_section"])
    refused(command_here("check", "case.toml", cwd=tmp_path), "mesh.file")


# --- results files ---


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    directory = tmp_path_factory.mktemp("results")
    text = TEXT.replace("420.0]", "420.0]\n") + NONE_DRAWN
    (directory / "case.toml").write_text(text)
    assert command_here("run", "case.toml", "--jobs", "1", cwd=directory).status == 0
    return directory / "results/case/case.h5"


READING = (("info",), ("info", "--json"), ("plot",), ("export", "--to", "csv"))
READING += (("export", "--to", "vtk", "--at", "100"),)


def other_program(path, whole):
    import h5py

    with h5py.File(path, "w") as file:
        file["mobility"] = np.zeros(5)
        file.attrs["program"] = "another"


def no_program(path, whole):
    import h5py

    h5py.File(path, "w").close()


def a_newer_layout(path, whole):
    import h5py

    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file.attrs["layout"], file.attrs["version"] = 99, "9.9"
    seal_again(path)


def a_case_that_is_none(path, whole):
    import h5py

    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file.attrs["resolved_case"] = "no [TOML"
    seal_again(path)


def truncated(path, whole):
    path.write_bytes(whole[: len(whole) // 2])


def a_case(path, whole):
    path.write_text(TEXT)


@pytest.mark.parametrize(
    "make",
    [
        *(other_program, no_program, a_newer_layout, truncated, a_case, *CONTENTS),
        *(missing, a_directory, a_pipe, endless, empty_device, a_loop, broken),
    ],
)
def test_a_results_file_that_is_none_is_refused(make, finished, tmp_path):
    path, whole = tmp_path / "x.h5", finished.read_bytes()
    make(path, whole) if make.__code__.co_argcount == 2 else make(path)
    for command, *more in READING:
        done = command_here(command, "x.h5", *more, cwd=tmp_path)
        assert done.status == 1, done
        assert done.stderr.startswith("x.h5: ")
        assert len(done.stderr.splitlines()) == 1


def test_a_case_in_a_results_file_that_cannot_be_solved_again_is_said(finished, tmp_path):
    a_case_that_is_none(tmp_path / "x.h5", finished.read_bytes())
    done = command_here("export", "x.h5", "--to", "vtk", "--at", "100", cwd=tmp_path)
    assert done.status in (1, 2), done
    assert "not valid TOML" in done.stderr
