"""Attributes of functions, and keys of the blackboard, are the same fields under several names or through objects."""

from __future__ import annotations

import itertools

import pytest

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import blackboards, function_attributes, heap, recency, updates
from tarl_lint.memory.blackboards import Naming
from tarl_lint.memory.function_attributes import DECORATED, MAX_WRAPPERS, WRAPPED, attribute_of
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, const, pointer

ONE, TWO = Value(frozenset([1])), Value(frozenset([2]))
NOTHING = const(None)


def a_function(ctx: Interpreter, name: str) -> Obj:
    return recency.intern(ctx, "closure", name, name)


def bound(ctx: Interpreter, function: Obj) -> Obj:
    receiver = recency.intern(ctx, "instance", "self", "C")
    return heap.method(ctx, function, receiver, recency.intern(ctx, "class", "C", "C"))


def test_a_bound_method_has_the_attributes_of_its_function(ctx: Interpreter) -> None:
    function = a_function(ctx, "f")
    method = bound(ctx, function)
    assert function_attributes.attribute(ctx, method, "x") is None
    assert heap.read_field(ctx, method, "x") is BOTTOM
    updates.write_field(ctx, pointer(function), "x", ONE)
    assert ctx.store.get((function, attribute_of("x"))) is ONE
    assert function_attributes.attribute(ctx, method, "x") is heap.read_field(ctx, function, "x") is ONE
    assert heap.read_field(ctx, method, "y") is BOTTOM
    updates.write_field(ctx, pointer(method), "x", TWO)  # Python raises an AttributeError
    assert heap.read_field(ctx, method, "x") is ONE
    assert heap.read_field(ctx, method, "__func__").pts == {function}
    assert heap.read_field(ctx, method, "__self__").pts == {recency.intern(ctx, "instance", "self")}
    assert heap.read_field(ctx, method, "__name__") == const("f")


def test_a_wrapper_has_the_attributes_of_its_function(ctx: Interpreter) -> None:
    functions = [a_function(ctx, str(number)) for number in range(MAX_WRAPPERS + 2)]
    updates.write_field(ctx, pointer(functions[0]), "x", ONE)
    for inner, outer in itertools.pairwise(functions):
        updates.write_field(ctx, pointer(outer), WRAPPED, pointer(inner))
    assert function_attributes.attribute(ctx, functions[1], "x") is ONE
    assert function_attributes.attribute(ctx, functions[1], "__name__") == const("0")
    assert function_attributes.attribute(ctx, functions[1], WRAPPED) == pointer(functions[0])
    assert function_attributes.attribute(ctx, functions[0], WRAPPED) is None
    assert function_attributes.attribute(ctx, bound(ctx, functions[-1]), "x") is None  # too many wrappers
    updates.write_field(ctx, pointer(functions[1]), "x", TWO)
    assert function_attributes.attribute(ctx, functions[2], "x") is TWO
    assert function_attributes.attribute(ctx, functions[0], "x") is ONE


def test_getattr_default_counts_unless_the_function_has_the_attribute(ctx: Interpreter) -> None:
    function, other, partial = a_function(ctx, "f"), a_function(ctx, "g"), recency.intern(ctx, "partial", "p")

    def found(*objects: Obj) -> Value:
        base = Value(pts=frozenset(objects))
        value = heap.read(ctx, base, "x")
        return function_attributes.with_default(ctx, base, "x", value, NOTHING)

    assert found(function) == NOTHING
    updates.write_field(ctx, pointer(function), "x", const("a"))
    assert found(function) == const("a")
    assert found(function, other).consts == {"a", None}
    assert found(other) == NOTHING
    assert found(partial) == UNKNOWN
    updates.write_field(ctx, pointer(other), DECORATED, const(value=True))
    assert found(other) == UNKNOWN
    assert function_attributes.may_have_more(ctx, pointer(bound(ctx, other)))
    assert not function_attributes.may_have_more(ctx, pointer(function))


@pytest.mark.parametrize(
    ("namespace", "key", "name"),
    [
        ("/", "level", "/level"),
        ("/near", "level", "/near/level"),
        ("/near", "/far/level", "/far/level"),
        ("/near", "part/level", "/near/part/level"),
    ],
)
def test_blackboard_keys_have_the_namespace_of_their_client(namespace: str, key: str, name: str) -> None:
    assert Naming(namespace).absolute(key) == name


def test_all_clients_share_the_blackboard(ctx: Interpreter) -> None:
    near, root = blackboards.client(ctx, 1, "near/"), blackboards.client(ctx, 2, "")
    updates.write_field(ctx, near, "level", ONE)
    assert heap.read(ctx, root, "near/level") is heap.read(ctx, near, "level") is ONE
    assert heap.read(ctx, root, "level") is BOTTOM
    (client,) = near.pts
    assert blackboards.seen_through(ctx, client, "level") == (blackboards.board(ctx), "/near/level")
    stamp = client.stamp
    assert blackboards.client(ctx, 1, "/near") == near
    assert client.stamp == stamp
    blackboards.remap(client, "level", "far/level")
    assert client.stamp == stamp + 1
    assert heap.read(ctx, near, "level") is BOTTOM
    updates.write_field(ctx, root, "far/level", TWO)
    assert heap.read(ctx, near, "level") is TWO
    assert heap.read(ctx, near, "/near/other") is BOTTOM
