"""Helpers that analyse texts as files."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

from tarl_lint.api import Analysis, analyse
from tarl_lint.model import Flow, SiteId


def analysed(directory: Path, **files: str) -> Analysis:
    """Write files (`name="text"` is name.py) into a directory and analyse it."""
    for name, text in files.items():
        (directory / f"{name}.py").write_text(dedent(text), encoding="utf-8")
    return analyse([directory])


def steps(flow: Flow, dependence: str) -> list[str]:
    """Return the first lines of the steps of one dependence, in order."""
    return [s.code.split("\n")[0] for s in flow.steps if s.dependence == dependence]


def site(analysis: Analysis, text: str) -> SiteId:
    """Return the site with this text."""
    return next(s.site for s in analysis.sites if s.site.text == text)
