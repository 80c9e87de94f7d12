"""What the reference makes of docstrings: sections of what is listed, prose of the rest."""

from __future__ import annotations

from docstrings import in_sections

RESULTS = """\
Responses of p probes; its arrays are `read-only`.

frequency: (f,) [Hz]. loads, probes: places.
remark: f texts, empty or what was special about the line,
    or why it failed.
Raises ResultsError where the shapes do not agree.

A *star* and |Y| are no markup."""


def rewritten(what: str, docstring: str) -> str:
    lines = docstring.splitlines()
    in_sections(None, what, "", None, None, lines)
    return "\n".join(lines)


def test_names_and_errors_become_sections_and_prose_stays():
    assert rewritten("class", RESULTS) == (
        "Responses of p probes; its arrays are ``read-only``.\n\n"
        "A \\*star\\* and \\|Y\\| are no markup.\n\n"
        "Parameters\n----------\n"
        "frequency\n    (f,) [Hz].\n"
        "loads, probes\n    places.\n"
        "remark\n    f texts, empty or what was special about the line, or why it failed.\n\n"
        "Raises\n------\n"
        "ResultsError\n    where the shapes do not agree.\n"
    )


def test_several_errors_keep_the_sentence_that_tells_them_apart():
    sentence = "Raises CaseError as `run`, SolveError without an answer."
    text = rewritten("function", f"Compute it.\n\njobs: processes.\n{sentence}")
    assert "CaseError, SolveError\n    CaseError as ``run``, SolveError without" in text


def test_sources_are_prose():
    text = rewritten("function", "Compute it.\n\nSource: a book.\nh: the order.")
    assert text.startswith("Compute it.\n\nSource: a book.\n\nParameters")


def test_a_module_keeps_its_lists_and_its_drawings():
    text = rewritten("module", "Files.\n\n- one *thing*\n- another\n\n    A\n    └── B")
    assert text == "Files.\n\n- one \\*thing\\*\n- another\n\n::\n\n    A\n    └── B\n"
