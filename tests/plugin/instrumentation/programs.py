"""Run a program unmodified and with every statement recorded, and compare everything observable."""

from __future__ import annotations

import ast
import linecache
import re
import sys
import textwrap
import traceback
from dataclasses import dataclass, field
from typing import Any

from pytest_tarl.instrumentation.constants import bound
from pytest_tarl.instrumentation.instrument import Offset, instrument
from pytest_tarl.instrumentation.instrument import compiled as code_of

FILE = "<program>"
MODES = [False, True]


@dataclass
class Outcome:
    """The observable behaviour of a run, and its recorded events."""

    values: dict[str, str] = field(default_factory=dict)
    error: str = ""
    lines: list[tuple[str, int, str]] = field(default_factory=list)
    events: list[tuple[int, Any]] = field(default_factory=list)


def shown(value: object) -> str:
    """Return the `repr` of a value without addresses, which differ between two runs."""
    return re.sub(" at 0x[0-9a-f]+", "", repr(value))


def everywhere(tree: ast.Module) -> dict[Offset, int]:
    """Make every statement, lambda body, handler and case a site; its number is its line."""
    found = {}
    for node in ast.walk(tree):
        if isinstance(node, (ast.stmt, ast.ExceptHandler)):
            found.setdefault((node.lineno, node.col_offset), node.lineno)
        elif isinstance(node, ast.Lambda):
            found.setdefault((node.body.lineno, node.body.col_offset), node.body.lineno)
        elif isinstance(node, ast.match_case):
            found.setdefault((node.pattern.lineno, node.pattern.col_offset), node.pattern.lineno)
    return found


def compiled(source: str, sites: dict[Offset, int] | None, *, inline: bool, **options: Any):
    tree = ast.parse(source)
    if sites is None:
        return compile(tree, FILE, "exec", dont_inherit=True)
    return code_of(instrument(tree, sites, inline=inline, **options), FILE)


def run(
    source: str, sites: dict[Offset, int] | None = None, *, inline: bool = False, trace: bool = False
) -> Outcome:
    """Execute a program, instrumented if there are sites."""
    outcome, buffer = Outcome(), []

    def hook(number, value):
        buffer.extend((number, value))
        return value

    space: dict[str, Any] = {"__name__": "program"}
    code = bound(compiled(source, sites, inline=inline), hook, buffer)
    linecache.cache[FILE] = (len(source), None, source.splitlines(keepends=True), FILE)

    def follow(frame, event, _):
        if frame.f_code.co_filename != FILE:
            return None
        outcome.lines.append((event, frame.f_lineno, frame.f_code.co_name))
        return follow

    before = sys.gettrace()
    try:
        if trace:
            sys.settrace(follow)
        exec(code, space)
    except Exception as error:
        sys.settrace(before)
        inside = error.__traceback__.tb_next if error.__traceback__ else None
        outcome.error = "".join(traceback.format_exception(type(error), error, inside))
    finally:
        sys.settrace(before)
    outcome.values = {n: shown(v) for n, v in space.items() if not n.startswith("__") and not callable(v)}
    outcome.events = list(zip(buffer[0::2], buffer[1::2], strict=True))
    return outcome


def recorded(source: str, *, inline: bool) -> list[tuple[int, Any]]:
    source = textwrap.dedent(source)
    return run(source, everywhere(ast.parse(source)), inline=inline).events


def assert_same(source: str, *, trace: bool) -> None:
    plain = run(source, trace=trace)
    seen: list[Any] = []
    for inline in MODES:
        watched = run(source, everywhere(ast.parse(source)), inline=inline, trace=trace)
        assert (watched.values, watched.error) == (plain.values, plain.error)
        assert watched.lines == plain.lines
        seen.append([(number, shown(value)) for number, value in watched.events])
    assert seen[0] == seen[1]
