"""The line of every key, in all the ways that TOML lets one write it."""

from __future__ import annotations

import time
import tomllib

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from tyrefrf.case import with_lines
from tyrefrf.case.locate import key_lines, line_of
from tyrefrf.errors import CaseError, Problem

TEXT = '''\
# a = 0
plain = 1
dotted . "quo.ted" . 'lit eral' = """x = 1
[not]
y""""
[table.inner]  # [[comment]]
array = [1, 2,   # [ , "
  [3, {p = 4, "q" = [5,
  6]}], "a,b] # no",
  1979-05-27 07:32:00, 8,
]
inline = { a = 1, b.c = "}" }
[[many]]
x = \'\'\'
[no]
y = 3\'\'\'\'
[[many]]
[many.sub]
empty = {}
[[many.deep]]
[[many.deep]]
z = 'a=b'
'''

LINES = {
    ("plain",): 2,
    ("dotted", "quo.ted", "lit eral"): 3,
    ("table", "inner"): 6,
    ("table", "inner", "array"): 7,
    ("table", "inner", "array", 1): 7,
    ("table", "inner", "array", 2): 8,
    ("table", "inner", "array", 2, 1, "p"): 8,
    ("table", "inner", "array", 2, 1, "q", 1): 9,
    ("table", "inner", "array", 3): 9,
    ("table", "inner", "array", 4): 10,
    ("table", "inner", "array", 5): 10,
    ("table", "inner", "inline", "b", "c"): 12,
    ("many",): 13,
    ("many", 0, "x"): 14,
    ("many", 1): 17,
    ("many", 1, "sub", "empty"): 19,
    ("many", 1, "deep", 0): 20,
    ("many", 1, "deep", 1, "z"): 22,
    # keys that are not there: the innermost table around them
    ("missing",): 1,
    ("plain", "missing"): 2,
    ("table", "inner", "missing", 3): 6,
    ("many", 1, "sub", "missing"): 18,
    ("many", 0, "y"): 13,
    ("many", 7): 13,
}


@pytest.mark.parametrize(("key", "line"), LINES.items(), ids=str)
@pytest.mark.parametrize("newline", ["\n", "\r\n"], ids=["lf", "crlf"])
def test_line_of_key(key, line, newline):
    assert line_of(key_lines(TEXT.replace("\n", newline)), key) == line


def keys_of(data, key=()):
    yield key
    if isinstance(data, dict | list):
        items = data.items() if isinstance(data, dict) else enumerate(data)
        for part, value in items:
            yield from keys_of(value, (*key, part))


def test_exactly_the_keys_that_tomllib_reads_have_lines():
    assert set(key_lines(TEXT)) == set(keys_of(tomllib.loads(TEXT)))


toml = st.recursive(
    st.integers()
    | st.booleans()
    | st.text(st.characters(codec="utf-8", categories=["L", "P", "S"])),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(st.dictionaries(st.text(st.characters(codec="utf-8")), toml, max_size=4))
def test_any_document_has_a_line_for_each_of_its_keys(data):
    text = tomli_w.dumps(data, multiline_strings=True)
    read = tomllib.loads(text)
    lines = key_lines(text)
    assert set(lines) == set(keys_of(read))
    assert all(1 <= line <= text.count("\n") + 1 for line in lines.values())


def test_time_is_linear_in_the_text():
    def seconds(n):
        text = "a = [\n" + "[1, 2],\n" * n + "]\n" + "[[b]]\nc = 1\n" * n
        start = time.process_time()
        key_lines(text)
        return time.process_time() - start

    seconds(1000)
    assert seconds(16_000) < 40 * seconds(1000)  # 16 if linear, 256 if quadratic


def test_later_stages_get_the_lines_of_their_problems():
    error = CaseError([Problem(("b", "thick"), "folds"), Problem(("a",), "is odd", 2)])
    found = with_lines(error, "a = 1\n\n[b]\nc = 2\n", "t.toml")
    assert str(found) == "t.toml:2: a: is odd\nt.toml:3: b.thick: folds"
