"""Runs of arithmetic are recorded with one call, without an observable difference."""

from __future__ import annotations

import ast
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from pytest_tarl.instrumentation.constants import bound
from pytest_tarl.instrumentation.instrument import compiled, instrument
from tests.plugin.instrumentation.programs import assert_same, everywhere
from tests.slow import SLOW

RUN = """
def f(x, k=0.5):
    err = 4.0 - x
    delta = k * err
    x += 2 * delta
    vel = -delta / 3
    return x, vel
"""
VALUES = """
class Odd(float):
    def __rsub__(self, other): out.append("asked"); return 2.0
class Refuses:
    def __rsub__(self, other): raise TypeError("no")
class Wraps:
    def __rsub__(self, other):
        a = 1.0
        b = a * 2
        return b
out = []
"""


class Spy(list[Any]):
    """A recorder's buffer that counts its method calls."""

    def __init__(self) -> None:
        self.calls: list[str] = []

    def append(self, entry: Any) -> None:
        self.calls.append("append")
        super().append(entry)

    def extend(self, entries: Any) -> None:
        self.calls.append("extend")
        super().extend(entries)


def written(source: str, call: str) -> tuple[list[str], list[Any]]:
    """Return the methods that a call of the function used on the buffer, and the buffer's contents."""
    spy = Spy()

    def hook(number: int, value: Any) -> Any:
        spy.calls.append("hook")
        spy[len(spy) :] = [number, value]
        return value

    tree = ast.parse(source)
    tree = instrument(tree, everywhere(tree), inline=True)
    space: dict[str, Any] = {}
    exec(bound(compiled(tree, "<program>"), hook, spy), space)
    spy.clear()
    spy.calls.clear()
    eval(call, space)
    return spy.calls, list(spy)


def test_consecutive_float_statements_are_recorded_with_one_call():
    calls, entries = written(RUN, "f(1.0)")
    assert calls == ["append", "append", "extend", "hook"]  # the function header, the fused run, the return
    assert entries[2:10] == [3, 3.0, 4, 1.5, 5, 4.0, 6, -0.5]


@pytest.mark.parametrize("call", ["f(1)", "f(1.0, k=2)"])
def test_other_types_are_recorded_statement_by_statement(call):
    assert "extend" not in written(RUN, call)[0]


NOT_FUSED = {
    "a name that may have no value": "def f(x):\n if x > 0.5: y = 1.0\n a = x\n b = -a\n c = b * y",
    "a name that may lose its value": "def f(x):\n a = x\n b = -a\n c = b * a\n if c > 5.0: del x",
    "a name that others write to": (
        "def f(x):\n def g():\n  nonlocal x\n  x = None\n a = x\n b = -a\n c = b * a"
    ),
    "a global": "def f(x):\n global y\n y = x\n a = -y\n b = 2.0 * y\n c = 3.0 * y",
    "a division that may fail": "def f(x):\n a = 1.0 / x\n b = 1.0 % x\n c = x // a",
    "a power that may fail": "def f(x):\n a = x ** 2.0\n b = 1.0\n c = x ** 3.0",
    "a huge number": f"def f(x):\n a = x * {2**60}\n b = x + {10**400} if x > 5.0 else 0.0\n c = -x",
    "calls": "def f(x):\n a = abs(x)\n b = float(a)\n c = min(a, b)",
    "too few": "def f(x):\n a = -x\n b = -a",
    "more to ask than to gain": "def f(x, p=1.0, q=1.0, r=1.0):\n a = x + p\n b = a + q\n c = b + r",
    "the same name twice": "def f(x):\n a = -x\n a = -a\n a = 2.0 * a",
}


@pytest.mark.parametrize("kind", NOT_FUSED)
def test_failing_statements_are_not_recorded_together(kind):
    assert "extend" not in written(NOT_FUSED[kind], "f(1.0)")[0]


FUSED = {
    "in a loop": "def f(x):\n for i in range(1):\n  a = -x\n  b = -a\n  c = a * b",
    "with the loop's target": "def f(x):\n for i in (x,):\n  a = -i\n  b = -a\n  c = a * b",
    "in a branch": "def f(x):\n if x:\n  a = -x\n  b = -a\n  c = a * b",
    "in a handler": "def f(x):\n try: raise KeyError\n except KeyError:\n  a = -x\n  b = -a\n  c = a * b",
    "in a case": "def f(x):\n match x:\n  case _:\n   a = -x\n   b = -a\n   c = a * b",
    "in a method": "class A:\n def f(self, x):\n  a = -x\n  b = -a\n  c = a * b\nf = A().f",
    "in a closure": "def f(x):\n def g():\n  return x\n a = -x\n b = -a\n c = a * b\n g()",
    "in a function inside": "def f(x):\n def g(y):\n  a = -y\n  b = -a\n  c = a * b\n g(x)",
    "in a coroutine": (
        "async def g(x):\n a = -x\n b = -a\n c = a * b\ndef f(x):\n try: g(x).send(None)\n except StopIteration: pass"
    ),
    "with names of private": "class A:\n def f(self, __x):\n  __a = -__x\n  b = -__a\n  c = __a * b\nf = A().f",
}


@pytest.mark.parametrize("kind", FUSED)
def test_consecutive_float_arithmetic_is_recorded_in_one_call(kind):
    calls, entries = written(FUSED[kind], "f(2.0)")
    assert calls.count("extend") == 1
    assert {-2.0, 2.0, -4.0} <= {entry for entry in entries if type(entry) is float}


@pytest.mark.parametrize(
    "value",
    [
        "1.0",
        "2",
        "None",
        "'s'",
        "[1.0]",
        "True",
        "1j",
        "float('nan')",
        "1e308 * 10",
        "10**400",
        "Odd(1.0)",
        "Refuses()",
        "Wraps()",
        "__import__('fractions').Fraction(1, 3)",
    ],
)
def test_fused_code_behaves_the_same_for_any_value(value):
    assert_same(f"{VALUES}{RUN}\ny = f({value})\nz = f(1.0, {value})", trace=True)


NAMES = st.sampled_from(["x", "y", "z", "w"])
TERMS = st.recursive(
    st.one_of(NAMES, st.sampled_from(["1.5", "0.0", "2", "0", "-3", "1e308", "self.k", "True"])),
    lambda e: st.one_of(
        st.tuples(e, st.sampled_from(["+", "-", "*", "/", "//", "%", "**"]), e).map(
            lambda t: f"({' '.join(t)})"
        ),
        e.map(lambda x: f"(-{x})"),
        st.tuples(e, e).map(lambda t: f"({t[0]}\n      - {t[1]})"),
    ),
    max_leaves=4,
)
LINES = st.one_of(
    st.tuples(NAMES, TERMS).map(lambda t: f"{t[0]} = {t[1]}"),
    st.tuples(NAMES, st.sampled_from(["+=", "*="]), TERMS).map(" ".join),
    st.tuples(NAMES, NAMES, TERMS, TERMS).map(lambda t: f"{t[0]} = {t[2]}; {t[1]} = {t[3]}"),
    st.sampled_from(["del z", "g(x)", "if x > 1: y = x", "for w in (1.0, 2.0): y = w * x"]),
)
ARGUMENTS = st.sampled_from(["1.0", "-2.5", "0.0", "3", "None", "1e308", "Odd(2.0)", "Wraps()"])


@settings(max_examples=150 if SLOW else 60, suppress_health_check=list(HealthCheck))
@given(st.lists(LINES, min_size=3, max_size=9), ARGUMENTS, ARGUMENTS)
@example(["g(x)", "x = x", "g(x)"], "1.0", "Wraps()")
def test_generated_arithmetic_behaves_the_same(lines, first, second):
    body = "\n".join(f"    {line}" for line in lines)
    program = f"def f(self, x, y):\n{body}\n    return x, y\nf.k = 0.5\ng = out.append\n"
    assert_same(f"{VALUES}{program}z = f(f, 1.0, 2.0)\nz = f(f, {first}, {second})", trace=True)
