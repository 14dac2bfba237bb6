"""The state of a run in layers, the shared stores of all runs, and the reads of a call."""

from __future__ import annotations

import pytest

from tarl_lint.memory.frames import Frame
from tarl_lint.memory.reads import NEW, Reads, complete
from tarl_lint.memory.same_reads import unchanged
from tarl_lint.memory.shared import BORN, Root, Shared
from tarl_lint.memory.store import Store, as_it_is, private
from tarl_lint.memory.value_flow_graph import Graph
from tarl_lint.memory.values import ABSENT, BOTTOM, DATA, Obj, Value, const, pointer

ONE, TWO = Value(frozenset([1])), Value(frozenset([2]))
BOTH = Value(frozenset([1, 2]))


@pytest.fixture
def shared() -> Shared:
    return Shared()


@pytest.fixture
def store(shared) -> Store:
    return Store(shared, Root("mine", "callback"))


@pytest.fixture
def obj() -> Obj:
    return Obj("sequence", "a")


# --- layers -------------------------------------------------------------------------------------------


def test_a_read_sees_the_last_store_in_any_layer(store, obj):
    key = (obj, "x")
    assert store.get(key) is None
    store.put(key, ONE)
    store.push()
    assert store.get(key) is ONE
    store.put(key, TWO)
    assert store.get(key) is TWO
    assert store.pop() == {key: TWO}
    assert store.get(key) is ONE


def test_closing_a_layer_restores_the_former_values(store, obj):
    old, new = (obj, "old"), (obj, "new")
    store.put(old, ONE)
    store.push({old: TWO, new: TWO})
    assert (store.get(old), store.get(new)) == (TWO, TWO)
    store.pop()
    assert (store.get(old), store.get(new)) == (ONE, None)


def test_an_absent_field_reads_as_unset(store, obj):
    store.put((obj, "x"), ABSENT)
    assert store.get((obj, "x")) is None
    assert store.peek((obj, "x")) is None
    assert store.stored((obj, "x"))
    assert not store.stored((obj, "y"))


def test_stores_since_a_depth_are_in_the_layers_above(store, obj):
    first, second, third = ((obj, name) for name in "abc")
    store.put(first, ONE)
    store.push()
    store.put(second, ONE)
    store.push()
    store.put(second, TWO)
    store.put(third, TWO)
    assert store.since(1) == {second: TWO, third: TWO}
    assert store.since(2) == {second: TWO, third: TWO}
    assert store.since(0) == {first: ONE, second: TWO, third: TWO}
    store.cut(2)
    assert store.since(1) == {second: ONE}
    store.cut(1)
    assert store.since(0) == {first: ONE}


def test_absorbed_stores_are_undone_when_the_absorbing_layer_closes(store, obj):
    key = (obj, "x")
    store.put(key, ONE)
    store.push()
    tick = store.tick
    store.absorb({key: TWO})
    assert store.get(key) is TWO
    assert store.tick > tick
    assert key in store.reads.written
    store.pop()
    assert store.get(key) is ONE


def test_stores_in_frames_do_not_change_the_state(store, obj, frame):
    tick = store.tick
    store.put((frame, "local"), ONE)
    assert store.tick == tick
    store.put((obj, "x"), ONE)
    assert store.tick == tick + 1


def test_variables_are_private_unless_a_closure_captures_them(store, obj, frame):
    assert private((frame, "x"))
    assert not private((obj, "x"))
    store.put((frame, "x"), ONE)
    store.put((obj, "x"), ONE)
    assert store.own() == [(obj, "x")]
    frame.captured = True
    assert not private((frame, "x"))
    assert store.own() == [(frame, "x"), (obj, "x")]


def test_nodes_of_a_summary_field_are_merged(store, obj):
    store.gather = lambda _, value: Value(frozenset([9]), value.pts)
    for name, gathered in [("*", True), ("<keys>", True), ("<length>", True), ("x", False)]:
        store.put((obj, name), BOTH)
        assert store.get((obj, name)) == (Value(frozenset([9])) if gathered else BOTH)
    store.put((obj, "*"), ONE)
    assert store.get((obj, "*")) is ONE
    assert as_it_is((obj, "*"), BOTH) is BOTH


def test_store_marks_the_object_and_its_holders(store, obj):
    holder, outer = Obj("instance", "b"), Obj("instance", "c")
    store.put((holder, "held"), pointer(obj))
    store.put((outer, "held"), pointer(holder))
    assert not any(one.laden for one in (obj, holder, outer))
    store.put((obj, "x"), ONE)
    assert obj.laden
    assert holder.laden
    assert outer.laden
    assert obj.changes == ["x", DATA]
    late = Obj("instance", "d")
    store.put((late, "held"), pointer(obj))
    assert late.laden


def test_a_constant_is_not_data(store, obj):
    store.put((obj, "x"), const(1))
    assert not obj.laden
    assert obj.changes == ["x"]


def test_holders_of_future_older_objects_are_recorded(store, obj):
    library = Obj("lib", "l")
    store.put((obj, "x"), pointer(library))
    function = Obj("closure", "f")
    store.put((obj, "y"), pointer(function))
    assert list(library.holders) == [(obj, "x")]
    assert function.holders == {}


def test_assigning_dunder_dict_increments_the_edition(store, obj):
    store.put((obj, "x"), ONE)
    assert store.shared.edition == 0
    store.put((obj, "__dict__"), ONE)
    assert store.shared.edition == 1


# --- reads --------------------------------------------------------------------------------------------


def test_own_stores_are_not_recorded_as_reads(store, obj):
    mine, other = (obj, "mine"), (obj, "other")
    store.put(mine, ONE)
    store.get(mine)
    store.get(other)
    store.stored(mine)
    store.stored(other)
    assert store.reads.keys == {other}
    assert store.reads.stored == {other}


def test_peeking_at_a_value_records_no_read(store, obj):
    store.put((obj, "x"), ONE)
    store.reads = Reads()
    assert store.peek((obj, "x")) is ONE
    assert store.peek((obj, "y")) is None
    assert store.reads.keys == set()


def test_the_current_values_of_recorded_reads_are_looked_up(store, obj):
    here, gone, unset = ((obj, name) for name in ("here", "gone", "unset"))
    store.put(here, ONE)
    store.put(gone, ABSENT)
    reads = Reads(keys={here, gone, unset}, stored={here, unset})
    assert store.found_by(reads) == ({here: ONE, gone: None, unset: None}, {here: True, unset: False})


def test_reading_fields_records_the_first_version_and_the_reader(store, obj):
    store.look(obj)
    obj.changed("x")
    store.look(obj)
    assert store.reads.objects == {obj: 0}
    assert store.shared.watchers == {obj: {store.root}}
    store.doubt(obj)
    assert store.shared.doubters == {obj: {store.root}}


def test_a_recorded_query_keeps_its_first_answer():
    reads, list_ = Reads(), [1]
    reads.ask(len, tuple(list_))
    assert reads.facts == {(len, (1,)): 1}
    answers = iter([3, 4])
    reads.ask(counting := (lambda _: next(answers)), "x")
    reads.ask(counting, "x")
    assert reads.facts[counting, "x"] == 3


def test_first_wait_records_the_stored_keys(obj):
    reads = Reads(written={(obj, "x")})
    reads.wait(3, {(obj, "y")})
    reads.written.add((obj, "z"))
    reads.wait(5)
    assert (reads.waits, reads.heard) == (True, 3)
    assert reads.own == {(obj, "x"), (obj, "y")}


def test_finished_reads_keep_only_values_that_a_replay_needs(obj):
    here, mine = (obj, "here"), (obj, "mine")
    outer, inner = Reads(written={mine}), Reads(keys={here, mine}, stored={here})
    outer.add(inner)
    outer.arrivals.add("cached")
    assert inner in outer.taken
    outer.finish(outer.keys, outer.stored)
    assert outer.finished == ({here}, {here})
    assert (outer.taken, outer.arrivals, outer.written) == ({}, set(), set())


def test_values_read_at_several_waits_are_joined_per_key(obj):
    reads = Reads()
    reads.admit((obj, "x"), ONE)
    reads.admit((obj, "x"), TWO)
    assert reads.admitted == {(obj, "x"): BOTH}


def test_nested_call_omits_keys_stored_by_its_caller(obj):
    mine, other = (obj, "mine"), (obj, "other")
    outer = Reads(written={mine})
    inner = Reads(keys={mine, other}, stored={mine, other}, unreached={4}, whole=False)
    inner.objects[obj], inner.holders[obj], inner.held[7], inner.facts[len, ()] = 2, 3, 5, 0
    inner.wait(6)
    inner.admit(other, ONE)
    outer.add(inner)
    assert (outer.keys, outer.stored) == ({other}, {other})
    assert (outer.unreached, outer.objects, outer.holders, outer.held) == ({4}, {obj: 2}, {obj: 3}, {7: 5})
    assert outer.facts == {(len, ()): 0}
    assert (outer.whole, outer.waits, outer.heard, outer.admitted) == (False, True, 6, {other: ONE})


def test_equal_reads_are_merged_after_a_path_ended(obj):
    key = (obj, "x")
    outer, inner = Reads(written={key}), Reads(keys={key})
    outer.add(inner)
    outer.written.clear()
    outer.add(inner)
    assert outer.keys == set()
    outer.left += 1
    outer.add(inner)
    assert outer.keys == {key}


def test_completing_a_mapping_keeps_existing_entries():
    mine = {"a": 1}
    complete(mine, {"a": 2, "b": 3})
    assert mine == {"a": 1, "b": 3}
    empty: dict[str, int] = {}
    complete(empty, {"a": 2})
    assert empty == {"a": 2}
    complete(mine, {"a": 5})
    assert mine == {"a": 1, "b": 3}


def same(store: Store, reads: Reads, graph: Graph | None = None) -> bool:
    return unchanged(reads, *store.found_by(reads), store, graph or Graph())


def test_recorded_reads_stay_valid_until_something_changes(store, obj):
    read, asked = (obj, "read"), (obj, "asked")
    store.put(read, ONE)
    facts: list[int] = []
    reads = Reads(keys={read}, stored={asked})
    reads.ask(question := (lambda _: len(facts)), "x")
    found, stored = store.found_by(reads)
    assert unchanged(reads, found, stored, store, Graph())
    store.put(read, Value(frozenset([1])))
    assert unchanged(reads, found, stored, store, Graph())  # an equal value
    facts.append(1)
    assert not unchanged(reads, found, stored, store, Graph())
    reads.facts[question, "x"] = 1
    store.push()
    store.put(asked, ONE)
    assert not unchanged(reads, found, stored, store, Graph())
    store.pop()
    assert unchanged(reads, found, stored, store, Graph())
    store.put(read, TWO)
    assert not unchanged(reads, found, stored, store, Graph())


def test_new_source_or_new_data_makes_recorded_reads_outdated(store):
    graph = Graph()
    assert same(store, Reads(unreached={3}), graph)
    graph.live.add(3)
    assert not same(store, Reads(unreached={3}), graph)
    assert same(store, Reads(held={5: 0}), graph)
    graph.hold(5, frozenset([6]))
    assert not same(store, Reads(held={5: 0}), graph)
    assert same(store, Reads(held={5: 1}), graph)


def test_new_object_fields_make_recorded_reads_outdated(store, obj):
    library = Obj("lib", "l")
    assert same(store, Reads(objects={library: NEW}))
    store.put((obj, "x"), pointer(library))
    assert not same(store, Reads(objects={library: NEW}))
    assert not same(store, Reads(holders={library: 0}))
    assert same(store, Reads(holders={library: 1}))
    store.put((obj, "y"), ONE)
    assert not same(store, Reads(objects={obj: NEW}))


def test_summary_object_makes_recorded_reads_outdated(store, obj):
    outer, inner = Reads(), Reads(single={obj})
    outer.add(inner)
    assert same(store, outer)
    store.shared.several.add(Obj("instance", "another"))
    assert same(store, outer)
    store.shared.several.add(obj)
    assert not same(store, outer)
    assert same(store, Reads())


# --- shared stores ------------------------------------------------------------------------------------


def test_run_begins_with_stores_of_all_entry_points(shared, obj):
    mine, other, once = Root("mine", "callback"), Root("other", "callback"), Root("once", "timer", once=True)
    key = (obj, "x")
    assert shared.entry(key, mine) is None
    shared.leave(shared.ends, mine, key, ONE)
    shared.leave(shared.pauses, other, key, TWO)
    assert shared.entry(key, mine) == BOTH
    assert shared.entry(key, other) == ONE  # `other` stored TWO at a wait, but not at its end
    shared.leave(shared.ends, once, key, Value(frozenset([3])))
    assert shared.entry(key, once) == BOTH  # `once` never runs concurrently with itself
    assert shared.entry(key, mine) == Value(frozenset([1, 2, 3]))


def test_stores_during_a_wait_are_foreign_stores(shared, obj):
    mine, other = Root("mine", "callback"), Root("other", "callback")
    key = (obj, "x")
    shared.leave(shared.ends, mine, key, ONE)
    assert shared.others(key, mine) is None
    shared.leave(shared.pauses, other, key, TWO)
    assert shared.others(key, mine) == TWO
    assert shared.others(key, other) == ONE


def test_changed_value_reruns_the_entry_points_that_read_it(shared, obj):
    reader, writer = Root("reader", "callback"), Root("writer", "callback", once=True)
    key = (obj, "x")
    shared.entry(key, reader)
    shared.others(key, writer)
    shared.leave(shared.ends, writer, key, ONE)
    assert shared.dirty == {reader}
    shared.dirty.clear()
    shared.leave(shared.ends, writer, key, Value(frozenset([1])))
    assert shared.dirty == set()
    shared.leave(shared.ends, writer, key, TWO)
    assert shared.dirty == {reader}
    assert shared.ends[key][writer] == BOTH


def test_concurrent_entry_point_reads_its_own_stores(shared, obj):
    mine = Root("mine", "callback")
    shared.entry((obj, "x"), mine)
    shared.leave(shared.ends, mine, (obj, "x"), ONE)
    assert shared.dirty == {mine}


def test_new_field_reruns_entry_points_that_read_the_object(shared):
    whole, watcher, writer = Obj("message", "m"), Root("watcher", "callback"), Root("writer", "timer")
    shared.look(whole, watcher)
    shared.leave(shared.ends, writer, (whole.sub("pose"), BORN), BOTTOM)
    assert shared.dirty == set()
    shared.leave(shared.ends, writer, (whole.sub("pose"), "x"), ONE)
    assert shared.dirty == {watcher}


def test_new_data_reruns_entry_points_that_found_none(shared):
    obj, doubter = Obj("lib", "a"), Root("doubter", "callback")
    part, outer = obj.sub("x"), Obj("lib", "outer")
    obj.inside[outer] = None
    for one in (obj, part, outer):
        Store(shared, doubter).doubt(one)
    shared.load(part, Root("writer", "callback"))
    assert obj.laden
    assert outer.laden
    assert shared.dirty == {doubter}
    assert shared.doubters == {}


def test_generation_of_a_frame_counts_its_recursive_ancestors(ctx):
    (program,) = ctx.programs.values()
    first = Root("a", "timer", function=program.function)
    other = Root("b", "timer", maker=first)
    third = Root("c", "timer", function=program.function, maker=other)
    assert [root.generations() for root in (first, other, third)] == [0, 0, 1]
    assert Root("d", "timer", function=program.function, maker=third).generations() == 2


def test_object_from_another_path_has_only_foreign_stores(shared, store):
    obj, other, mine = Obj("lib", "made"), Root("other", "callback"), store.root
    store.push()
    store.put((obj, BORN), BOTTOM)
    store.put((obj, "x"), ONE)
    assert store.former((obj, "x"), {}) is ONE
    assert store.made(obj, {})
    store.pop()
    assert not store.made(obj, {})
    assert store.made(obj, {obj: True})
    shared.leave(shared.ends, other, (obj, "x"), TWO)
    assert store.former((obj, "x"), {}) == TWO
    shared.dirty.clear()
    shared.leave(shared.ends, mine, (obj, "x"), ONE)
    assert shared.dirty == set()
    shared.leave(shared.ends, other, (obj, "x"), Value(frozenset([3])))
    assert shared.dirty == {mine}


def test_new_object_is_invisible_to_others_until_a_wait(store, obj):
    assert not store.isolated(obj)
    store.push()
    store.put((obj, BORN), BOTTOM)
    assert store.isolated(obj)
    store.waited = True
    assert not store.isolated(obj)
    store.waited = False
    store.pop()
    assert not store.isolated(obj)


# --- waits --------------------------------------------------------------------------------------------


def test_reads_after_a_wait_include_foreign_stores(store, obj):
    key, other = (obj, "x"), Root("other", "callback")
    store.put(key, ONE)
    store.shared.leave(store.shared.ends, other, key, TWO)
    assert store.get(key) is ONE
    assert store.root not in store.shared.dirty
    store.waited = True
    assert store.get(key) is ONE
    assert store.root.heeds == {key}
    assert store.shared.dirty == {store.root}
    assert store.heard() == {key: TWO}


def test_store_of_known_data_reruns_nothing(store, obj):
    store.put((obj, "x"), BOTH)
    store.shared.leave(store.shared.ends, Root("other", "callback"), (obj, "x"), TWO)
    store.waited = True
    store.get((obj, "x"))
    assert store.root.heeds == {(obj, "x")}
    assert store.shared.dirty == set()


def test_local_variable_read_after_a_wait_has_no_foreign_data(store, frame):
    store.put((frame, "x"), ONE)
    store.waited = True
    assert store.get((frame, "x")) is ONE
    assert store.root.heeds == set()


def test_wait_skips_keys_without_foreign_stores(store, obj):
    store.root.heeds.add((obj, "x"))
    assert store.heard() == {}


def test_entry_point_publishes_no_foreign_values(store, obj):
    key = (obj, "x")
    assert store.admit(key, BOTH, TWO) is BOTH
    assert key not in store.foreign
    admitted = store.admit(key, ONE, TWO)
    assert admitted == BOTH
    assert store.foreign[key] == Value(frozenset([2]), consts=frozenset())
    assert store.reads.admitted[key] == store.foreign[key]
    assert store.mine(key, admitted) == ONE
    store.take(key, Value(frozenset([1])))
    assert store.mine(key, Value(frozenset([1, 2]), consts=frozenset())) is None


def test_entry_point_publishes_only_new_values(store, obj):
    key = (obj, "x")
    assert store.mine(key, ONE) is ONE
    store.found[key] = ONE
    assert store.mine(key, BOTH) == TWO
    assert store.mine(key, ONE) is None
    store.found[key] = const(1)
    assert store.mine(key, const(2)) == const(2)


# --- frames -------------------------------------------------------------------------------------------


def test_a_released_frame_keeps_no_states(frame):
    frame.returns.append(({}, ONE))
    frame.heads[1,] = {}
    frame.arguments, frame.recorded, frame.passed = [ONE], "run", ([], {})
    frame.release()
    assert (frame.returns, frame.jumps, frame.tries, frame.escapes, frame.arguments) == ([], [], [], [], [])
    assert (frame.recorded, frame.passed, frame.heads) == (None, None, {})


def test_only_a_class_body_frame_has_an_owner_class(ctx, frame):
    assert frame.owner_class() is None
    (program,) = ctx.programs.values()
    body = Frame("body", 2, program.function, program, ctx.module_objects[program.name])
    body.cls = Obj("class", "A")
    assert body.owner_class() is body.cls
