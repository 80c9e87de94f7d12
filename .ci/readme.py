"""Print the README's N-th command: the N-th fenced block of shell, counted from 1."""

import re
import sys
from pathlib import Path

text = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
blocks = re.findall(r"^```sh\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)
if len(blocks) != 2:
    sys.exit(f"README.md has {len(blocks)} blocks of shell; it should have the two commands")
print(blocks[int(sys.argv[1]) - 1])
