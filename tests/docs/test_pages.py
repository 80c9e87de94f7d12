"""Every command, case and example of the documentation does what its page says."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from pages import DOCS, LANGUAGES, NOT_HERE, README, Block, Follower, blocks, first_case, pages

ROOT = DOCS.parent
PAGES = [page for page in (README, *pages()) if blocks(page)]
BLOCKS = [(page, block) for page in PAGES for block in blocks(page)]
REMARKS = re.compile(rf"|exits [12]|refused|{NOT_HERE.pattern}")


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


@pytest.fixture
def quickly(monkeypatch):
    """One process, and pictures that are small: what is drawn is looked at in tests/plots."""
    monkeypatch.setattr("tyrefrf.study.local.cores", lambda: 1)
    monkeypatch.setattr("tyrefrf.plots.style.RC", {"savefig.dpi": 20})


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_a_page_can_be_followed_from_its_first_line_to_its_last(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "cases", tmp_path / "cases")
    (tmp_path / "tyre.toml").write_text(first_case().text)
    follower = Follower(tmp_path)
    for block in blocks(page):
        if page != README or block.language != "sh":  # those of the README are run by .ci/run
            follower.follow(block, f"{name_of(page)}:{block.line}")


def test_the_links_of_the_readme_lead_somewhere():
    text = README.read_text(encoding="utf-8")
    links = re.findall(r"\]\((?!https?:)([^)#]+)\)", text)
    assert len(links) > 20
    assert [link for link in links if not (ROOT / link).is_file()] == []


@pytest.mark.parametrize("page", [README, *pages()], ids=name_of)
def test_no_block_escapes_those_who_execute_them(page):
    fences = re.findall(r"^[ \t]*(?:```|~~~)", page.read_text(encoding="utf-8"), re.MULTILINE)
    directives = re.findall(r"^```\{", page.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(fences) == 2 * (len(blocks(page)) + len(directives))
    assert {block.language for block in blocks(page)} <= {*LANGUAGES}


def test_what_is_said_of_a_block_is_understood():
    for page, block in BLOCKS:
        assert REMARKS.fullmatch(block.remark), f"{name_of(page)}:{block.line}: {block.remark}"
        test = NOT_HERE.fullmatch(block.remark)
        assert not (test and test["test"]) or (ROOT / test["test"]).is_file()


def test_few_blocks_are_executed_by_nobody():
    idle = [(name_of(page), b.remark) for page, b in BLOCKS if b.remark.startswith("not executed")]
    assert idle == [
        ("docs/howto/clusters.md", "not executed: needs SLURM"),
        ("docs/howto/long_runs.md", "not executed: needs SLURM"),
        (
            "docs/howto/matrices.md",
            "not executed: needs CalculiX's files; tests/reference/test_calculix_matrices.py "
            "reads such",
        ),
    ]


@pytest.mark.parametrize("command", ["tyrefrf check wrong.toml", "tyrefrf frobnicate", "rm -r x"])
def test_a_command_that_fails_or_that_nobody_knows_fails_its_page(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    block = Block("sh", f"{command}\n", "", 1, is_printed=False)
    with pytest.raises(AssertionError, match="page:1"):
        Follower(tmp_path).follow(block, "page:1")


@pytest.mark.parametrize("shown", ["tyrefrf 9.9", "mass 6.96 kg"])
def test_output_that_is_not_what_is_printed_fails_its_page(shown, tmp_path):
    follower = Follower(tmp_path, said="mass      7.96 kg\ntyrefrf\n")
    with pytest.raises(AssertionError, match="is not printed"):
        follower.follow(Block("text", f"{shown}\n", "", 1, is_printed=True), "page:1")
    follower.follow(Block("text", "  mass  7.95 kg\n...\n", "", 1, is_printed=True), "page:1")


def test_a_command_among_what_is_only_shown_fails_its_page(tmp_path):
    with pytest.raises(AssertionError, match="a command that nobody runs"):
        Follower(tmp_path).follow(
            Block("text", "$ tyrefrf run\n", "", 1, is_printed=False), "page:1"
        )
