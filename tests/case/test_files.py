"""Whatever a path leads to, the answer is a case or a message."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tyrefrf.case import load_case
from tyrefrf.case.load import MAX_BYTES
from tyrefrf.errors import CaseError


def message(path: Path) -> str:
    with pytest.raises(CaseError) as caught:
        load_case(path)
    return str(caught.value).removeprefix(str(path))


def test_the_name_of_a_case_is_its_files(tmp_path, small):
    path = tmp_path / "my-tyre.v2.toml"
    path.write_text(small)
    assert load_case(path).name == "my-tyre.v2"
    assert load_case(str(path)) == load_case(path)


def test_a_name_in_the_file_comes_first(tmp_path, small):
    path = tmp_path / "a.toml"
    path.write_text("name = 'b'\n" + small)
    assert load_case(path).name == "b"


def test_a_byte_order_mark_and_windows_newlines_are_read(tmp_path, small):
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbf" + small.replace("\n", "\r\n").encode())
    assert load_case(path).cell.n_cells == 45


def test_missing_file(tmp_path):
    assert message(tmp_path / "none.toml") == ": cannot be read: No such file or directory"


def test_directory(tmp_path):
    assert message(tmp_path) == ": cannot be read: Is a directory"


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads everything")
def test_file_without_permission(tmp_path):
    path = tmp_path / "a.toml"
    path.touch(mode=0)
    assert message(path) == ": cannot be read: Permission denied"


def test_a_path_that_no_file_can_have():
    assert message(Path("a\0b")) == ": cannot be read: embedded null byte"


def test_bytes_that_are_not_text(tmp_path):
    path = tmp_path / "a.toml"
    path.write_bytes(b"a = 1\nb = '\xff'\n")
    assert message(path) == ":2: is not UTF-8 text: byte 0xff"


def test_a_file_of_more_than_ten_megabytes(tmp_path):
    path = tmp_path / "a.toml"
    path.write_bytes(b"#" * (MAX_BYTES + 1))
    assert message(path) == ": is larger than 10 MB; not a case file"
