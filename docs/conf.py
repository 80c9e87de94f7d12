"""How Sphinx makes the site: `sphinx-build -W --keep-going docs build/docs`."""

from __future__ import annotations

import sys
from importlib.metadata import version as version_of
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "extensions"))

project = "tyrefrf"
version = release = version_of("tyrefrf")
html_title = f"tyrefrf {version}"
project_copyright = "the authors of tyrefrf"
language = "en"
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_copyright = False
html_copy_source = False
html_show_sourcelink = False
highlight_language = "text"  # where a block does not name its own
smartquotes = False  # names in quotation marks are to be typed
exclude_patterns = ["README.md", "figures"]  # `figures` is where the gallery's scripts are

extensions = [
    "myst_parser",  # pages in Markdown
    "sphinx.ext.autodoc",
    "docstrings",  # before numpydoc: its sections from our docstrings
    "numpydoc",
    "sphinx_gallery.gen_gallery",
    "command_line",
    "made",  # tables of the reference, from the program
    "mathml",
]

# Pages: formulas between dollars, definition lists, links to headings.
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3
default_role = "code"  # `name` in a docstring is code

# Formulas: MathML by docutils, with the paper's numbers in brackets as the code cites them.
html_math_renderer = "mathml"
math_eqref_format = "[{number}]"

# From Python: public names as they are imported.
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_typehints = "none"  # the docstrings say what is taken, shapes and units included
add_module_names = False
numpydoc_show_class_members = False
toc_object_entries = False

# The gallery: every script is run, and one that fails fails the build. Where docs/gallery/ is left
# from the last time, only scripts that have changed are run again.
sphinx_gallery_conf = {
    "examples_dirs": "figures",
    "gallery_dirs": "gallery",
    "ignore_pattern": r"measures\.py$",  # what the scripts share
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("pictures.scraped",),
    "capture_repr": ("_repr_html_",),
    "reset_modules": (),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "write_computation_times": False,
    "show_signature": False,
    "remove_config_comments": True,
}
