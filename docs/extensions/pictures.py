"""The pictures of the gallery: what a script has drawn with the program's own plots.

sphinx-gallery looks for figures of pyplot, which the program does not use. A script of the gallery
names the files of its pictures in `shown`; each is shown once, behind the block that names it.
"""

from __future__ import annotations

import shutil
from typing import Any

from sphinx_gallery.scrapers import figure_rst


def scraped(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """The pictures that a block of a script has named, copied to where the site takes them."""
    shown = block_vars["example_globals"].pop("shown", [])
    copies = [next(block_vars["image_path_iterator"]) for _ in shown]
    for picture, copy in zip(shown, copies, strict=True):
        shutil.copy(picture, copy)
    return "\n".join(figure_rst([copy], gallery_conf["src_dir"]) for copy in copies)
