"""Reads and stores of fields and elements, joins, copies, and the reachability of objects."""

from __future__ import annotations

import gc
import itertools
from dataclasses import replace

import pytest

from tarl_lint.ir import nodes as ir
from tarl_lint.ir.exception_types import NO_CLASSES
from tarl_lint.memory import (
    abstract_gc,
    heap,
    joins,
    object_contents,
    reachable_data,
    recency,
    symbolic_names,
    updates,
    userdata,
)
from tarl_lint.memory.frames import Attempt, Frame
from tarl_lint.memory.heap import ANY, KEYS, item_field
from tarl_lint.memory.recency import MAX_NESTING
from tarl_lint.memory.shared import BORN, Root
from tarl_lint.memory.values import (
    ABSENT,
    BOTTOM,
    BY_CLASS,
    UNKNOWN,
    ClassInfo,
    Obj,
    Symbolic,
    Value,
    const,
    pointer,
)
from tarl_lint.parameter_names import MARK, ParameterName

ONE, TWO = Value(frozenset([1])), Value(frozenset([2]))
BOTH = Value(frozenset([1, 2]))
AT = (0, 0, 0, 0)


def made(ctx, kind: str, key: object, name: str = "") -> Obj:
    obj = recency.intern(ctx, kind, key, name)
    ctx.store.put((obj, BORN), BOTTOM)
    return obj


def a_class(ctx, name: str, *bases: Obj, external: tuple[str, ...] = ()) -> Obj:
    cls = recency.intern(ctx, "class", name, name)
    cls.info = ClassInfo(name, name, list(bases), list(external))
    return cls


def an_instance(ctx, cls: Obj, key: object = "self") -> Obj:
    obj = made(ctx, "instance", key)
    obj.info = cls
    return obj


def a_function(ctx, name: str, *decorators: str) -> Obj:
    (program,) = ctx.programs.values()
    names = tuple(ir.Name(one, "global", 0, AT) for one in decorators)
    function = replace(program.function, decorators=names)
    closure = recency.intern(ctx, "closure", name, name)
    closure.info = (function, None, program, None)
    return closure


# --- reads --------------------------------------------------------------------------------------------


def test_field_data_includes_data_of_the_whole_object(ctx):
    whole = made(ctx, "lib", "a")
    part = whole.sub("x")
    assert heap.content(ctx, part) is BOTTOM
    ctx.store.put((whole, ANY), Value(frozenset([1]), frozenset([whole])))
    assert heap.content(ctx, part) == ONE
    message = made(ctx, "message", "m")
    message.info = 7
    assert heap.content(ctx, message.sub("x")) == Value(frozenset([7]))
    assert heap.content(ctx, made(ctx, "ext", "library")) is UNKNOWN


def test_unset_message_field_has_values_of_other_runs(ctx):
    message = made(ctx, "message", "m")
    ctx.shared.leave(ctx.shared.ends, ctx.store.root, (message, "x"), ONE)
    assert heap.read_field(ctx, message, "x") == Value(frozenset([1]), frozenset([message.sub("x")]))
    assert not heap.written_here(ctx, message, "x")
    ctx.store.put((message, "x"), TWO)
    assert heap.read_field(ctx, message, "x") is TWO
    assert heap.written_here(ctx, message, "x")


def test_function_attributes_are_separate_from_parameter_defaults(ctx):
    closure = a_function(ctx, "f")
    assert heap.renamed(ctx, closure, "x") == (closure, "<x>")
    updates.write_field(ctx, pointer(closure), "x", ONE)
    assert heap.read_field(ctx, closure, "x") is ONE
    assert ctx.store.get((closure, "<x>")) is ONE
    assert ctx.store.get((closure, "x")) is None


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("publisher", "publish"),
        ("sequence", "append"),
        ("mapping", "update"),
        ("lib", "put"),
        ("goal", "publish_feedback"),
    ],
)
def test_unset_attribute_of_a_library_object_is_a_bound_method(ctx, kind, name):
    obj = made(ctx, kind, "a")
    (method,) = heap.default(ctx, obj, name).pts
    assert (method.kind, method.info) == ("method", (obj, name))
    assert heap.held_method(ctx, obj, name) == pointer(method)


@pytest.mark.parametrize(("name", "held"), [("create_subscription", True), ("name", False)])
def test_unknown_object_has_only_callables_that_ros_knows(ctx, name, held):
    value = heap.read_or_hold(ctx, ONE, name)
    assert [(one.kind, one.info[1]) for one in value.pts] == ([("method", name)] if held else [])
    assert value.deps == ONE.deps
    instance = an_instance(ctx, a_class(ctx, "A"))
    ctx.store.put((instance, name), TWO)
    assert heap.read_or_hold(ctx, pointer(instance), name) is TWO


def test_unset_field_has_the_default_of_its_object_kind(ctx):
    listed, ext = made(ctx, "sequence", "a"), recency.intern(ctx, "ext", "numpy", "numpy")
    instance = an_instance(ctx, cls := a_class(ctx, "A"))
    ctx.store.put((listed, ANY), ONE)
    assert heap.default(ctx, listed, "[0]") is ONE
    assert heap.default(ctx, listed, "x") is BOTTOM
    assert heap.default(ctx, instance, "__class__") == pointer(cls)
    assert heap.default(ctx, instance, "__dict__") == pointer(instance)
    assert [o.name for o in heap.default(ctx, ext, "linalg").pts] == ["numpy.linalg"]
    assert heap.default(ctx, recency.intern(ctx, "closure", "f"), "x") is BOTTOM


def test_shape_field_is_special_only_outside_messages(ctx):
    matrix, message = made(ctx, "lib", "a"), made(ctx, "lib", "b")
    message.info = BY_CLASS
    for obj in (matrix, message):
        ctx.store.put((obj, ANY), ONE)
    assert heap.default(ctx, matrix, "shape") == ONE
    assert heap.default(ctx, message, "shape") == pointer(message.sub("shape"))


def test_known_index_may_read_an_element_at_an_unknown_index(ctx):
    obj = made(ctx, "lib", "a")
    assert heap.default(ctx, obj, "[0]") == pointer(obj.sub("[0]"))
    any_of_them = obj.sub("[]")
    assert heap.default(ctx, obj, "[1]").pts == {obj.sub("[1]"), any_of_them}
    assert heap.default(ctx, obj, "x") == pointer(obj.sub("x"))


def test_a_class_attribute_is_inherited_by_instances_and_subclasses(ctx):
    base = a_class(ctx, "Base")
    cls = a_class(ctx, "A", base)
    obj = an_instance(ctx, cls)
    ctx.store.put((base, "limit"), ONE)
    assert heap.read_field(ctx, obj, "limit") is ONE
    assert heap.read_field(ctx, cls, "limit") is ONE
    ctx.store.put((cls, "limit"), TWO)
    assert heap.read_field(ctx, obj, "limit") is TWO
    ctx.store.put((obj, "limit"), BOTH)
    assert heap.read_field(ctx, obj, "limit") is BOTH
    assert heap.read_field(ctx, cls, "unset") is BOTTOM
    assert heap.read_field(ctx, obj, "unset") is BOTTOM


def test_unset_attribute_of_an_opaque_class_is_a_library_object(ctx):
    obj = an_instance(ctx, a_class(ctx, "A", external=("base.Node",)))
    (held,) = heap.read_field(ctx, obj, "thing").pts
    assert (held.kind, held.key) == ("lib", ("inherited", "self", "thing"))
    (method,) = heap.read_field(ctx, obj, "create_publisher").pts
    assert method.info == (obj, "create_publisher")
    assert heap.read_field(ctx, obj, "[0]") is BOTTOM


def test_replaced_attribute_dictionary_is_used(ctx):
    obj, table = an_instance(ctx, a_class(ctx, "A")), made(ctx, "mapping", "table")
    assert heap.replaced_attributes(ctx, obj) == frozenset()
    ctx.store.put((obj, "__dict__"), pointer(table))
    assert heap.replaced_attributes(ctx, obj) == {table}
    ctx.store.put((table, "['x']"), ONE)
    assert heap.read_field(ctx, obj, "x") == ONE
    updates.write_field(ctx, pointer(obj), "x", TWO)
    assert ctx.store.get((table, "['x']")) == BOTH


def test_decorators_decide_how_a_function_is_bound(ctx):
    cls = a_class(ctx, "A")
    obj = an_instance(ctx, cls)
    plain, static, of_class = (
        a_function(ctx, "plain"),
        a_function(ctx, "static", "staticmethod"),
        a_function(ctx, "of_class", "classmethod"),
    )
    (bound,) = heap.bind(ctx, pointer(plain), obj, cls).pts
    assert bound.info == (plain, obj, cls)
    assert bound is heap.method(ctx, plain, obj, cls)
    assert heap.bind(ctx, pointer(static), obj, cls) == pointer(static)
    (bound,) = heap.bind(ctx, pointer(of_class), obj, cls).pts
    assert bound.info == (of_class, cls, cls)
    (bound,) = heap.bind_class(ctx, pointer(of_class), cls).pts
    assert bound.info == (of_class, cls, cls)
    assert heap.bind_class(ctx, value := pointer(plain), cls) is value
    assert heap.bind(ctx, ONE, obj, cls) is ONE
    both = Value(frozenset([1]), frozenset([plain, made(ctx, "lib", "a")]))
    assert heap.bind(ctx, both, obj, cls).deps == {1}


def test_star_imports_are_found_through_other_modules(ctx):
    (program,) = ctx.programs.values()
    module = ctx.module_objects[program.name]
    inner, outer = (recency.intern(ctx, "module", name, name) for name in ("inner", "outer"))
    ctx.module_objects.update(inner=inner, outer=outer)
    ctx.store.put((inner, "x"), ONE)
    ctx.store.put((outer, "x"), TWO)
    assert heap.opened_by(ctx, module) == []
    assert heap.opened(ctx, module, "x") is BOTTOM
    program.stars.append("inner")
    assert heap.opened_by(ctx, module) == ["inner"]
    assert heap.opened(ctx, module, "x") == ONE
    assert heap.opened(ctx, module, "y") is BOTTOM


def test_an_unknown_index_reads_the_join_of_all_elements(ctx):
    obj = made(ctx, "sequence", "a")
    ctx.store.put((obj, "[0]"), ONE)
    ctx.store.put((obj, "x"), Value(frozenset([9])))
    assert heap.read_any(ctx, obj) == ONE
    ctx.store.put((obj, ANY), TWO)
    assert heap.read_any(ctx, obj) == BOTH


def test_unknown_index_of_a_library_object_reads_a_part(ctx):
    obj = made(ctx, "lib", "a")
    first = obj.sub("[0]")
    assert heap.read_any(ctx, obj).pts == {first, obj.sub("[]")}
    ctx.store.put((obj, ANY), ONE)
    assert heap.read_any(ctx, obj).deps == frozenset()  # the parts have the data of the whole object
    assert reachable_data.deep(ctx, heap.read_any(ctx, obj).pts) == {1}


def test_read_through_a_pointer_includes_the_pointer_data(ctx):
    one, two = made(ctx, "sequence", "a"), made(ctx, "sequence", "b")
    ctx.store.put((one, "x"), ONE)
    ctx.store.put((two, "x"), TWO)
    assert heap.read(ctx, pointer(one), "x") is ONE
    assert heap.read(ctx, pointer(one, frozenset([5])), "x").deps == {1, 5}
    assert heap.read(ctx, Value(pts=frozenset([one, two])), "x").deps == {1, 2}
    assert heap.read(ctx, Value(frozenset([5])), "x") == Value(frozenset([5]))
    assert heap.arrive(ctx, ONE, frozenset()) is ONE
    assert heap.arrive(ctx, ONE, frozenset([5])).deps == {1, 5}


def test_iteration_yields_elements_or_keys(ctx):
    listed, mapping = made(ctx, "sequence", "a"), made(ctx, "mapping", "b")
    ctx.store.put((listed, "[0]"), ONE)
    ctx.store.put((mapping, "['k']"), TWO)
    assert heap.elements(ctx, pointer(listed)).deps == {1}
    assert heap.elements(ctx, pointer(mapping)).deps == frozenset()
    assert heap.keys(ctx, mapping, frozenset()).texts() == ("k",)
    ctx.store.put((mapping, "[1]"), TWO)
    assert heap.keys(ctx, mapping, frozenset()) is UNKNOWN
    ctx.store.put((mapping, KEYS), ONE)
    assert heap.elements(ctx, pointer(mapping)).deps == {1}
    assert heap.keys(ctx, mapping, frozenset([5])).deps == {1, 5}
    assert heap.elements(ctx, ONE) == ONE
    obj = an_instance(ctx, a_class(ctx, "A"))
    ctx.store.put((obj, "inside"), TWO)
    ctx.store.put((obj, ANY), ONE)
    assert heap.elements(ctx, pointer(obj)).deps == {1, 2}


def test_iteration_over_attributes_yields_their_names(ctx):
    obj = an_instance(ctx, a_class(ctx, "A"))
    other = an_instance(ctx, a_class(ctx, "B", external=("Unknown",)), "other")
    ctx.store.put((obj, "speed"), TWO)
    names = heap.attribute_names(ctx, obj)
    assert names == Value(consts=frozenset(["speed"]))
    assert heap.elements(ctx, pointer(obj)) == names
    assert heap.attribute_names(ctx, other) is None
    assert heap.items_are_attributes(obj)
    assert heap.is_namespace(ctx, obj)
    assert not heap.is_namespace(ctx, other)
    ctx.store.put((obj, "*"), ONE)
    assert heap.attribute_names(ctx, obj) is None
    assert not heap.is_namespace(ctx, made(ctx, "mapping", "table"))


@pytest.mark.parametrize(
    ("external", "field"), [((), "x"), (("builtins.dict",), "['x']"), (("Unknown",), "x")]
)
def test_items_of_dunder_dict_are_attributes(ctx, external, field):
    obj = an_instance(ctx, a_class(ctx, "A", external=external))
    assert heap.attribute_of_item(obj, "x") == field
    assert heap.items_are_attributes(obj) is (field == "x")
    assert heap.attribute_of_item(obj, 0) == item_field(0) == "[0]"
    assert heap.attribute_of_item(made(ctx, "mapping", "m"), "x") == "['x']"


# --- stores -------------------------------------------------------------------------------------------


def test_weak_update_keeps_the_former_value(ctx):
    obj = an_instance(ctx, cls := a_class(ctx, "A"))
    ctx.store.put((cls, "x"), ONE)
    updates.weaken(ctx, obj, "x", TWO)
    assert ctx.store.get((obj, "x")) == BOTH


@pytest.mark.parametrize("kind", ["bound", "ext", "method"])
def test_store_into_a_library_function_is_dropped(ctx, kind):
    obj = recency.intern(ctx, kind, "a", "a")
    updates.write_field(ctx, pointer(obj), "x", ONE)
    assert not obj.fields


def test_adding_to_an_object_without_elements_does_nothing(ctx):
    module, listed = recency.intern(ctx, "module", "a"), made(ctx, "sequence", "b")
    updates.add_element(ctx, Value(pts=frozenset([module, listed])), ONE)
    assert not module.fields
    assert heap.read_any(ctx, listed).deps == {1}


def test_negative_index_counts_from_a_known_end(ctx):
    obj = made(ctx, "sequence", "a")
    base = pointer(obj)
    ctx.store.put((obj, "[0]"), ONE)
    ctx.store.put((obj, "[1]"), ONE)
    assert [updates.from_end(ctx, base, key) for key in (-1, -2, -3)] == [1, 0, -3]
    assert updates.from_end(ctx, Value(frozenset([1])), -1) == -1
    updates.write_item(ctx, base, const(-1), TWO)
    assert (ctx.store.get((obj, "[0]")), ctx.store.get((obj, "[1]"))) == (ONE, TWO)
    updates.write_item(ctx, base, const(-3), Value(frozenset([3])))
    assert heap.read_field(ctx, obj, "[0]").deps == {1, 3}


def test_repeated_key_reads_leave_no_reference_cycles(ctx):
    """The garbage collector is paused during an analysis."""
    mapping = made(ctx, "mapping", "b")
    ctx.store.put((mapping, "['again']"), TWO)
    keys = heap.keys(ctx, mapping, frozenset())
    gc.collect()
    assert heap.keys(ctx, mapping, frozenset()) == keys
    assert gc.collect() == 0


def test_mapping_keys_depend_on_the_data_that_chose_them(ctx):
    mapping, listed = made(ctx, "mapping", "a"), made(ctx, "sequence", "b")
    key = Value(frozenset([5]))
    updates.write_item(ctx, Value(pts=frozenset([mapping, listed])), key, ONE)
    assert heap.keys(ctx, mapping, frozenset()).deps == {5}
    assert heap.content(ctx, mapping) == heap.content(ctx, listed) == ONE
    assert KEYS not in listed.fields
    updates.write_item(ctx, pointer(other := made(ctx, "mapping", "c")), const("k"), ONE)
    assert KEYS not in other.fields
    assert ctx.store.get((other, "['k']")) is ONE


def test_store_under_several_possible_keys_changes_only_these(ctx):
    mapping, listed = made(ctx, "mapping", "a"), made(ctx, "sequence", "b")
    for key in "kmn":
        ctx.store.put((mapping, item_field(key)), BOTTOM)
    keys = Value(consts=frozenset(["k", "m"]))
    updates.write_item(ctx, Value(pts=frozenset([mapping, listed])), keys, ONE)
    assert [heap.read_field(ctx, mapping, item_field(key)).deps for key in "kmn"] == [{1}, {1}, set()]
    assert heap.content(ctx, listed) == ONE
    many = Value(consts=frozenset(f"k{n}" for n in range(updates.MAX_KEYS + 1)))
    updates.write_item(ctx, pointer(mapping), many, TWO)
    assert heap.read_field(ctx, mapping, item_field("n")).deps == {2}


# --- joins --------------------------------------------------------------------------------------------


def test_joining_a_single_continuation_leaves_it_unchanged(ctx):
    obj = made(ctx, "sequence", "a")
    delta = {(obj, "x"): ONE}
    assert joins.joined(ctx, [delta]) is delta
    joins.merge(ctx, [delta])
    assert ctx.store.get((obj, "x")) is ONE


def test_field_set_on_one_path_may_have_its_default(ctx, frame):
    obj = an_instance(ctx, cls := a_class(ctx, "A"))
    ctx.store.put((cls, "x"), ONE)
    both = joins.joined(ctx, [{(frame, "v"): TWO, (obj, "x"): TWO}, {}])
    assert both == {(frame, "v"): TWO, (obj, "x"): BOTH}


def test_object_created_on_one_path_has_no_value_elsewhere(ctx):
    obj = recency.intern(ctx, "sequence", "new")
    ctx.store.push()
    ctx.store.put((obj, BORN), BOTTOM)
    ctx.store.put((obj, "[0]"), ONE)
    assert joins.joined(ctx, [ctx.store.pop(), {}])[obj, "[0]"] is ONE


def test_paths_without_a_store_contribute_the_value_once(ctx):
    obj = made(ctx, "sequence", "a")
    ctx.store.put((obj, "x"), ONE)
    assert joins.joined(ctx, [{(obj, "x"): TWO}, {}, {}])[obj, "x"] == BOTH
    assert joins.joined(ctx, [{(obj, "x"): TWO}, {(obj, "x"): TWO}])[obj, "x"] == TWO


@pytest.mark.parametrize(
    ("stored", "blank"), [(0.0, False), (False, False), ("", False), (1.0, True), (None, True)]
)
def test_zero_stored_on_one_path_equals_the_unset_field(ctx, stored, blank):
    message = made(ctx, "lib", "m")
    message.info = BY_CLASS
    both = joins.joined(ctx, [{(message, "x"): const(stored)}, {}])[message, "x"]
    assert bool(both.pts) is blank
    assert joins.joined(ctx, [{(message, "x"): ABSENT}, {}])[message, "x"].pts == {message.sub("x")}


# --- creation, copies ---------------------------------------------------------------------------------


def test_the_same_kind_and_key_give_the_same_object(ctx):
    obj = recency.intern(ctx, "lib", "a", "name")
    assert recency.intern(ctx, "lib", "a") is obj
    assert obj.name == "name"
    assert recency.intern(ctx, "ext", "a") is not obj


def test_each_iteration_and_call_allocates_its_own_object(ctx, frame):
    obj = recency.allocate(ctx, "sequence", frame, "slot")
    assert ctx.store.get((obj, BORN)) is BOTTOM
    ctx.store.put((obj, "[0]"), ONE)
    assert recency.allocate(ctx, "sequence", frame, "slot") is obj
    assert heap.read_any(ctx, obj) is BOTTOM  # a new list is empty
    assert recency.allocate(ctx, "sequence", frame, "other") is not obj
    frame.turn = (1,)
    assert recency.allocate(ctx, "sequence", frame, "slot") is not obj


def test_unreferenced_older_library_object_is_dropped(ctx, frame):
    obj, holder = recency.allocate(ctx, "lib", frame, "slot"), made(ctx, "instance", "holder")
    ctx.store.put((obj, "x"), ONE)
    ctx.store.put((obj, "next"), pointer(obj))
    ctx.store.put((holder, "part"), pointer(obj))
    ctx.store.put((holder, "part"), TWO)
    assert recency.allocate(ctx, "lib", frame, "slot") is obj
    assert ("lib", (obj.key, "older")) not in ctx.objects
    assert ctx.store.get((obj, "x")) in (None, ABSENT)

    ctx.store.put((obj, "x"), TWO)
    ctx.store.put((holder, "part"), pointer(obj))
    assert recency.allocate(ctx, "lib", frame, "slot") is obj
    older = ctx.objects["lib", (obj.key, "older")]
    assert older.many
    assert ctx.store.get((holder, "part")).pts == {older}
    assert ctx.store.get((older, "x")) == TWO
    assert ctx.store.get((obj, "x")) in (None, ABSENT)


def test_copied_fields_include_parts_and_are_joined(ctx):
    one, two = made(ctx, "lib", "a"), made(ctx, "lib", "b")
    ctx.store.put((one, "x"), ONE)
    ctx.store.put((one.sub("pose"), "y"), ONE)
    ctx.store.put((two, "x"), TWO)
    recency.copy_fields(ctx, one, two)
    assert ctx.store.get((two, "x")) == BOTH
    assert ctx.store.get((two.sub("pose"), "y")) is ONE
    assert ctx.store.get((one, "x")) is ONE


def test_clearing_the_fields_of_an_object_clears_its_parts(ctx):
    obj = made(ctx, "lib", "a")
    folded = obj
    for _ in range(MAX_NESTING):
        folded = folded.sub("x")
    ctx.store.put((obj, "y"), ONE)
    ctx.store.put((folded, "y"), ONE)
    folded.subs["x"] = folded  # deep nesting folds into one
    recency.clear_fields(ctx, obj)
    assert ctx.store.get((obj, "y")) is None
    assert ctx.store.get((folded, "y")) is None


# --- reachable ----------------------------------------------------------------------------------------


def test_unreferenced_temporary_objects_are_dropped(ctx, frame):
    names = ("returned", "inside", "held", "bound", "given", "gone")
    objects = {name: recency.allocate(ctx, "lib", frame, name) for name in names}
    bound = recency.intern(ctx, "bound", "method")
    bound.info = ("function", objects["bound"], [{"k": pointer(objects["gone"])}][:0])
    for obj in objects.values():
        ctx.store.put((obj, "x"), ONE)
    ctx.store.put((objects["returned"], "inner"), pointer(objects["inside"]))
    ctx.store.put(
        (module := recency.intern(ctx, "module", "m"), "held"), Value(pts=frozenset([objects["held"], bound]))
    )
    ctx.store.put((frame, "local"), pointer(objects["gone"]))
    given = frozenset([objects["given"]])
    kept = abstract_gc.lasting(ctx.store.since(0), frame, [objects["returned"]], given, ctx.store.reads)
    assert {name for name, obj in objects.items() if (obj, "x") in kept} == set(names) - {"gone"}
    assert (module, "held") in kept
    assert (frame, "local") not in kept
    assert list(ctx.store.reads.facts) == [(given.isdisjoint, frozenset([objects["gone"]]))]
    frame.captured = True
    kept = abstract_gc.lasting(ctx.store.since(0), frame, [], frozenset(), ctx.store.reads)
    assert (objects["gone"], "x") not in kept
    inner = Obj("closure", "inner")
    inner.info = (None, frame)
    kept = abstract_gc.lasting(ctx.store.since(0), frame, [inner], frozenset(), ctx.store.reads)
    assert (objects["gone"], "x") in kept  # the returned closure may read the variable


def test_only_variables_are_dropped_if_no_object_was_created(ctx, frame):
    delta = {(frame, "x"): ONE, (recency.intern(ctx, "module", "m"), "y"): TWO}
    kept = abstract_gc.lasting(delta, frame, [], frozenset(), ctx.store.reads)
    assert [name for _, name in kept] == ["y"]


def test_variables_are_kept_while_ros_may_call_an_inner_function(ctx, frame):
    """A function that is defined two levels deeper keeps the variables of all frames around it."""
    between = Frame("between", 2, frame.function, frame.program, frame.module)
    between.outer = frame
    inner = Obj("closure", "inner")
    inner.info = (None, between)
    frame.captured = True
    delta = {(frame, "x"): ONE}
    assert abstract_gc.lasting(delta, frame, [inner], frozenset(), ctx.store.reads) == delta
    given = abstract_gc.together([inner])
    assert given == {inner, between, frame}
    assert abstract_gc.lasting(delta, frame, [], given, ctx.store.reads) == delta
    assert abstract_gc.lasting(delta, frame, [], frozenset(), ctx.store.reads) == {}


def test_reachable_part_keeps_its_enclosing_object():
    whole, receiver, named, default = (Obj("lib", key) for key in ("a", "b", "c", "d"))
    bound = Obj("bound", "m")
    bound.info = (receiver, [pointer(default)], {"k": named.sub("x")})
    assert abstract_gc.together([whole.sub("x"), bound]) == {whole, bound, receiver, named, default}


@pytest.mark.parametrize("length", [2, 2 * reachable_data.FEW])
def test_cache_of_data_inside_objects_stays_up_to_date(ctx, length):
    chain = [made(ctx, "lib", number) for number in range(length)]
    for outer, inner in itertools.pairwise(chain):
        ctx.store.put((outer, "x"), pointer(inner))
    ctx.store.put((chain[-1], "x"), ONE)
    first = frozenset(chain[:1])
    assert [reachable_data.deep(ctx, first) for _ in range(3)] == [{1}] * 3
    assert bool(ctx.store.insides) is (length > reachable_data.FEW)
    ctx.store.put((chain[-1], "x"), TWO)
    assert reachable_data.deep(ctx, first) == {2}


def test_message_definition_includes_its_parts(ctx):
    message = made(ctx, "message", "m")
    assert object_contents.defined(ctx, message.sub("linear")) == ""
    message.defined = "Twist"
    assert object_contents.defined(ctx, message) == "Twist"
    assert object_contents.defined(ctx, message.sub("linear")) == "Vector3"
    assert object_contents.defined(ctx, message.sub("unknown")) == ""


def test_message_is_replaced_when_all_fields_are(ctx):
    message = made(ctx, "message", "m")
    message.defined, message.info = "Vector3", 7
    for name in "xy":
        ctx.store.put((message, name), ONE)
    assert not object_contents.replaced(ctx, message, "Vector3")
    assert reachable_data.deep(ctx, frozenset([message])) == {1, 7}
    ctx.store.put((message, "z"), ONE)
    assert object_contents.replaced(ctx, message, "Vector3")
    assert reachable_data.deep(ctx, frozenset([message])) == {1}
    assert not object_contents.replaced(ctx, message, "Unknown")
    twist = made(ctx, "message", "t")
    twist.defined = "Twist"
    ctx.store.put((twist, "linear"), ONE)
    for name in "xyz":
        ctx.store.put((twist.sub("angular"), name), TWO)
    assert object_contents.replaced(ctx, twist, "Twist")


# --- names --------------------------------------------------------------------------------------------


def test_states_share_userdata_under_the_names_of_their_remapping(ctx):
    state, other = made(ctx, "lib", "state"), made(ctx, "lib", "other")
    (view,) = userdata.userdata(ctx, state).pts
    userdata.rename(ctx, state, [("mine", "shared")])
    stamp = view.stamp
    userdata.rename(ctx, state, [("mine", "shared")])
    assert view.stamp == stamp == 1
    (shared,) = userdata.userdata(ctx).pts
    assert userdata.seen_through(ctx, view, "mine") == (shared, "shared")
    assert userdata.seen_through(ctx, view, "same") == (shared, "same")
    updates.write_field(ctx, userdata.userdata(ctx, state), "mine", ONE)
    assert heap.read(ctx, userdata.userdata(ctx, other), "shared") is ONE
    assert heap.read(ctx, userdata.userdata(ctx, state), "mine") is ONE


def test_name_with_a_parameter_has_a_placeholder():
    known: list[ParameterName] = []
    (text,) = symbolic_names.text_of_parameter(known, "~scan", const("scan")) or ()
    assert isinstance(text, Symbolic)
    assert known == [ParameterName("~scan", "scan")]
    assert text == f"{MARK}0{MARK}"
    assert symbolic_names.marked(known, ParameterName("other", None)) == f"{MARK}1{MARK}"
    assert symbolic_names.marked(known, ParameterName("~scan", "scan")) == text
    (unset,) = symbolic_names.text_of_parameter(known, "~scan", UNKNOWN) or ()
    assert known[int(unset.strip(MARK))] == ParameterName("~scan", None)


@pytest.mark.parametrize(
    ("known", "name", "default"),
    [
        (None, "~scan", const(1)),
        ([], "~", const("scan")),
        ([], "~scan", const(1)),
        ([], "~scan", pointer(Obj("lib", 1))),
    ],
)
def test_parameter_with_a_non_text_default_has_no_placeholder(known, name, default):
    assert symbolic_names.text_of_parameter(known, name, default) is None


def test_launch_file_may_replace_the_default_of_a_parameter():
    texts = symbolic_names.text_of_parameter(None, "~scan", const("scan"))
    assert texts == symbolic_names.with_default(const("scan"))
    value = Value(consts=texts)
    assert (value.names(), value.replaceable()) == (("scan",), True)
    assert not const("scan").replaceable()
    assert (value.default_keys(), const("scan").default_keys()) == (frozenset(["scan"]), frozenset())
    assert symbolic_names.with_default(const(1)) is None
    assert symbolic_names.with_default(pointer(Obj("lib", 1))) is None


def test_only_an_array_without_data_has_a_known_shape(ctx):
    array, other, table = made(ctx, "lib", "array"), made(ctx, "lib", "other"), made(ctx, "sequence", "table")
    for obj in (array, table):
        ctx.store.put((obj, heap.SHAPE), ONE)
    assert [heap.shape(ctx, obj) for obj in (array, other, table)] == [ONE, None, None]


def test_newest_object_becomes_older_when_another_is_created(ctx, frame):
    holder = made(ctx, "instance", "holder")
    box = recency.intern(ctx, "instance", "box")
    recency.renew(ctx, box, frame)
    ctx.store.put((box, "x"), const(1))
    recency.renew(ctx, box, frame)  # nothing refers to the former one
    assert ctx.store.get((box, "x")) is None
    ctx.store.put((box, "x"), const(2))
    ctx.store.put((holder, "kept"), pointer(box))
    recency.renew(ctx, box, frame)
    kept = ctx.store.get((holder, "kept"))
    (older,) = kept.pts
    assert older is not box
    assert older.many
    assert ctx.store.get((older, "x")) == const(2)
    assert ctx.store.get((box, "x")) is None


def test_object_with_callbacks_represents_all_of_its_site(ctx, frame):
    box = recency.intern(ctx, "instance", "box")
    ctx.given.add(box)
    recency.renew(ctx, box, frame)
    assert not box.many
    ctx.store.put((box, "x"), const(1))
    recency.renew(ctx, box, frame)
    assert box.many
    updates.write_field(ctx, pointer(box), "x", const(2))
    assert ctx.store.get((box, "x")) == Value(consts=frozenset([1, 2]))


def test_entry_points_run_again_when_a_single_object_becomes_several(ctx, frame):
    first, other = Root("first", "callback"), Root("other", "callback")
    box, lib = recency.intern(ctx, "instance", "box"), made(ctx, "lib", "lib")
    ctx.store.root = first
    assert recency.single(ctx, lib)
    assert recency.single(ctx, box)
    recency.renew(ctx, box, frame)
    ctx.store.root = other
    ctx.given.add(box)
    recency.renew(ctx, box, frame)
    assert not recency.single(ctx, box)
    assert first in ctx.pending
    assert other not in ctx.pending
    assert lib not in ctx.shared.certain
    assert ctx.store.reads.single == ctx.shared.several == {box}


def test_try_catches_an_exception_with_a_matching_handler():
    attempt = Attempt(0, [], (frozenset(["KeyError"]), frozenset(["OSError"])))
    assert attempt.catches("OSError", NO_CLASSES) is True
    assert attempt.catches("ValueError", NO_CLASSES) is False
    assert attempt.catches("", NO_CLASSES) is None


def test_handler_gets_only_matching_exceptions():
    attempt = Attempt(0, [], (frozenset(["KeyError"]), frozenset(["OSError"])))
    attempt.raised = {"KeyError": const(1), "OSError": const(2), "": const(3)}
    caught = attempt.caught(frozenset(["KeyError"]), NO_CLASSES)
    assert caught == {"KeyError": const(1), "": const(3)}
