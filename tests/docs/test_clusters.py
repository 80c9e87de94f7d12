"""The commands and the Python of the page on clusters, all on this machine."""

from __future__ import annotations

import socket
import subprocess
import sys
from contextlib import ExitStack

import numpy as np
import pytest
from command import tyrefrf_command
from pages import DOCS, Block, blocks, commands, first_case

import tyrefrf

PAGE = DOCS / "howto" / "clusters.md"
MINE = "executed by tests/docs/test_clusters.py: on one machine"

pytest.importorskip("distributed", reason="NO CLUSTER IS TESTED: pip install '.[test]'")


@pytest.fixture(scope="module")
def here() -> str:
    """An address of this machine that is free."""
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        return f"127.0.0.1:{listening.getsockname()[1]}"


@pytest.fixture(scope="module")
def cluster(here, tmp_path_factory):
    """What the page's first two commands start, one worker of them; a directory with a case."""
    directory = tmp_path_factory.mktemp("cluster")
    (directory / "tyre.toml").write_text(first_case().text)
    scheduler, worker, _ = commands(mine("sh").text)
    assert scheduler == "dask scheduler"
    started = [
        [*scheduler.split(), "--host", f"tcp://{here}", "--no-dashboard"],
        worker.replace("host:8786", here).replace("--nworkers 8", "--nworkers 1").split(),
    ]
    with ExitStack() as stack:
        for command in started:
            process = subprocess.Popen(
                [sys.executable, "-m", *command],
                cwd=directory,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            stack.callback(process.wait)
            stack.callback(process.terminate)
        yield directory


def mine(language: str) -> Block:
    """The block of a language that the page leaves to these tests."""
    (block,) = (b for b in blocks(PAGE) if b.language == language and b.remark == MINE)
    return block


def test_the_run_of_the_page_and_its_python_have_the_same_bits(cluster, here, monkeypatch):
    *_, run = commands(mine("sh").text)
    done = tyrefrf_command(*run.replace("host:8786", here).split()[1:], cwd=cluster)
    assert done.returncode == 0, done.stderr
    monkeypatch.chdir(cluster)
    names: dict[str, tyrefrf.Results] = {}
    exec(compile(mine("python").text.replace("host:8786", here), str(PAGE), "exec"), names)
    kept = tyrefrf.load_results("results/tyre/tyre.h5")
    np.testing.assert_array_equal(kept.receptance, names["results"].receptance)
