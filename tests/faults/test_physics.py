"""Every fault of physics is found and named, or answered rightly."""

from __future__ import annotations

import pytest
from faults.physics import FAULTS, main


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
def test_said_rightly(fault):
    row = fault()
    assert row.right, f"{row.fault}: {row.said}"


def test_the_list_is_printed_and_its_status_says_whether_all_are_right(monkeypatch, capsys):
    monkeypatch.setattr("faults.physics.FAULTS", FAULTS[:2])
    assert main([]) == 0
    said = capsys.readouterr().out
    assert said.startswith("right  pressure beyond what the tyre bears")
    assert said.endswith("2 of 2 right\n")
