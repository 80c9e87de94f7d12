"""Formulas as MathML, which browsers draw themselves, numbered as the paper numbers its equations.

No script, no font and no network is needed to read the pages: docutils, on which Sphinx stands,
turns LaTeX into MathML. An equation's label is its number in the paper: `(18)` behind a formula
makes it [18], here and wherever the text refers to it; formulas without a label are not the
paper's. What docutils does not know of LaTeX is a warning, which fails the build.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.domains.math import MathDomain
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

log = logging.getLogger(__name__)


class PaperNumbers(MathDomain):
    """Equations by the numbers that they have in the paper, in place of their order here."""

    def note_equation(self, docname: str, labelid: str, location: Any = None) -> None:
        """Remember where the equation with this number stands."""
        if not labelid.isdecimal():
            log.warning("'%s' is no number of an equation of the paper", labelid, location=location)
            return
        if labelid in self.equations:
            log.warning("equation [%s] stands twice", labelid, location=location)
        self.equations[labelid] = docname, int(labelid)


def inline(self: HTML5Translator, node: nodes.math) -> None:
    """A formula in the text."""
    self.body.append(_drawn(node, as_block=False))
    raise nodes.SkipNode


def displayed(self: HTML5Translator, node: nodes.math_block) -> None:
    """A formula on lines of its own, with its number, if it is the paper's, on the right."""
    self.body.append(self.starttag(node, "div", CLASS="math"))
    if node["number"]:
        link = self.starttag(node, "a", "", CLASS="headerlink", href=f"#{node['ids'][0]}")
        self.body.append(f'<span class="eqno">[{node["number"]}]{link}¶</a></span>')
    self.body.append(_drawn(node, as_block=True))
    self.body.append("</div>")
    raise nodes.SkipNode


def _drawn(node: nodes.math | nodes.math_block, *, as_block: bool) -> str:
    try:
        return tex2mathml(node.astext(), as_block=as_block)
    except MathError as error:
        log.warning("formula %r: %s", node.astext(), error, location=node)
        return node.astext()


def setup(app: Sphinx) -> dict[str, Any]:
    """Make it known to Sphinx."""
    app.add_domain(PaperNumbers, override=True)
    app.add_html_math_renderer("mathml", (inline, None), (displayed, None))
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
