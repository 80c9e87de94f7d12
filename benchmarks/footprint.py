"""Wall time, peak memory and file size of `tyrefrf run cases/homogeneous.toml`.

    python -m benchmarks.footprint

From the shell prompt to the last plot. The paper's method needed 2 MB of data, whatever N.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.machine import description, table

CASE = Path(__file__).parents[1] / "cases" / "homogeneous.toml"


def measured() -> str:
    """The table, in Markdown."""
    rows = []
    for jobs in (1, 2):
        with tempfile.TemporaryDirectory() as directory:
            command = [sys.executable, "-m", "tyrefrf", "run", str(CASE)]
            command += ["--json", "--jobs", str(jobs), "--output", directory]
            start = time.perf_counter()
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
            assert process.stdout is not None
            facts = json.loads(process.stdout.read())
            _, status, usage = os.wait4(process.pid, 0)
            seconds = time.perf_counter() - start
            assert status == 0
            size = Path(facts["files"][0]).stat().st_size
        rows.append(
            [
                str(jobs),
                f"{seconds:.1f}",
                f"{usage.ru_maxrss / 1e3:.0f}",
                f"{size / 1e6:.2f}",
                f"{facts['largest_residual']:.1e}",
            ]
        )
    header = ["jobs", "wall [s]", "peak of the main process [MB]", "results [MB]", "residual"]
    return f"{facts['lines']} lines, 2 loads, {len(facts['probes'])} probes.\n\n" + table(
        header, rows
    )


if __name__ == "__main__":
    print(description())
    print(measured())
