"""Runs in processes of their own that are ended by signals."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress

from tyrefrf.errors import ResultsError
from tyrefrf.results.left import read_journal

PATIENCE = 90.0  # seconds


def heeding():
    """Before a process begins: it heeds signals, even where the tests were told to ignore them."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


@contextmanager
def started(*arguments, cwd, preexec_fn=heeding, **more):
    """A command under way; killed at the end if it still is."""
    with subprocess.Popen(
        [sys.executable, "-m", "tyrefrf", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=cwd,
        preexec_fn=preexec_fn,
        **more,
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def wait_for_lines(journal, n_lines, process):
    """Return when so many lines are in the journal."""
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        assert process.poll() is None, process.stderr.read()
        with suppress(ResultsError):
            if journal.exists() and len(read_journal(journal).lines) >= n_lines:
                return
        time.sleep(0.05)
    raise AssertionError(f"not {n_lines} lines within {PATIENCE:g} s")


def ended(process, number):
    """What a process says, and its status, that is sent a signal."""
    process.send_signal(number)
    out, err = process.communicate(timeout=PATIENCE)
    return process.returncode, out, err


def workers_of(pid):
    """Process numbers of the processes that work for this one (Linux)."""
    done = subprocess.run(
        ["ps", "-ww", "-o", "pid=,args=", "--ppid", str(pid)],
        capture_output=True,
        text=True,
        check=False,
    )
    return [int(line.split()[0]) for line in done.stdout.splitlines() if "LokyProcess" in line]
