"""sphinxcontrib-typer's pages of commands, with the help as the terminal shows it.

The package takes the help from rich, and so for markup: of `pip install "tyrefrf[cluster]"` the
extra is lost, as Markdown the `<case name>`. The program's own help is plain text.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinxcontrib.typer import RenderTarget, TyperDirective
from typer.models import Context


class PlainHelp(TyperDirective):
    """`.. commands:: module.app`, with the options of `.. typer::`."""

    def run(self) -> Any:
        """The sections; the package only works where help is rich, and may think that it is."""
        self.options.setdefault("markup-mode", "rich")
        self.options.setdefault("preferred", RenderTarget.TEXT)
        return super().run()

    def generate_nodes(self, name: str, command: Any, parent: Any) -> list[nodes.section]:
        """A section of a command, and of those within it."""
        width = {"terminal_width": self.width, "max_content_width": self.width}
        context = Context(command, info_name=name, parent=parent, **width)
        self.help = command.get_help(context)
        return super().generate_nodes(name, command, parent)

    def get_text(self, **options: Any) -> str:
        """What the section shows."""
        return self.help


def setup(app: Sphinx) -> dict[str, Any]:
    """Make it known to Sphinx."""
    app.setup_extension("sphinxcontrib.typer")
    app.add_directive("commands", PlainHelp)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
