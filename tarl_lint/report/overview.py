"""What reaches what, in a line or two for each published topic: what a long report comes down to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Flow
from tarl_lint.report.line import Line, Style, View, columns

MANY: Final = 6  # publish calls; fewer are on the screen at once anyway
_WIDE: Final = 110  # columns where no terminal sets a limit
_WIDEST_NAME: Final = 30
_ALTERNATIVES: Final = 4  # topics of one call that are all named


def overview(flows: Sequence[Flow], view: View) -> Iterator[Line]:
    """Yield published topics with the topics whose data they carry, and those that only decide."""
    if len({flow.sink.span for flow in flows}) < MANY:
        return
    yield (("Published, and what reaches it:", "strong"),)
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
    if columns(name) > margin:  # a line of its own, or all the others would begin far to the right
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
    """Write the topics that one call may have, some of them where a table gives it many."""
    if len(topics) <= _ALTERNATIVES:
        return topic_text(topics)
    return f"{topic_text(topics[: _ALTERNATIVES - 1])} or {len(topics) - _ALTERNATIVES + 1} others"


def _wrapped(names: Iterable[str], room: int) -> Iterator[str]:
    """Join names with commas, on as many lines as they need."""
    line = ""
    for name in names:
        if line and columns(f"{line}, {name}") >= room:
            yield line + ","
            line = name
        else:
            line = f"{line}, {name}" if line else name
    if line:
        yield line
