"""The program as a shell starts it."""

from __future__ import annotations

import contextlib
import io
import subprocess
import sys
import traceback
import warnings
from dataclasses import dataclass


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


@dataclass(frozen=True, slots=True)
class Done:
    """What a command left: its status, or the traceback in its place; stdout and stderr."""

    status: int | str
    stdout: str
    stderr: str


def command_here(*arguments, cwd) -> Done:
    """Run a command in this process, where warnings are errors, and nothing is caught by it."""
    from tyrefrf.cli.main import main

    out, err, before = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["tyrefrf", *map(str, arguments)]
    status: int | str = 0
    try:
        with (
            contextlib.chdir(cwd),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            warnings.catch_warnings(action="error"),
        ):
            main()
    except SystemExit as end:
        status = end.code or 0
    except BaseException:
        status = traceback.format_exc()
    finally:
        sys.argv = before
    return Done(status, out.getvalue(), err.getvalue())
