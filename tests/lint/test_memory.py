"""Single operations of the abstract memory."""

from __future__ import annotations

import ast

import pytest

from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.memory import heap, joins, reachable_data, recency, updates
from tarl_lint.memory.abstract_gc import lasting
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.reads import Reads
from tarl_lint.memory.shared import BORN, Root
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import Place
from tarl_lint.memory.values import ABSENT, BOTTOM, MAX_CONSTS, Value, const, join, pointer
from tarl_lint.read.source import Module
from tarl_lint.settings.config import Config

DATA = frozenset([1])
OTHER = frozenset([2])


@pytest.fixture
def ctx() -> Interpreter:
    text = "def f():\n    return 1\n"
    made = Linker([Module("node.py", "node", text, ast.parse(text))], Config())
    made.store = Store(made.shared, Root("test", "test"))
    return made


@pytest.fixture
def frame(ctx) -> Frame:
    (program,) = ctx.programs.values()
    return Frame("frame", 1, program.function, program, ctx.module_objects[program.name])


def instance(ctx, key):
    obj = recency.intern(ctx, "sequence", key)
    ctx.store.put((obj, BORN), BOTTOM)
    return obj


def test_store_through_a_pointer_to_one_object_is_strong(ctx):
    obj = instance(ctx, "a")
    updates.write_field(ctx, pointer(obj), "x", Value(DATA))
    updates.write_field(ctx, pointer(obj), "x", Value(OTHER))
    assert heap.read_field(ctx, obj, "x").deps == OTHER


def test_store_to_one_of_two_objects_is_a_weak_update(ctx):
    one, two = instance(ctx, "a"), instance(ctx, "b")
    updates.write_field(ctx, pointer(one), "x", Value(DATA))
    updates.write_field(ctx, Value(pts=frozenset([one, two])), "x", Value(OTHER))
    assert heap.read_field(ctx, one, "x").deps == DATA | OTHER
    assert heap.read_field(ctx, two, "x").deps == OTHER


def test_summary_object_is_never_updated_strongly(ctx):
    obj = instance(ctx, "a")
    obj.many = True
    for deps in (DATA, OTHER):
        updates.write_field(ctx, pointer(obj), "x", Value(deps))
    assert heap.read_field(ctx, obj, "x").deps == DATA | OTHER


def test_store_to_an_unknown_element_may_change_any(ctx):
    obj = instance(ctx, "a")
    updates.write_item(ctx, pointer(obj), const(0), Value(DATA))
    updates.add_element(ctx, pointer(obj), Value(OTHER))
    assert heap.read_field(ctx, obj, heap.item_field(0)).deps == DATA | OTHER
    assert heap.read_any(ctx, obj).deps == DATA | OTHER


def test_closing_a_layer_discards_its_stores(ctx):
    obj = instance(ctx, "a")
    updates.write_field(ctx, pointer(obj), "x", Value(DATA))
    ctx.store.push()
    updates.write_field(ctx, pointer(obj), "x", Value(OTHER))
    delta = ctx.store.pop()
    assert heap.read_field(ctx, obj, "x").deps == DATA
    joins.merge(ctx, [delta, {}])
    assert heap.read_field(ctx, obj, "x").deps == DATA | OTHER


def test_newest_object_of_a_site_is_separate(ctx, frame):
    newest = recency.allocate(ctx, "lib", frame, "site")
    ctx.store.put((newest, "x"), Value(DATA))
    holder = instance(ctx, "holder")
    updates.write_field(ctx, pointer(holder), "held", pointer(newest))
    again = recency.allocate(ctx, "lib", frame, "site")
    (older,) = heap.read_field(ctx, holder, "held").pts
    assert again is newest
    assert older is not newest
    assert older.many
    assert heap.read_field(ctx, older, "x").deps == DATA
    assert heap.read_field(ctx, newest, "x").deps == frozenset()


def test_nested_data_is_found_without_unrelated_objects(ctx):
    outer, inner, empty = (instance(ctx, key) for key in "abc")
    updates.write_field(ctx, pointer(inner), "x", Value(DATA))
    updates.write_field(ctx, pointer(outer), "inner", pointer(inner))
    assert reachable_data.deep(ctx, frozenset([outer])) == DATA
    assert reachable_data.deep(ctx, frozenset([empty])) == frozenset()


def test_parts_without_data_add_nothing(ctx):
    message = recency.intern(ctx, "message", "m")
    message.info = 7
    message.sub("pose").sub("position")
    assert reachable_data.deep(ctx, frozenset([message])) == frozenset([7])
    ctx.store.put((message.sub("pose"), "x"), Value(DATA))
    assert reachable_data.deep(ctx, frozenset([message])) == frozenset([7]) | DATA


@pytest.mark.parametrize("name", [heap.ANY, heap.LENGTH, heap.KEYS, heap.HELD, heap.SENT])
def test_summary_field_is_not_part_of_a_library_object(ctx, name):
    obj = recency.intern(ctx, "lib", "matrix")
    assert heap.read_field(ctx, obj, name) is BOTTOM
    assert not obj.subs


def test_joining_a_cleared_summary_field_adds_no_objects(ctx, frame):
    obj = recency.allocate(ctx, "lib", frame, "slot")
    updates.add_element(ctx, pointer(obj), Value(DATA))
    ctx.store.push()
    recency.allocate(ctx, "lib", frame, "slot")
    cleared = ctx.store.pop()
    assert cleared[obj, heap.ANY] is ABSENT
    assert joins.joined(ctx, [cleared, {}])[obj, heap.ANY] == Value(DATA)
    assert not obj.subs


def test_unreachable_objects_are_dropped_when_a_function_returns(ctx, frame):
    kept, gone = (recency.allocate(ctx, "sequence", frame, key) for key in ("kept", "gone"))
    ctx.store.put((kept, "[0]"), Value(DATA))
    ctx.store.put((gone, "[0]"), Value(DATA))
    ctx.store.put((frame, "local"), pointer(gone))
    delta = lasting(ctx.store.since(0), frame, [kept], frozenset(), ctx.store.reads)
    assert (kept, "[0]") in delta
    assert not any(owner in (gone, frame) for owner, _ in delta)


def test_too_many_constants_become_unknown():
    values = [const(n) for n in range(MAX_CONSTS + 1)]
    whole = BOTTOM
    for value in values[:-1]:
        whole = join(whole, value)
    assert whole.consts == frozenset(range(MAX_CONSTS))
    assert join(whole, values[-1]).consts is None


def test_a_join_without_change_returns_the_same_object():
    value = Value(DATA | OTHER)
    assert join(value, Value(DATA)) is value


def test_foreign_stores_are_read_once_per_run(ctx):
    obj = instance(ctx, "a")
    key, other = (obj, "x"), Root("other", "other")
    ctx.shared.leave(ctx.shared.ends, other, key, Value(DATA))
    assert ctx.store.others(key) is ctx.store.others(key)
    ctx.shared.leave(ctx.shared.ends, other, key, Value(OTHER))
    assert ctx.store.root in ctx.shared.dirty
    assert Store(ctx.shared, ctx.store.root).others(key) == Value(DATA | OTHER)


def carrying(graph, frame, key):
    return graph.node(key, Place(frame, None, "assign", (0, 0, 0, 0)), frozenset())


def test_content_depends_on_carriers_that_contained_it(ctx, frame):
    graph = ctx.graph
    item, carrier = carrying(graph, frame, "item"), carrying(graph, frame, "carrier")
    content, carriers = frozenset([item]), frozenset([carrier])
    assert graph.through(content, carriers) == content
    graph.hold(carrier, content)
    (arrived,) = graph.through(content, carriers)
    assert graph.carried[arrived] == (carrier, item)
    assert graph.through(content, carriers) == {arrived}


def test_call_depends_on_carriers_of_a_cached_answer(ctx, frame):
    graph = ctx.graph
    item, first, second = (carrying(graph, frame, key) for key in ("item", "first", "second"))
    graph.hold(first, frozenset([item]))
    (carried,) = graph.through(frozenset([item]), frozenset([first]))
    graph.hold(carried, frozenset([item]))
    for _ in range(2):
        graph.reads = Reads()
        graph.through(frozenset([item]), frozenset([carried, second]))
        assert graph.reads.held.keys() >= {carried, item, second}
        assert all(graph.passed_by(node) == size for node, size in graph.reads.held.items())
    graph.hold(second, frozenset([item]))
    assert graph.reads.held[second] != graph.passed_by(second)
    graph.reads = Reads()
    assert graph.through(frozenset([item]), frozenset([carried, second])) != frozenset([item])
    assert graph.reads.held[second] == 1
