"""Map at the top of a long report: for each published topic, the topics that reach it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Flow
from tarl_lint.report.line import Line, Style, View, columns

MANY: Final = 6  # reports with fewer publish calls fit on a screen
_WIDE: Final = 110  # width in columns if there is no terminal
_WIDEST_NAME: Final = 30
# maximum number of topics of a call that are shown in full
_ALTERNATIVES: Final = 4


def overview(flows: Sequence[Flow], view: View) -> Iterator[Line]:
    """Yield the published topics, each with the topics whose data it carries and the topics used only in conditions."""
    if len({flow.sink.span for flow in flows}) < MANY:
        return
    yield (("Published topics, and the topics that reach them:", "strong"),)
    by_name: dict[str, list[Flow]] = {}
    for flow in flows:
        by_name.setdefault(_few(flow.sink.topics), []).append(flow)
    margin = min(max(map(columns, by_name)), _WIDEST_NAME)
    for name in sorted(by_name):
        yield from _topic(name, by_name[name], margin, view)
    yield ()


def _topic(name: str, flows: Sequence[Flow], margin: int, view: View) -> Iterator[Line]:
    carried = {_few(flow.source.topics) for flow in flows if flow.kind == "explicit"}
    deciding = {_few(flow.source.topics) for flow in flows} - carried
    head = name + " " * (margin - columns(name))
    if columns(name) > margin:  # a long name gets its own line, so that shorter names stay aligned
        yield (("  ", ""), (name, "strong"))
        head = " " * margin
    parts: list[tuple[str, Style, set[str]]] = [
        (f"{view.glyphs.data} data of    ", "data", carried),
        (f"{view.glyphs.control} decided by ", "control", deciding),
    ]
    for words, style, topics in parts:
        for line in _wrapped(sorted(topics), (view.width or _WIDE) - margin - 4 - columns(words)):
            yield (("  ", ""), (head, "strong"), ("  ", ""), (words, style), (line, ""))
            head, words = " " * len(head), " " * len(words)


def _few(topics: Sequence[str]) -> str:
    """Return the possible topics of one call; a long list is abbreviated."""
    if len(topics) <= _ALTERNATIVES:
        return topic_text(topics)
    return f"{topic_text(topics[: _ALTERNATIVES - 1])} or {len(topics) - _ALTERNATIVES + 1} others"


def _wrapped(names: Iterable[str], room: int) -> Iterator[str]:
    """Yield lines of names joined with commas."""
    line = ""
    for name in names:
        if line and columns(f"{line}, {name}") >= room:
            yield line + ","
            line = name
        else:
            line = f"{line}, {name}" if line else name
    if line:
        yield line
