"""Which changes of an object a call detects before a replay, and where loops and carriers resume."""

from __future__ import annotations

import ast

import pytest

from tarl_lint.flows.reachability import Tracer
from tarl_lint.interpret import branches
from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.memory import recency
from tarl_lint.memory.reads import NEW, Reads
from tarl_lint.memory.same_reads import unchanged
from tarl_lint.memory.shared import BORN, Root, Shared
from tarl_lint.memory.store import Store
from tarl_lint.memory.value_flow_graph import Graph
from tarl_lint.memory.values import BOTTOM, Obj, Value, pointer
from tarl_lint.read.source import Module
from tarl_lint.run.deep_stack import with_deep_stack
from tarl_lint.settings.config import Config

DATA = frozenset([1])
NESTED = """
import rospy
from std_msgs.msg import Float64

def on_message(msg):
    best, table = 0.0, {}
    for i in range(9):
        for j in range(9):
            for k in range(9):
                previous = best
                table[i] = best
                best = table[j] + last
                last = msg.data
    pub.publish(previous)

pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64, on_message)
"""


@pytest.fixture
def store() -> Store:
    return Store(Shared(), Root("test", "test"))


@pytest.fixture
def obj(store) -> Obj:
    made = Obj("lib", "made")
    store.put((made, BORN), BOTTOM)
    return made


def same(store: Store, reads: Reads) -> bool:
    return unchanged(reads, *store.found_by(reads), store, Graph())


def noted(store: Store, *objects: Obj) -> Reads:
    """Return the reads of a call that read these objects in their present state."""
    reads = Reads()
    for obj in objects:
        reads.look(obj)
    return reads


def hidden(store: Store, obj: Obj, name: str, value: Value) -> None:
    """Store a field on a path that is then left."""
    store.push()
    store.put((obj, name), value)
    store.pop()


def test_field_added_on_another_path_is_invisible(store, obj):
    reads = noted(store, obj)
    hidden(store, obj, "x", BOTTOM)
    assert same(store, reads)
    store.put((obj, "x"), BOTTOM)
    assert not same(store, reads)


def test_waiting_call_reads_new_fields_of_other_entry_points(store, obj):
    reads = noted(store, obj)
    hidden(store, obj, "x", BOTTOM)
    reads.wait(0)
    assert not same(store, reads)


def test_call_does_not_see_data_of_another_path(store, obj):
    store.put((obj, "x"), BOTTOM)
    reads = noted(store, obj)
    hidden(store, obj, "x", Value(DATA))
    assert obj.laden
    assert same(store, reads)
    store.put((obj, "x"), Value(DATA))
    assert not same(store, reads)


def test_call_sees_new_data_in_an_indirect_object(store, obj):
    inner = Obj("lib", "inner")
    store.put((obj, "x"), pointer(inner))
    reads = noted(store, obj)
    store.put((inner, "y"), Value(DATA))
    assert obj.laden
    assert not same(store, reads)


def test_call_sees_data_anywhere_in_the_enclosing_object(store, obj):
    part = obj.sub("x")
    reads = noted(store, part)
    store.put((obj, "*"), Value(DATA))
    assert part.laden
    assert not same(store, reads)


def test_store_into_a_part_prevents_the_replay(store, obj):
    reads = noted(store, obj)
    inner = obj.sub("x").sub("y")
    assert same(store, reads)
    store.put((inner, "z"), BOTTOM)
    assert not same(store, reads)


def test_changed_object_description_is_always_seen(store, obj):
    reads = noted(store, obj)
    obj.describe("another thing")
    assert not same(store, reads)


def test_call_is_not_replayed_if_its_new_object_is_referenced(store):
    obj, holder = Obj("lib", "made"), Obj("instance", "holder")
    reads = Reads(objects={obj: NEW})
    hidden(store, obj, BORN, BOTTOM)
    assert same(store, reads)
    hidden(store, holder, "x", pointer(obj))
    assert same(store, reads)
    store.put((holder, "x"), pointer(obj))
    assert not same(store, reads)  # creating the object would first merge the held one into the older ones


def test_pointer_counts_only_if_the_call_sees_its_holder(store, obj):
    one, other = Obj("instance", "one"), Obj("instance", "other")
    store.put((one, "x"), pointer(obj))
    reads = Reads(holders={obj: len(obj.holders)})
    hidden(store, other, "x", pointer(obj))
    assert same(store, reads)
    store.put((other, "x"), pointer(obj))
    assert not same(store, reads)


def test_wait_ignores_keys_without_foreign_stores():
    shared, root, other = Shared(), Root("one", "test"), Root("other", "test")
    mine, theirs = (Obj("instance", "a"), "x"), (Obj("instance", "b"), "x")
    shared.leave(shared.pauses, other, theirs, Value(DATA))
    store = Store(shared, root)
    root.heeds.add(mine)
    assert store.heard() == {}
    store.waited = True
    for key in (mine, theirs):
        store.put(key, Value())
    before = store.heard()
    store.get(mine)
    assert store.heard() is before
    store.get(theirs)
    assert store.heard() == {theirs: Value(DATA)}
    assert before == {}
    assert Store(shared, root).heard() == {theirs: Value(DATA)}


def test_path_independent_reads_are_merged_once(obj):
    inner, outer = Reads(objects={obj: 3}), Reads()
    outer.add(inner)
    assert outer.objects == {obj: 3}
    outer.objects.clear()
    outer.left += 1
    outer.add(inner)
    assert outer.objects == {}


# --- loops ------------------------------------------------------------------------------------------------


def linked(text: str) -> Linker:
    machine = Linker([Module("node.py", "node", text, ast.parse(text))], Config(), thorough=False)
    with_deep_stack(machine.link)
    return machine


def test_an_inner_loop_starts_from_its_last_fixpoint(monkeypatch):
    going_on = linked(NESTED)
    monkeypatch.setattr(branches, "_first_head", lambda *_: {})
    afresh = linked(NESTED)
    assert Tracer(going_on).flows() == Tracer(afresh).flows() != ()
    assert going_on.total < 0.7 * afresh.total


def test_the_start_of_a_loop_also_includes_later_stores(store):
    machine = linked(NESTED)
    frame = next(f for f in machine.frames.values() if f.function.name == "on_message")
    machine.store = store
    ((key, head), *_) = frame.heads.items()
    statement = type("Loop", (), {"id": key[0]})()
    best = (frame, "best")
    store.put(best, Value(frozenset([-1])))
    assert branches._first_head(machine, statement, frame)[best].deps == head[best].deps | {-1}  # type: ignore[arg-type]


# --- carriers ---------------------------------------------------------------------------------------------


def test_cached_reachability_is_valid_until_more_data_passes():
    machine = linked(NESTED)
    graph = machine.graph
    place = graph.places[0]
    item, outer, inner = (graph.node(("test", n), place, frozenset()) for n in range(3))
    graph.hold(inner, frozenset([item]))
    graph.hold(outer, frozenset([inner]))
    (carried,) = graph.through(frozenset([inner]), frozenset([outer]))
    first = graph.through(frozenset([item]), frozenset([carried]))
    assert graph.arrivals
    assert graph.through(frozenset([item]), frozenset([carried])) == first
    graph.hold(outer, graph.through(frozenset([item]), frozenset([inner])))
    assert graph.through(frozenset([item]), frozenset([carried])) != first


def test_cached_reachability_records_its_carriers():
    machine = linked(NESTED)
    graph = machine.graph
    place = graph.places[0]
    item, outer, inner = (graph.node(("test", n), place, frozenset()) for n in range(3))
    graph.hold(inner, frozenset([item]))
    graph.hold(outer, frozenset([inner]))
    (carried,) = graph.through(frozenset([inner]), frozenset([outer]))
    asked = []
    for _ in range(2):
        graph.reads = Reads()
        graph.through(frozenset([item]), frozenset([carried]))
        asked.append(graph.reads.held)
    assert asked[0] == asked[1] != {}


def test_call_records_allocating_an_existing_object(store):
    machine = linked(NESTED)
    frame = next(iter(machine.frames.values()))
    machine.store = store
    obj = recency.allocate(machine, "lib", frame, "test")
    assert store.reads.objects[obj] == NEW
