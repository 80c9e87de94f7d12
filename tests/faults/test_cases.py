"""Spoilt case files give results, or an error with a place in the file: a few of every kind.

`python -m tests.faults.cases --count 10000` tries many, in processes that may be killed.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.faults.bases import bases
from tests.faults.cases import drawn
from tests.faults.outcome import ANSWERED, KINDS, Sandbox
from tests.faults.spoil import ALL, Spoilt

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def sandbox(tmp_path_factory):
    return Sandbox(tmp_path_factory.mktemp("sandbox"))


@pytest.mark.parametrize("name", bases())
def test_what_is_not_spoilt_is_checked_without_complaint(name, sandbox):
    outcome = sandbox.outcome(Spoilt("none", "check", bases()[name].encode()))
    assert outcome.kind == ANSWERED, outcome


@pytest.mark.parametrize("kind", ALL)
def test_a_few_of_every_kind(kind, sandbox):
    for case in drawn(kind, 3, 20):
        outcome = sandbox.outcome(case)
        assert outcome.kind in KINDS, (case, outcome)


def run_many(*options: str) -> dict:
    done = subprocess.run(
        [sys.executable, "-m", "tests.faults.cases", "--json", *options],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    found = json.loads(done.stdout)
    assert done.returncode == (1 if found["anything_else"] else 0)
    return found


@pytest.mark.long
def test_thousands_of_cases():
    found = run_many("--count", "2000", "--seed", "3")
    assert found["cases"] > 1900
    assert found["anything_else"] == 0, found["outcomes"]
