"""The contents of objects are read once, until something is stored in them."""

from __future__ import annotations

import ast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import object_contents, reachable_data, recency
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.heap import ANY
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.shared import BORN, Root
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import Place
from tarl_lint.memory.values import BOTTOM, Obj, Value, const, join, pointer
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config

ONE, TWO = Value(frozenset([1])), Value(frozenset([2]))
OBJECTS = 5
FIELDS = ("a", "b", ANY, "[0]")


def made(ctx, key: object, kind: str = "mapping") -> Obj:
    obj = recency.intern(ctx, kind, key, "")
    ctx.store.put((obj, BORN), BOTTOM)
    return obj


def test_contents_are_cached_until_the_next_store(ctx):
    outer, other = made(ctx, "outer"), made(ctx, "other")
    ctx.store.put((outer, "a"), ONE)
    ctx.store.put((outer, "b"), pointer(other))
    first = object_contents.contents(ctx, outer)
    assert (first.nodes, first.steps) == ({1}, (pointer(other),))
    ctx.store.put((other, "a"), TWO)
    assert object_contents.contents(ctx, outer) is first
    ctx.store.push()
    ctx.store.put((outer, "a"), TWO)
    assert object_contents.contents(ctx, outer).nodes == {2}
    ctx.store.pop()
    again = object_contents.contents(ctx, outer)
    assert again is not first
    assert again.alike(first)
    assert not again.alike(object_contents.contents(ctx, other))


def test_contents_include_the_summary_of_the_enclosing_object(ctx):
    whole = made(ctx, "whole", "lib")
    part = whole.sub("part")
    ctx.store.put((part, "x"), ONE)
    before = object_contents.contents(ctx, part)
    ctx.store.put((whole, ANY), TWO)
    after = object_contents.contents(ctx, part)
    assert (before.summary, after.summary, after.summarised) == (frozenset(), {2}, False)
    assert not after.alike(before)


@pytest.mark.parametrize("wrote", [False, True])
def test_running_call_depends_on_contents_that_it_reads(ctx, wrote):
    obj = made(ctx, "obj")
    ctx.store.put((obj, "a"), ONE)
    ctx.store.reads = Reads()
    if wrote:
        ctx.store.put((obj, "a"), TWO)
    object_contents.note(ctx, object_contents.contents(ctx, obj))
    assert ((obj, "a") in ctx.store.reads.keys) is not wrote
    assert ctx.store.reads.objects[obj] == obj.stamp


def test_search_stays_valid_if_no_data_changed(ctx):
    chain = [made(ctx, number) for number in range(2 * reachable_data.FEW)]
    for outer, inner in zip(chain, chain[1:] + chain[:1], strict=True):
        ctx.store.put((outer, "next"), pointer(inner))
    ctx.store.put((chain[-1], "a"), ONE)
    first = frozenset(chain[:1])
    assert reachable_data.deep(ctx, first) == reachable_data.deep(ctx, first) == {1}
    (kept,) = ctx.store.insides.values()
    ctx.store.put((chain[1], "state"), const(True))
    assert reachable_data.deep(ctx, first) == {1}
    assert [*ctx.store.insides.values()] == [kept]
    assert (
        chain[1],
        "state",
    ) in kept.reads.keys  # a later store of data there counts as a change of this search
    ctx.store.put((chain[1], "state"), TWO)
    assert reachable_data.deep(ctx, first) == {1, 2}


STORES = st.lists(
    st.one_of(
        st.tuples(st.integers(0, OBJECTS - 1), st.sampled_from(FIELDS), st.integers(-4, OBJECTS - 1)),
        st.sampled_from(["push", "pop", "keep"]),
    ),
    max_size=30,
)


def _interpreter() -> tuple[Interpreter, Frame]:
    text = "def f():\n    return 1\n"
    ctx = Linker([Module("node.py", "node", text, ast.parse(text))], Config())
    ctx.store = Store(ctx.shared, Root("test", "test"))
    (program,) = ctx.programs.values()
    return ctx, Frame("frame", 1, program.function, program, ctx.module_objects[program.name])


@settings(max_examples=150, deadline=None)
@given(STORES)
def test_cached_searches_give_the_same_result(stores):
    ctx, frame = _interpreter()
    store = ctx.store
    objects = [made(ctx, number, ("mapping", "lib", "sequence")[number % 3]) for number in range(OBJECTS)]
    objects[1] = objects[1].sub("part")
    place = Place(frame, None, "test", (0, 0, 0, 0))
    nodes = [ctx.graph.node(number, place, frozenset()) for number in range(4)]
    depth = len(store.layers)
    for step in stores:
        if step == "push":
            store.push()
        elif isinstance(step, str):
            if len(store.layers) > depth:
                delta = store.pop()
                if step == "keep":
                    store.absorb(delta)
        else:
            owner, name, target = objects[step[0]], step[1], step[2]
            value = Value(frozenset([nodes[-target - 1]])) if target < 0 else pointer(objects[target])
            before = store.get((owner, name)) if name == ANY else None
            store.put((owner, name), value if before is None else join(before, value))
        for wanted in (frozenset(objects[:1]), frozenset(objects)):
            found = reachable_data.deep(ctx, wanted)
            assert found == _afresh(ctx, wanted)


def _afresh(ctx, objects: frozenset[Obj]) -> frozenset[int]:
    """Return the data inside objects, found without anything that earlier searches have kept."""
    store = ctx.store
    kept = store.contents, store.insides, store.split, store.wide
    store.contents, store.insides, store.split, store.wide = {}, {}, {}, set()
    found = reachable_data.deep(ctx, objects)
    store.contents, store.insides, store.split, store.wide = kept
    return found
