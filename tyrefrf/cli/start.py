"""The program's first step, and its last: a Ctrl-C there ends it, and is no traceback."""

from __future__ import annotations

import signal


def command() -> None:
    """The program `tyrefrf`."""
    heard = signal.getsignal(signal.SIGINT)
    if heard is signal.default_int_handler:  # else it was told to ignore it, as by nohup
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from tyrefrf.cli.main import main

    main()
