"""The cases that come with the program."""

from __future__ import annotations

from importlib import resources


def starter_text() -> str:
    """Return the commented case that `tyrefrf init` writes: the paper's homogeneous tyre."""
    return _text("starter.toml")


def builtin_text() -> str:
    """Return the built-in tyre, taken where no case is named: the paper's layered one."""
    return _text("builtin.toml")


def _text(name: str) -> str:
    return resources.files("tyrefrf.case").joinpath(name).read_text("utf-8")
