"""Combinations of kinds of state, callbacks, messages, publishers and main programs."""

from collections.abc import Iterator

import pytest

from tarl_lint import engine
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config
from tests.lint.combining import AXES, node
from tests.slow import chance

Parts = tuple[str, ...]
USUAL = ("attribute", "method", "scalar", "attribute", "timer")
MIXED = 60  # number of random combinations


def chosen() -> Iterator[Parts]:
    for place, axis in enumerate(AXES):
        for part in axis:
            yield (*USUAL[:place], part, *USUAL[place + 1 :])
    draw = chance(7)
    for _ in range(MIXED):
        yield tuple(draw.choice(sorted(axis)) for axis in AXES)


def lines_with(text: str, word: str) -> set[int]:
    return {number for number, line in enumerate(text.splitlines(), 1) if word in line}


@pytest.mark.parametrize("parts", dict.fromkeys(chosen()), ids="-".join)
def test_only_the_tainted_value_reaches_its_publish_call(parts):
    text = node(*parts)
    module = parse("node.py", text.encode(), "node")
    assert isinstance(module, Module)
    flows = engine.analyse([module], Config())
    assert [(f.kind, {f.sink.span.line}) for f in flows] == [("explicit", lines_with(text, "# sink"))]
    data = [s.span.line for s in flows[0].steps if s.dependence == "data"]
    stored, read = lines_with(text, "msg.data"), lines_with(text, "value = ") | lines_with(text, "value, ")
    assert (stored | read) - lines_with(text, "publish") <= set(data)
    assert {data[-1]} == lines_with(text, "# sink")
    assert not lines_with(text, "clean = ") & {
        s.span.line for s in flows[0].steps if s.dependence != "context"
    }
