"""How many statements of a program are executed after its budget is spent, with very small limits."""

from __future__ import annotations

import ast

import pytest

from tarl_lint.interpret import context_selection, fixpoint, state
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config
from tests.lint.models.marked import in_callback

HELPERS = "\n".join(f"def step_{n}(x):\n    y = x + {n}\n    return y" for n in range(30))
CALLS = "\n".join(f"value = step_{n}(msg.data)" for n in range(30)) + "\nout.publish(value)"
CHAIN = (
    "\n".join(f"def deep_{n}(x):\n    return deep_{n + 1}(x)" for n in range(20))
    + "\ndef deep_20(x):\n    return x"
)


def run(body: str, head: str) -> Linker:
    text = in_callback(body, head)
    machine = Linker([Module("node.py", "node", text, ast.parse(text))], Config())
    machine.link()
    return machine


def executed(body: str = CALLS, head: str = HELPERS) -> int:
    return run(body, head).work.totals["node.py"]


def test_a_program_within_its_budget_is_analysed_completely():
    assert run(CALLS, HELPERS).cut == {}


def test_program_beyond_its_budget_executes_few_statements(monkeypatch):
    whole = executed()
    monkeypatch.setattr(state, "PROGRAM_LIMIT", 0)
    assert executed() == whole
    assert list(run(CALLS, HELPERS).cut) == ["node.py"]
    monkeypatch.setattr(fixpoint, "LATE_RUN_LIMIT", 10)
    assert 10 <= executed() < whole - 30


def test_no_function_is_entered_beyond_the_statement_limit(monkeypatch):
    whole = executed()
    monkeypatch.setattr(fixpoint, "MAX_STATEMENTS", 10)
    assert 10 <= executed() < whole - 30


@pytest.mark.parametrize("depth", [3, 9])
def test_functions_are_entered_up_to_a_maximum_call_depth(monkeypatch, depth):
    publishing = "out.publish(deep_0(msg.data))"
    whole = run(publishing, CHAIN).called
    monkeypatch.setattr(context_selection, "MAX_CALLS", depth)
    entered = 21 - len(whole - run(publishing, CHAIN).called)
    assert entered == depth  # below the callback
