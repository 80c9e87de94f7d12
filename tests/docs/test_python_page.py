"""The three examples of the page on Python give what they promise."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray
from pages import DOCS, Follower, blocks

import tyrefrf

PAGE = DOCS / "howto" / "python.md"
EXAMPLES = 3


@pytest.fixture
def example(tmp_path, monkeypatch):
    """Runs one of the examples, from 1, beside the case files of the page; its names."""
    monkeypatch.chdir(tmp_path)
    follower = Follower(tmp_path)
    python = [block for block in blocks(PAGE) if block.language == "python"]
    assert len(python) == EXAMPLES
    for block in blocks(PAGE):
        if block.file:
            follower.follow(block, PAGE.name)

    def run(number: int) -> dict[str, Any]:
        follower.follow(python[number - 1], f"{PAGE.name}: example {number}")
        return follower.names

    return run


def test_a_run(example, capsys):
    names = example(1)
    kept = tyrefrf.load_results("tyre.h5")
    assert np.array_equal(kept.driving_point("radial"), names["Y"])
    assert np.array_equal(kept.response("radial", "sidewall", "receptance"), names["H"])
    assert f"|Y| is largest at {names['peak']:.0f} Hz" in capsys.readouterr().out
    assert kept.residual.max() < 1e-10


def test_a_sweep_as_a_dataset(example):
    names = example(2)
    assert isinstance(names["data"], xarray.Dataset)
    assert names["Y"].dims == ("E_rubber", "eta_rubber", "frequency")
    peaks = names["peaks"].sel(eta_rubber=0.1)
    ratio = float(peaks[1] / peaks[0])  # stiffness doubled: frequencies go with its square root
    step = 5.0 / float(peaks[0])
    assert ratio == pytest.approx(np.sqrt(2.0), abs=1.5 * step)


def test_a_cell_from_meshio_to_mobility(example):
    names = example(3)
    results = names["results"]
    assert results.loads[0].r == pytest.approx(0.3)  # mid-tread, outside
    assert results.loads[0].y == pytest.approx(0.0, abs=1e-12)
    assert np.all(names["Y"][1:].real > 0.0)
    assert results.residual.max() < 1e-10
