"""Wall time, peak memory and file size of `tyrefrf run cases/homogeneous.toml`.

    python -m benchmarks.footprint

From the shell prompt to the last plot. The paper's method needed 2 MB of data, whatever N. Memory
is read from Linux's /proc: the high-water marks of the main process and of its workers.
"""

from __future__ import annotations

import json
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
            peaks = _watch(process)
            seconds = time.perf_counter() - start
            assert process.returncode == 0
            assert process.stdout is not None
            facts = json.loads(process.stdout.read())
            size = Path(facts["files"][0]).stat().st_size
        rows.append(
            [
                str(jobs),
                f"{seconds:.1f}",
                f"{peaks.pop(process.pid):.0f}",
                " + ".join(f"{peak:.0f}" for peak in sorted(peaks.values())[-jobs:])
                if peaks
                else "-",
                f"{size / 1e6:.2f}",
                f"{facts['largest_residual']:.1e}",
            ]
        )
    header = ["jobs", "wall [s]", "main process [MB]", "workers [MB]", "results [MB]", "residual"]
    return f"{facts['lines']} lines, 2 loads, {len(facts['probes'])} probes.\n\n" + table(
        header, rows
    )


def _watch(process: subprocess.Popen[bytes]) -> dict[int, float]:
    """High-water marks [MB] of a process and its descendants, by pid, watched to its end."""
    peaks: dict[int, float] = {}
    while process.poll() is None:
        family = {process.pid}
        for status in sorted(Path("/proc").glob("[0-9]*/status"), key=lambda s: int(s.parent.name)):
            try:
                facts = dict(line.split(":", 1) for line in status.read_text().splitlines())
            except OSError:  # it has ended since
                continue
            pid = int(status.parent.name)
            if pid in family or int(facts["PPid"]) in family:
                family.add(pid)
                mark = float(facts.get("VmHWM", "0 kB").split()[0]) / 1e3  # none once it has ended
                peaks[pid] = max(peaks.get(pid, 0.0), mark)
        time.sleep(0.05)
    return peaks


if __name__ == "__main__":
    print(description())
    print(measured())
