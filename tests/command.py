"""The program as a shell starts it."""

from __future__ import annotations

import subprocess
import sys


def tyrefrf_command(*arguments, cwd, **more):
    """Run a command in a process of its own; its status, stdout and stderr."""
    return subprocess.run(
        [sys.executable, "-m", "tyrefrf", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        timeout=120,
        check=False,
        **more,
    )
