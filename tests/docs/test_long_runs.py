"""What the page on long runs does after a kill."""

from __future__ import annotations

import re
import signal

from command import tyrefrf_command
from killed import ended, started, wait_for_lines
from pages import DOCS, blocks, commands, first_case

PAGE = DOCS / "howto" / "long_runs.md"


def test_after_a_kill_the_page_s_commands_show_and_go_on_with_what_is_there(tmp_path):
    (tmp_path / "tyre.toml").write_text(first_case().text.replace("step = 5.0", "step = 0.25"))
    (block,) = (b for b in blocks(PAGE) if "test_long_runs" in b.remark)
    info, plot, resume = (command.split()[1:] for command in commands(block.text))
    with started(*resume, cwd=tmp_path) as process:
        wait_for_lines(tmp_path / "results/tyre/tyre.journal", 10, process)
        ended(process, signal.SIGKILL)
    told = tyrefrf_command(*info, cwd=tmp_path)
    missing = int(re.search(r"MISSING +(\d+) lines", told.stdout)[1])
    assert 0 < missing <= 2001 - 10
    assert tyrefrf_command(*plot, cwd=tmp_path).returncode == 0
    done = tyrefrf_command(*resume, cwd=tmp_path)
    assert done.returncode == 0
    assert f"resumed   {2001 - missing} lines were there" in done.stdout
