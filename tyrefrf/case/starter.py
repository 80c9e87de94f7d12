"""The commented case that `tyrefrf init` writes."""

from __future__ import annotations

from importlib import resources


def starter_text() -> str:
    """Return the text of the starter case: the paper's homogeneous tyre."""
    return resources.files("tyrefrf.case").joinpath("starter.toml").read_text("utf-8")
