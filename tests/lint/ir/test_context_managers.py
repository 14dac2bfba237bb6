"""The two parts of a divided context manager do what the generator does."""

from __future__ import annotations

import ast
import random
from collections.abc import Callable
from contextlib import contextmanager
from typing import Any

import pytest

from tarl_lint.ir.context_managers import LEAVE, divided

HEADER = "@contextmanager\ndef manager(given):\n    global total\n"


def _body(rng: random.Random, depth: int = 0) -> list[str]:
    """Return random statements, one of which yields."""
    yielding = rng.choice(["yield", "yield given", "yield local", "with", "try", "finally"])
    if depth > 2 or yielding.startswith("yield"):
        middle = [yielding if yielding.startswith("yield") else "yield"]
    elif yielding == "with":
        middle = ["with guard(local):", *_indented(_body(rng, depth + 1))]
    else:
        middle = ["try:", *_indented(_body(rng, depth + 1))]
        if yielding == "try":
            middle += ["except KeyError:", "    log('never')"]
            middle += ["else:", *_indented(_plain(rng))] if rng.random() < 0.5 else []
        if yielding == "finally" or rng.random() < 0.5:
            middle += ["finally:", *_indented(_plain(rng))]
    return [*_plain(rng), *middle, *_plain(rng)]


def _plain(rng: random.Random) -> list[str]:
    choices = [
        "local = local + 1",
        "total = total * 2 + local",
        "given = given + local",
        "log(local, given, total)",
        "state['a'] = local",
        "for each in range(2): local = local + each",
    ]
    return [rng.choice(choices) for _ in range(rng.randrange(1, 4))]


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for line in lines]


def _names(lines: list[Any]) -> dict[str, Any]:
    @contextmanager
    def guard(value: int) -> Any:
        lines.append(("in", value))
        yield
        lines.append(("out", value))

    state: dict[str, int] = {}
    return {
        "contextmanager": contextmanager,
        "guard": guard,
        "log": lambda *values: lines.append(values),
        "state": state,
        "total": 1,
    }


def _with_parts(manager: Callable[[int], Any], body: Callable[[Any], None]) -> None:
    value, leave = manager(3)
    body(value)
    leave()


def _with(manager: Callable[[int], Any], body: Callable[[Any], None]) -> None:
    with manager(3) as value:
        body(value)


def _run(tree: ast.Module, use: Callable[..., None]) -> list[Any]:
    lines: list[Any] = []
    names = _names(lines)
    exec(compile(ast.fix_missing_locations(tree), "manager.py", "exec"), names)

    def body(value: Any) -> None:
        lines.append(("body", value))
        names["total"] += 5

    use(names["manager"], body)
    return [*(one for one in lines if one[0] not in ("in", "out")), names["total"], names["state"]]


@pytest.mark.parametrize("seed", range(60))
def test_context_manager_acts_like_its_generator(seed):
    lines = ["local = 2", *_body(random.Random(seed))]
    text = HEADER + "\n".join(_indented(lines))
    before = _run(ast.parse(text), _with)
    tree = ast.parse(text)
    function = tree.body[0]
    assert isinstance(function, ast.FunctionDef)
    function.body, function.decorator_list = [*divided(function)], []
    assert LEAVE in ast.dump(tree)
    assert _run(tree, _with_parts) == before


@pytest.mark.parametrize(
    "body",
    [
        "if given: yield",
        "yield\n    yield",
        "for one in given: yield one",
        "x = yield given",
        "yield from given",
    ],
)
def test_indivisible_generator_stays_as_it_is(body):
    (function,) = ast.parse(f"@contextmanager\ndef manager(given):\n    {body}").body
    assert isinstance(function, ast.FunctionDef)
    assert divided(function) is function.body


def test_generators_that_are_not_context_managers_stay_unchanged():
    (function,) = ast.parse("@pytest.fixture\ndef manager(given):\n    yield given").body
    assert isinstance(function, ast.FunctionDef)
    assert divided(function) is function.body
