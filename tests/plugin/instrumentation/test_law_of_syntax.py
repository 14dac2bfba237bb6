"""Programs in every corner of the grammar, made by hypothesmith: recorded, they do what they did."""

from __future__ import annotations

import ast
import builtins
import contextlib
import io
import os
import re
from typing import Any

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from pytest_tarl.instrumentation.recorder import Recorder
from tests.plugin.instrumentation.programs import compiled, everywhere

hypothesmith = pytest.importorskip("hypothesmith")

EXAMPLES = 2000 if os.environ.get("TARL_SLOW") else 25
# Such programs call names at random: these would reach outside of the test, or never come back.
WITHHELD = ("breakpoint", "exit", "help", "input", "open", "quit", "__import__", "exec", "eval", "compile")
CALLABLE = {name: getattr(builtins, name) for name in dir(builtins) if name not in WITHHELD}


def outcome(code: Any, **extra: Any) -> tuple[list[str], str, str]:
    """Return the names that a program leaves with their values, what it raised and what it printed."""
    space: dict[str, Any] = {"__name__": "program", "__builtins__": dict(CALLABLE), **extra}
    said, raised = io.StringIO(), ""
    with contextlib.redirect_stdout(said):
        try:
            exec(code, space)
        except BaseException as error:
            raised = repr(error)
    own = {name: value for name, value in space.items() if name not in extra and not name.startswith("__")}
    plain = (str, int, float, bool, tuple, list, dict, type(None))
    shown = [f"{n} {v!r}" if isinstance(v, plain) else f"{n} {type(v)}" for n, v in sorted(own.items())]
    return shown, re.sub(" at 0x[0-9a-f]+", "", raised), said.getvalue()


@settings(
    max_examples=EXAMPLES,
    suppress_health_check=list(HealthCheck),
    database=None,
)
@given(st.one_of(hypothesmith.from_node(auto_target=False), hypothesmith.from_grammar(auto_target=False)))
def test_any_program_of_the_grammar_does_the_same(source):
    try:
        tree = ast.parse(source)
        plain = compile(source, "<program>", "exec", dont_inherit=True)
    except (SyntaxError, ValueError):
        assume(False)
        return
    assume(not any(isinstance(node, (ast.While, ast.Import, ast.ImportFrom)) for node in ast.walk(tree)))
    expected = outcome(plain)
    for inline in (False, True):
        recorder = Recorder()
        assert outcome(recorder.bind(compiled(source, everywhere(tree), inline=inline))) == expected
        recorder.finish()
