"""Output formats. A format is one file with a function `report(result, view)`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Final, cast

from tarl_lint.report.line import Line, View, unbroken
from tarl_lint.run.runner import Result

FORMATS: Final[Mapping[str, str]] = {
    "text": "tarl_lint.report.text:report",
    "concise": "tarl_lint.report.text:concise",
    "json": "tarl_lint.report.json:report",
    "json2": "tarl_lint.report.json2:report",
    "sarif": "tarl_lint.report.sarif:report",
    "github": "tarl_lint.report.github:report",
    "gitlab": "tarl_lint.report.gitlab:report",
    "junit": "tarl_lint.report.junit:report",
    "dot": "tarl_lint.report.dot:report",
    "mermaid": "tarl_lint.report.mermaid:report",
}
FOR_PEOPLE: Final = frozenset({"text", "concise", "github"})
# a line feed in a topic must not break a line in these formats
LINE_BY_LINE: Final = FOR_PEOPLE | {"dot", "mermaid"}


def render(name: str, result: Result, view: View) -> Iterator[Line]:
    """Return the lines of a report in one of the `FORMATS`; only that format's file is imported."""
    module, _, function = FORMATS[name].partition(":")
    lines = cast("Iterator[Line]", getattr(import_module(module), function)(result, view))
    return map(unbroken, lines) if name in LINE_BY_LINE else lines
