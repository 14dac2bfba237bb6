"""Every kind of statement in every context is recorded as in the table in docs/recording.md.

`python -m tests.plugin.instrumentation.test_table` prints the table as it should be.
"""

from __future__ import annotations

import ast
import contextlib
import inspect
import textwrap
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from pytest_tarl.instrumentation.instrument import compiled, instrument
from pytest_tarl.instrumentation.recorder import Recorder

PAGE = Path(__file__).parents[3] / "docs" / "recording.md"
BEFORE = "x = 1.5"
SITE = "«"  # marks where the site begins, if the statement begins elsewhere
CONTEXTS = {
    "module": "{}",
    "function": "def f():\n    {}\ndrive(f())",
    "method": "class A:\n    def f(self):\n        {}\ndrive(A().f())",
    "nested": "def f():\n    def g():\n        {}\n    drive(g())\nf()",
    "decorated": "@functools.cache\ndef f():\n    {}\ndrive(f())",
    "generator": "def f():\n    {}\n    yield\ndrive(f())",
    "coroutine": "async def f():\n    {}\ndrive(f())",
    "class body": "class A:\n    {}",
    "in blocks": "for _ in (1,):\n    with ready:\n        try:\n            {}\n        finally:\n            pass",
    "after `;`": "def f():\n    {}\ndrive(f())",
}
STATEMENTS = {
    "assignment": "y = x * 2.0",
    "… of a tuple": "a, b = 3.0, 4.0",
    "… with a star": "a, *b = 3.0, 4.0",
    "… to an attribute": "o.speed = x",
    "… to an item": "d['k'] = x + 1.0",
    "… several at once": "a = b = x",
    "… annotated": "y: float = x",
    "… walrus": "(y := x + 1.0)",
    "augmented assignment": "x += 2.0",
    "… of an attribute": "o.gain *= 4.0",
    "call": "abs(-2.0)",
    "publish call": "pub.publish(x)",
    "method call over lines": "d.setdefault(\n    'j', 7.0)",
    "comprehension": "y = [i for i in (3.0, 4.0)]",
    "condition of `if`": "if x > 1.0: pass",
    "… of `elif`": f"if x > 2.0: pass\n{SITE}elif x > 1.0: pass",
    "… of `while`": "while x > 1.0: x -= 1.0",
    "… of `assert`": "assert x > 1.0",
    "`for`": "for y in (2.0, 3.0): pass",
    "`async for`": "async for y in stream(): pass",
    "`with`": "with ready as y: pass",
    "`async with`": "async with ready as y: pass",
    "`match`": "match x:\n    case _: pass",
    "guard of `case`": f"match x:\n    case {SITE}y if y > 1.0: pass",
    "`except`": f"try: raise Halt\n{SITE}except Halt: pass",
    "`raise`": "raise Halt",
    "`return`": "return x",
    "`yield`": "yield x",
    "what is sent": "y = yield x",
    "`yield from`": "y = yield from iter([x])",
    "`await`": "y = await later(x)",
    "head of a function": "def g(m): pass\ng(x)",
    "lambda body": f"(lambda m: {SITE}m * 2.0)(x)",
    "parameter": f"def g(a, {SITE}m): pass\ng(0, x)",
    "`del`": "del x",
    "`pass`": "pass",
    "`import`": "import math",
}


class Halt(Exception):  # noqa: N818 - what a statement of the table raises
    """Raised by a statement of the table; ends its program as expected."""


class Ready:
    """A synchronous and asynchronous context manager."""

    def __enter__(self) -> float:
        return 5.0

    def __exit__(self, *_: object) -> None: ...

    async def __aenter__(self) -> float:
        return 5.0

    async def __aexit__(self, *_: object) -> None: ...


async def stream() -> Any:
    yield 2.0
    yield 3.0


async def later(value: float) -> float:
    return value


def drive(started: Any) -> None:
    """Run the result of a call (a generator or coroutine) to its end."""
    if inspect.isgenerator(started):
        list(started)
    elif inspect.iscoroutine(started):
        with contextlib.suppress(StopIteration):
            started.send(None)
    elif inspect.isasyncgen(started):
        with contextlib.suppress(StopAsyncIteration):
            while True:
                with contextlib.suppress(StopIteration):
                    started.__anext__().send(None)


def placed(statement: str, context: str) -> str:
    """Return a program that contains the statement."""
    inside, joint = CONTEXTS[context], "; " if context == "after `;`" else "\n"
    (line,) = (line for line in inside.splitlines() if "{}" in line)
    indent = " " * line.index("{}")
    marked = statement if SITE in statement else SITE + statement
    return inside.replace("{}", textwrap.indent(f"{BEFORE}{joint}{marked}", indent).lstrip())


def recorded(statement: str, context: str) -> str:
    """Return the flow values that the site leaves; a dash where Python does not allow the statement."""
    marked = placed(statement, context)
    before, _, after = marked.partition(SITE)
    site = (before.count("\n") + 1, len(before.rpartition("\n")[2]))
    try:
        compile(before + after, "<table>", "exec")
    except SyntaxError:
        return "–"
    recorder = Recorder()
    space: dict[str, Any] = {"drive": drive, "stream": stream, "later": later, "Halt": Halt, "ready": Ready()}
    space |= {"o": SimpleNamespace(gain=2.0), "d": {}, "pub": SimpleNamespace(publish=lambda _message: None)}
    space["functools"] = __import__("functools")
    tree = instrument(ast.parse(before + after), {site: 0}, inline=True)
    with contextlib.suppress(Halt):
        exec(recorder.bind(compiled(tree, "<table>")), space)
    return ", ".join(f"{flow:g}" for flow in recorder.finish().flow) or "nothing"


def table() -> list[str]:
    """Return the lines of the table."""
    lines = [f"| statement | example, after `{BEFORE}` | records | {' | '.join(CONTEXTS)} |"]
    lines.append("|---" * (3 + len(CONTEXTS)) + "|")
    for kind, statement in STATEMENTS.items():
        found = [recorded(statement, context) for context in CONTEXTS]
        usual = next(values for values in found if values != "–")
        cells = ["●" if values == usual else values for values in found]
        example = " ⏎ ".join(line.strip() for line in statement.replace(SITE, "").splitlines())
        lines.append(f"| {kind} | `{example}` | {usual} | {' | '.join(cells)} |")
    return lines


def test_the_table_in_the_docs_matches_the_recorder() -> None:
    page = PAGE.read_text("utf-8")
    assert [line for line in table() if line not in page.splitlines()] == []


def test_every_statement_is_recorded_in_every_context() -> None:
    assert {kind for kind, one in STATEMENTS.items() if recorded(one, "function") == "nothing"} == {
        "`import`"
    }


if __name__ == "__main__":
    print("\n".join(table()))
