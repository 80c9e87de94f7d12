"""Ways to spoil a case: kinds of fault, each with what hypothesis draws of it.

A drawn case is its bytes, as a file holds them. Near cases are those of `bases` with one to three
faults of one kind, or of several; far ones are any document, any text and any bytes.
"""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import tomli_w
from hypothesis import strategies as st

from .bases import bases, files

CASE = "case.toml"
COMMANDS = ("run", "run", "run", "check", "sweep", "modes", "dispersion", "export")


@dataclass(frozen=True, slots=True)
class Spoilt:
    """A file of a case, the kind of its faults, and the command that the case is given to.

    file: its name; case: the text of the case that names it, where it is another file.
    """

    kind: str
    command: str
    data: bytes
    file: str = CASE
    case: bytes = b""


Draw = Callable[..., Any]
Place = tuple[str | int, ...]

NAN = [float("nan"), float("inf"), float("-inf"), "nan", "inf Pa", "nan mm", "1e999 MPa", "-inf Hz"]
ZERO = [0, 0.0, -0.0, -1, -1.0, -1e-30, -1e30, "0 mm", "-0.0 MPa", "-1 bar", "-8 deg"]
HUGE = [
    1e15,
    1e30,
    1e150,
    1e300,
    1.7976931348623157e308,
    10**9,
    2**63,
    10**30,
    10**400,
    "1e300 GPa",
]
TINY = [5e-324, 2.2e-308, 1e-300, 1e-150, 1e-30, 1e-15, 1e-9, "1e-300 mm", "1e-30 Pa", "1e-12 deg"]
EDGE = [
    *(0.5, 0.4999999, 0.49999999999999, -0.9999999, -1, 1, 1.0, 2, 3, 4, 360, 360.0, 180, 120, 90),
    *(359.99999999, 1e-3, 1e-6, 1000, 10**6, 100, 0.05, 0.014, 30.0, 7.2, 51, 101, 2001),
]
TEXTS = [
    *("", " ", "a/b", "../../up", "..", ".", "/tmp/away", "C:\\away", "CON", "nul", "a\x00b"),
    *("a\nb", "\u202e\u0301", "naïve 轮胎", "x" * 100, "x" * 101, "y" * 5000, "rubber", "radial"),
    *("radial.drive", "area.1", "hub", "*", "{0}", "%s", "$HOME", "~", "a\u2028b", "-rf", "node"),
    *(
        "point",
        "patch",
        "region",
        "r",
        "theta",
        "log",
        "hex20",
        "hex8",
        "modal",
        "cyclic",
        "direct",
    ),
    *(
        "png",
        "csv",
        "linear",
        "nonlinear",
        "meshes/section.inp",
        "meshes",
        "/dev/zero",
        "/dev/null",
    ),
]
UNITS = [
    *(
        "7 deg",
        "7 degg",
        "14 mm",
        "1 kHz",
        "2.2 bar",
        "5 g",
        "28 MPa",
        "1e3",
        "1_000 Pa",
        "0x10 Pa",
    ),
    *(
        "\uff11\uff12 mm",
        "1,5 mm",
        "1 m m",
        "--1 m",
        "1e99999 m",
        "1 1/s",
        "20 degC",
        "1 rad",
        "1 dB",
    ),
]
LOOSE = (
    st.sampled_from([*NAN, *ZERO, *HUGE, *TINY, *EDGE, *TEXTS, *UNITS])
    | st.booleans()
    | st.floats()
    | st.integers()
    | st.text(max_size=8)
    | st.dates()
    | st.datetimes()
    | st.times()
)
KEYS = (
    st.sampled_from(
        [
            *("E", "nu", "rho", "eta", "modulus", "E_static", "kind", "name", "s", "node", "angle"),
            *("surface", "direction", "diameter", "values", "start", "stop", "step", "count"),
            *("spacing", "adaptive", "tolerance", "sector_angle", "elements_around", "element"),
            *("elements_along", "elements_through", "material", "tread", "belt", "bead", "mesh"),
            *("geometry", "matrices", "materials", "cell", "frequency", "loads", "probes", "sweep"),
            *("output", "solver", "measured", "inflation", "pressure", "damping", "alpha", "beta"),
            *("sensor_mass", "grooves", "width", "depth", "rib", "modes", "cutoff", "library"),
        ]
    )
    | st.sampled_from(TEXTS)
    | st.text(max_size=4)
)
JUNK = st.recursive(
    LOOSE,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=4),
    max_leaves=10,
)


def _plain(data: Any) -> Any:
    """The same data with what TOML has no word for left out."""
    return tomllib.loads(tomli_w.dumps(data))


def _places(data: Any, key: Place = ()) -> list[Place]:
    """The keys of all values in nested data."""
    items = data.items() if isinstance(data, dict) else enumerate(data)
    found: list[Place] = []
    for part, value in items:
        found.append((*key, part))
        if isinstance(value, dict | list):
            found += _places(value, (*key, part))
    return found


def _at(data: Any, key: Place) -> Any:
    for part in key:
        data = data[part]
    return data


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_quantity(value: Any) -> bool:
    return _is_number(value) or (isinstance(value, str) and value[:1].isdigit())


def _replace(
    data: Any, draw: Draw, fits: Callable[[Any], bool], value: Callable[[Any], Any]
) -> None:
    """Give one of the values that fit another value."""
    places = [key for key in _places(data) if fits(_at(data, key))]
    if places:
        key = draw(st.sampled_from(places))
        _at(data, key[:-1])[key[-1]] = value(_at(data, key))


def _replacing(
    values: list[Any], fits: Callable[[Any], bool] = _is_quantity
) -> Callable[..., None]:
    def spoil(data: Any, draw: Draw) -> None:
        _replace(data, draw, fits, lambda _: copy.deepcopy(draw(st.sampled_from(values))))

    return spoil


def _scaled(data: Any, draw: Draw) -> None:
    """A number, so many times larger or smaller."""
    factor = draw(st.sampled_from([10.0**k for k in range(-9, 10) if k] + [0.5, 2.0, 3.0, -1.0]))
    _replace(data, draw, _is_number, lambda x: type(x)(x * factor) if abs(x) < 1e300 else x)


def _nearby(data: Any, draw: Draw) -> None:
    """A number not far from what it was."""
    shift = draw(st.floats(-0.3, 0.3))

    def moved(x: Any) -> Any:
        return x + draw(st.integers(-2, 4)) if isinstance(x, int) else x * (1.0 + shift)

    _replace(data, draw, _is_number, moved)


def _wrong_type(data: Any, draw: Draw) -> None:
    _replace(data, draw, lambda _: True, lambda _: draw(JUNK))


def _nested(data: Any, draw: Draw) -> None:
    """A value within arrays or tables."""
    depth, table = draw(st.integers(1, 6)), draw(st.booleans())

    def within(x: Any) -> Any:
        for _ in range(depth):
            x = {draw(KEYS): x} if table else [x]
        return x

    _replace(data, draw, lambda _: True, within)


def _any_key(data: Any, draw: Draw) -> Place | None:
    places = [key for key in _places(data) if isinstance(key[-1], str)]
    return draw(st.sampled_from(places)) if places else None


def _removed(data: Any, draw: Draw) -> None:
    key = draw(st.sampled_from(_places(data) or [()]))
    if key:
        del _at(data, key[:-1])[key[-1]]


def _renamed(data: Any, draw: Draw) -> None:
    key = _any_key(data, draw)
    if key:
        table = _at(data, key[:-1])
        table[draw(KEYS)] = table.pop(key[-1])


def _added(data: Any, draw: Draw) -> None:
    tables = [(), *(key for key in _places(data) if isinstance(_at(data, key), dict))]
    _at(data, draw(st.sampled_from(tables)))[draw(KEYS)] = draw(JUNK)


def _doubled(data: Any, draw: Draw) -> None:
    """An entry of a list, once more, or a table under another name."""
    lists = [key for key in _places(data) if isinstance(_at(data, key), list) and _at(data, key)]
    if lists and draw(st.booleans()):
        entries = _at(data, draw(st.sampled_from(lists)))
        entries.append(copy.deepcopy(draw(st.sampled_from(entries))))
    elif key := _any_key(data, draw):
        table = _at(data, key[:-1])
        table[draw(KEYS)] = copy.deepcopy(table[key[-1]])


def _exchanged(data: Any, draw: Draw) -> None:
    """A value in the place of another."""
    places = _places(data)
    if places:
        one, other = (draw(st.sampled_from(places)) for _ in range(2))
        value = copy.deepcopy(_at(data, other))
        _at(data, one[:-1])[one[-1]] = value


OF_VALUES: dict[str, Callable[..., None]] = {
    "NaN or infinite": _replacing(NAN),
    "zero or negative": _replacing(ZERO),
    "huge": _replacing(HUGE),
    "tiny": _replacing(TINY),
    "at a bound": _replacing(EDGE),
    "times a power of ten": _scaled,
    "somewhat other": _nearby,
    "another unit": _replacing(UNITS),
    "hostile text": _replacing(TEXTS, lambda value: isinstance(value, str)),
    "wrong type": _wrong_type,
    "nested": _nested,
    "key removed": _removed,
    "key renamed": _renamed,
    "key added": _added,
    "entry doubled": _doubled,
    "values exchanged": _exchanged,
}
"""What is done to a case's data."""


def _flipped(data: bytearray, draw: Draw) -> None:
    at = draw(st.integers(0, len(data) - 1))
    data[at] ^= 1 << draw(st.integers(0, 7))


def _overwritten(data: bytearray, draw: Draw) -> None:
    at, some = draw(st.integers(0, len(data) - 1)), draw(st.binary(min_size=1, max_size=8))
    data[at : at + len(some)] = some


def _lines_of(data: bytearray, draw: Draw) -> tuple[list[bytes], int, int]:
    lines = bytes(data).splitlines(keepends=True)
    first = draw(st.integers(0, len(lines) - 1))
    return lines, first, first + draw(st.integers(1, 4))


def _lines_cut(data: bytearray, draw: Draw) -> None:
    lines, first, last = _lines_of(data, draw)
    data[:] = b"".join(lines[:first] + lines[last:]) or b"#"


def _lines_doubled(data: bytearray, draw: Draw) -> None:
    lines, first, last = _lines_of(data, draw)
    data[:] = b"".join(lines[:last] + lines[first:])


def _lines_moved(data: bytearray, draw: Draw) -> None:
    lines, first, last = _lines_of(data, draw)
    rest = lines[:first] + lines[last:]
    to = draw(st.integers(0, len(rest)))
    data[:] = b"".join(rest[:to] + lines[first:last] + rest[to:])


def _truncated(data: bytearray, draw: Draw) -> None:
    del data[draw(st.integers(1, len(data))) :]


def _spliced(data: bytearray, draw: Draw) -> None:
    other = draw(st.sampled_from(sorted(bases().values()))).encode()
    data[draw(st.integers(1, len(data))) :] = other[draw(st.integers(0, len(other) - 1)) :]


OF_TEXT: dict[str, Callable[..., None]] = {
    "bits flipped": _flipped,
    "bytes overwritten": _overwritten,
    "lines cut": _lines_cut,
    "lines doubled": _lines_doubled,
    "lines moved": _lines_moved,
    "cut off": _truncated,
    "two files in one": _spliced,
}
"""What is done to a case's text."""

several = st.integers(1, 3)


@st.composite
def of_values(draw: Draw, kind: str) -> bytes:
    """A case with values spoilt."""
    data = tomllib.loads(draw(st.sampled_from(sorted(bases().values()))))
    for _ in range(draw(several)):
        chosen = draw(st.sampled_from(sorted(OF_VALUES))) if kind == "several kinds" else kind
        OF_VALUES[chosen](data, draw)
    return tomli_w.dumps(data).encode("utf-8", errors="surrogatepass")


@st.composite
def of_text(draw: Draw, kind: str) -> bytes:
    """A case with its text spoilt."""
    data = bytearray(draw(st.sampled_from(sorted(bases().values()))).encode())
    for _ in range(draw(several)):
        OF_TEXT[kind](data, draw)
    return bytes(data)


any_document = st.dictionaries(KEYS, JUNK, max_size=6).map(
    lambda data: tomli_w.dumps(data).encode()
)
any_text = (st.text() | st.text("[]{}=.,'\"\n #ab1-\\:T")).map(lambda text: text.encode())

CONTENTS: dict[str, st.SearchStrategy[bytes]] = {
    "any document": any_document,
    "any text": any_text,
    "any bytes": st.binary(max_size=200),
    "not spoilt": st.sampled_from(sorted(bases().values())).map(str.encode),
    **{kind: of_values(kind) for kind in [*OF_VALUES, "several kinds"]},
    **{kind: of_text(kind) for kind in OF_TEXT},
}
"""Contents of a case file by the kind of their faults."""


NAMED = {
    "mesh file": (
        ("mesh_section", "meshes/section.inp"),
        ("gmsh", "section.msh"),
        ("ansys", "section.cdb"),
    ),
    "matrix file": tuple(("brought", name) for name in ("K.mtx", "M.mtx", "nodes.csv", "rim.txt")),
    "measured file": (("measured", "curve.csv"), ("measured", "curve.uff")),
}
"""Files that cases name, with the case, by what they are."""
NUMBERS = re.compile(rb"[-+]?[0-9]+(\.[0-9]*)?([eE][-+]?[0-9]+)?")
WORDS = [
    *(
        b"",
        b"nan",
        b"inf",
        b"-1",
        b"0",
        b"1e300",
        b"1e-300",
        b"9" * 30,
        b"9" * 5000,
        b"0x10",
        b"1_0",
    ),
    *(
        b"2",
        b"17",
        b"\xb2",
        b"\xc2\xb2",
        b"\xff",
        b"*INCLUDE, INPUT=section.inp",
        b"1,1000000000,1",
    ),
    *(b"GENERATE", b"RIM", b"x" * 2000, b"\x00", b"\r", b"-", b"+-5", b"1,5", b"$", b"    -1\n"),
]


def _number_changed(data: bytearray, draw: Draw) -> None:
    """A number in a text, or what another is."""
    numbers = [found.span() for found in NUMBERS.finditer(data)]
    if numbers:
        start, stop = draw(st.sampled_from(numbers))
        data[start:stop] = draw(st.sampled_from(WORDS) | st.just(data[slice(*numbers[0])]))


@st.composite
def of_named(draw: Draw, kind: str) -> Spoilt:
    """A case that is right, and a file that it names, which is not."""
    case, file = draw(st.sampled_from(NAMED[kind]))
    data = bytearray(files()[file])
    ways = [_number_changed, _number_changed, *OF_TEXT.values()]
    for _ in range(draw(several)):
        draw(st.sampled_from(ways))(data, draw)
    command = draw(st.sampled_from(("run", "check", "check")))
    return Spoilt(kind, command, bytes(data), file, bases()[case].encode())


def spoilt(kind: str) -> st.SearchStrategy[Spoilt]:
    """Cases with faults of this kind, and commands."""
    if kind in NAMED:
        return of_named(kind)
    return st.builds(Spoilt, st.just(kind), st.sampled_from(COMMANDS), CONTENTS[kind])


ALL = (*CONTENTS, *NAMED)
"""Every kind."""
