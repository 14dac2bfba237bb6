"""`except*` and exception groups, and iteration with a sentinel."""

from __future__ import annotations

import sys

import pytest

from tarl_lint.ir import nodes as ir
from tarl_lint.ir.exception_types import NO_CLASSES, PARTS, handled_by
from tests.lint.models.marked import differing, in_callback, sections

BODIES = """\
### an exception by itself
try:
    if msg.data > 1.0:
        raise ValueError("high")
except* ValueError:
    out.publish(1.0)  # control
### a group that is raised under a condition
errors = []
if msg.data > 1.0:
    errors.append(ValueError("high"))
try:
    if errors:
        raise ExceptionGroup("all", errors)
except* ValueError as group:
    out.publish(len(group.exceptions))  # control
### the data in a group
try:
    raise ExceptionGroup("all", [ValueError(msg.data)])
except* ValueError as group:
    out.publish(group.exceptions[0].args[0])  # data
### a handler of another class
try:
    if msg.data > 1.0:
        raise ValueError("high")
except* TypeError:
    out.publish(1.0)  # clean
### a group has no certain handler
try:
    if msg.data > 1.0:
        raise ExceptionGroup("all", [TypeError("a")])
except* ValueError:
    pass
except* TypeError:
    out.publish(1.0)  # control
### what follows an exception that is handled
try:
    if msg.data > 1.0:
        raise ValueError("high")
except* ValueError:
    pass
out.publish(1.0)  # clean
### what is left out
try:
    if msg.data > 1.0:
        raise ValueError("high")
    out.publish(1.0)  # control
except* ValueError:
    pass
### a group that leaves the function
def check():
    if msg.data > 1.0:
        raise ExceptionGroup("all", [ValueError("high")])
try:
    check()
    out.publish(1.0)  # control
except* ValueError:
    out.publish(2.0)  # control
"""
SENTINELS = """\
### a queue
held = queue.Queue()
held.put(msg.data)
for item in iter(held.get, None):
    out.publish(item)  # data
### a function of the file
def read():
    return msg.data
for item in iter(read, 0.0):
    out.publish(item)  # data
### a lambda with a constant
for item in iter(lambda: 1.0, None):
    out.publish(item)  # clean
### a list
for item in iter([1.0, 2.0]):
    out.publish(item)  # clean
"""


@pytest.mark.skipif(sys.version_info < (3, 11), reason="except* is new in Python 3.11")
@pytest.mark.parametrize("body", sections(BODIES).values(), ids=sections(BODIES))
def test_data_passes_through_exception_groups(body: str) -> None:
    assert differing(in_callback(body)) == {}


@pytest.mark.parametrize("body", sections(SENTINELS).values(), ids=sections(SENTINELS))
def test_data_passes_through_an_iteration_until_a_sentinel(body: str) -> None:
    assert differing(in_callback(body, "import queue")) == {}


def test_except_star_may_catch_the_whole_group() -> None:
    where = (1, 0, 1, 1)
    handled = handled_by(ir.Starred(ir.Name("ValueError", "global", 0, where), where))
    assert handled == {PARTS, "ValueError"}
    assert NO_CLASSES.catches(handled, "ExceptionGroup") is None
    assert NO_CLASSES.catches(handled, "ValueError") is True
    assert NO_CLASSES.catches(handled, "TypeError") is False
