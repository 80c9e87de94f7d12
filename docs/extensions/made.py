"""Directives in a page of Markdown that stand for Markdown which the program's own tables make.

    ```{case-keys}
    ```

Every table that a case may have, with its keys: what they take, defaults and meanings.

    ```{case-units}
    ```

The units that a quantity may carry as text.

    ```{sweep-parameters}
    ```

What a sweep of the built-in tyre may change, by its names.

    ```{datasets} run
    ```

Every dataset of a results file of that content, group by group.

    ```{root-attributes}
    ```

The attributes of the root of a results file.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from case_tables import case_keys, case_units, sweep_parameters
from docutils import nodes
from docutils.statemachine import StringList
from layout_tables import datasets, root_attributes
from markup import Lines
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

TABLES: dict[str, Callable[..., Lines]] = {
    "case-keys": case_keys,
    "case-units": case_units,
    "sweep-parameters": sweep_parameters,
    "datasets": datasets,
    "root-attributes": root_attributes,
}
"""What makes the Markdown, by the directives' names; their arguments are the directive's."""


class Made(SphinxDirective):
    """A directive that stands for lines of Markdown."""

    optional_arguments: ClassVar = 1

    def run(self) -> list[nodes.Node]:
        """The nodes of these lines."""
        lines = StringList(TABLES[self.name](*self.arguments), self.get_source_info()[0])
        container = nodes.Element()
        self.state.nested_parse(lines, 0, container, match_titles=True)
        return container.children


def setup(app: Sphinx) -> dict[str, Any]:
    """Make them known to Sphinx."""
    for name in TABLES:
        app.add_directive(name, Made)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
