"""Values and abstract objects, without a state."""

from __future__ import annotations

import pytest

from tarl_lint.memory.values import (
    BOTTOM,
    DATA,
    MAX_CELLS,
    MAX_CONSTS,
    MAX_DEPTH,
    MAX_TEXTS,
    UNKNOWN,
    ClassInfo,
    ClassKey,
    Obj,
    Symbolic,
    Value,
    certain_pointer,
    closure_of,
    const,
    function_of,
    in_order,
    inherited_from,
    join,
    join_all,
    join_consts,
    lineage,
    pointer,
)


def constants(*given: object) -> Value:
    return Value(consts=frozenset(given))


def made_class(name: str, *bases: Obj, external: tuple[str, ...] = ()) -> Obj:
    cls = Obj("class", name, name)
    cls.info = ClassInfo(name, name, list(bases), list(external))
    return cls


def instance(cls: Obj) -> Obj:
    obj = Obj("instance", cls.key)
    obj.info = cls
    return obj


# --- values -------------------------------------------------------------------------------------------


def test_join_has_nodes_objects_and_constants_of_both():
    one, two = Obj("lib", 1), Obj("lib", 2)
    both = join(
        Value(frozenset([1]), frozenset([one]), frozenset(["a"])),
        Value(frozenset([2]), frozenset([two]), frozenset(["b"])),
    )
    assert both == Value(frozenset([1, 2]), frozenset([one, two]), frozenset(["a", "b"]))


def test_joining_with_bottom_changes_nothing():
    value = constants(1)
    assert join(value, BOTTOM) is value
    assert join(BOTTOM, value) is value
    assert join(value, UNKNOWN).consts is None
    assert join_all([]) is BOTTOM
    assert join_all([constants(1), constants(2), constants(1)]) == constants(1, 2)


@pytest.mark.parametrize(
    "change", [{"deps": frozenset([9])}, {"pts": frozenset([Obj("lib", 0)])}, {"consts": None}]
)
def test_equal_values_have_equal_nodes_objects_and_constants(change):
    parts = {"deps": frozenset([1]), "pts": frozenset(), "consts": frozenset([1])}
    assert Value(**parts) == Value(**parts)
    assert Value(**parts) != Value(**{**parts, **change})
    assert join(Value(**parts), Value(**{**parts, **change})) != Value(**parts)


def test_value_may_have_more_strings_than_other_constants():
    few, many = frozenset(range(MAX_CONSTS)), frozenset(map(str, range(MAX_TEXTS)))
    assert join_consts(few, frozenset([0])) is few
    assert join_consts(few, frozenset([MAX_CONSTS])) is None
    assert join_consts(frozenset(list(many)[1:]), many) == many
    assert join_consts(many, frozenset(["one more"])) is None
    assert join_consts(many, frozenset([1])) is None
    assert join_consts(None, few) is None
    assert join_consts(few, None) is None


def test_value_with_one_constant_and_no_objects_is_constant():
    assert const(3).constant() == (True, 3)
    assert constants(1, 2).constant() == (False, None)
    assert UNKNOWN.constant() == (False, None)
    assert Value(pts=frozenset([Obj("lib", 1)]), consts=frozenset([1])).constant() == (False, None)
    assert constants(Symbolic("~scan")).constant() == (False, None)
    assert const(3).fixed()
    assert not constants(1, 2).fixed()
    assert const([]) is UNKNOWN


def test_value_that_depends_on_the_launch_file_has_no_known_strings():
    assert constants("b", "a").texts() == ("a", "b")
    assert constants("a", 1).texts() == ()
    assert UNKNOWN.texts() == ()
    symbolic = constants("a", Symbolic("~scan"))
    assert symbolic.texts() == ()
    assert symbolic.names() == ("a", "~scan")
    assert symbolic.keys() is None
    assert constants("a", 1).keys() == {"a", 1}
    assert constants("a", 1).names() == ()


def test_constants_and_classes_are_keys_of_mappings():
    first, second = made_class("First"), made_class("Second")
    assert constants("a", 1).item_keys() == {"a", 1}
    assert pointer(first).item_keys() == {ClassKey("First")}
    assert Value(pts=frozenset([first, second])).item_keys() == {ClassKey("First"), ClassKey("Second")}
    assert Value(pts=frozenset([first, Obj("instance", 1)])).item_keys() is None


def test_constants_of_one_value_can_be_a_subset_of_another():
    assert constants(1).consts_in(constants(1, 2))
    assert constants(1).consts_in(UNKNOWN)
    assert not constants(1, 3).consts_in(constants(1, 2))
    assert not UNKNOWN.consts_in(constants(1))


def test_objects_are_iterated_in_order_of_creation():
    objects = [Obj("lib", key) for key in range(20)]
    assert in_order(frozenset(objects)) == objects
    assert Value(pts=frozenset(objects)).objects == objects
    assert pointer(objects[0]).keys() is None
    assert certain_pointer(objects[0]).keys() == frozenset()
    assert certain_pointer(objects[0]).pts == {objects[0]}
    assert pointer(objects[0], frozenset([4])) == Value(frozenset([4]), frozenset([objects[0]]))


# --- objects ------------------------------------------------------------------------------------------


def test_embedded_object_has_an_access_path():
    message = Obj("message", "m")
    part = message.sub("pose").sub("x")
    assert part is message.sub("pose").sub("x")
    assert part.path() == "pose.x"
    assert message.path() == ""
    assert part.whole is message
    assert message.whole is message
    assert part.laden


def test_parts_beyond_the_maximum_depth_share_one_object():
    deep = Obj("lib", "a")
    for _ in range(MAX_DEPTH):
        assert deep.sub("x") is not deep
        deep = deep.sub("x")
    assert deep.sub("x") is deep
    nested = Obj("lib", "b").sub("[0]").sub("[0]")
    assert nested.sub("[0]") is nested
    assert nested.sub("x") is not nested


def test_matrix_has_a_bounded_number_of_tracked_elements():
    row = Obj("lib", "matrix").sub("[0]")
    cells = [row.sub(f"[{n}]") for n in range(MAX_CELLS + 1)]
    assert len(set(cells)) == MAX_CELLS + 1
    assert cells[-1] is row
    assert row.sub("[0]") is cells[0]
    listed = Obj("sequence", "rows").sub("[0]")
    assert len({listed.sub(f"[{n}]") for n in range(MAX_CELLS + 1)} - {listed}) == MAX_CELLS + 1


def test_an_object_records_its_changes_in_order():
    obj = Obj("lib", "a")
    obj.changed("x")
    obj.changed(DATA)
    part = obj.sub("y")
    obj.describe("meaning")
    obj.describe("meaning")
    assert obj.info == "meaning"
    assert obj.changes == ["x", DATA, part, None]
    assert obj.stamp == 4


def test_a_released_object_has_no_references_to_other_objects():
    obj, other = Obj("lib", "a"), Obj("lib", "b")
    part = obj.sub("x")
    part.info, obj.info = other, other
    obj.fields["x"], obj.holders[other, "x"], obj.inside[other] = frozenset([other]), None, None
    obj.release()
    assert (obj.subs, obj.fields, obj.holders, obj.inside, obj.changes) == ({}, {}, {}, {}, [])
    assert obj.info is None
    assert part.info is None


# --- classes ------------------------------------------------------------------------------------------


def test_method_resolution_lists_a_shared_base_last():
    base = made_class("base")
    left, right = made_class("left", base), made_class("right", base)
    assert lineage(made_class("both", left, right))[1:] == [left, right, base]
    assert lineage(base) == [base]
    unknown = Obj("class", "unknown")
    assert lineage(unknown) == [unknown]
    assert lineage(inner := made_class("inner", unknown, base)) == [inner, unknown, base]


def test_the_method_resolution_order_has_a_bounded_length():
    cls = made_class("0")
    for number in range(1, 80):
        cls = made_class(str(number), cls)
    assert len(lineage(cls)) == 50


@pytest.mark.parametrize(
    ("external", "opaque"),
    [((), False), (("builtins.Exception",), False), (("abc.ABC",), False), (("rclpy.node.Node",), True)],
)
def test_class_with_an_unknown_base_is_opaque(external, opaque):
    cls = made_class("base", external=external)
    inner = made_class("inner", made_class("between", cls))
    assert cls.info.opaque is opaque
    assert inner.info.opaque is opaque
    assert inherited_from(pointer(instance(inner))) == (set(external) if opaque else set())
    assert inherited_from(pointer(cls)) == set()


def test_an_unqualified_base_defines_no_methods():
    assert inherited_from(pointer(instance(made_class("a", external=("Unknown",))))) == set()


def test_a_bound_method_has_the_function_of_its_closure(ctx):
    (program,) = ctx.programs.values()
    closure, bound = Obj("closure", "f"), Obj("bound", "f")
    closure.info = (program.function, None, program, None)
    bound.info = (closure, Obj("instance", "self"), None)
    assert closure_of(bound) is closure_of(closure) is closure
    assert function_of(closure) is program.function
    assert function_of(bound) is program.function
    assert function_of(Obj("closure", "unknown")) is None
    assert function_of(Obj("ext", "library")) is None
