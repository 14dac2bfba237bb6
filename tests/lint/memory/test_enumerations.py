"""Members of enumerations: which classes have them, and what a member with a sequence as its value shows."""

from __future__ import annotations

import pytest

from tarl_lint.memory import enumerations, heap, recency
from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import ClassKey, Obj, Value, const, pointer
from tests.lint.memory.test_heap import ONE, a_class, made


def sequence(ctx, key: str, *elements: Value) -> Obj:
    obj = made(ctx, "sequence", key)
    for number, element in enumerate(elements):
        ctx.store.put((obj, item_field(number)), element)
    return obj


@pytest.fixture
def channel(ctx):
    """An enumeration with a member of two values, a member that is a number, and a function."""
    cls = a_class(ctx, "Channel", external=("enum.Enum",))
    ctx.store.put((cls, "SCAN"), pointer(sequence(ctx, "scan", const("/scan"), ONE)))
    ctx.store.put((cls, "LEVEL"), const(3))
    ctx.store.put((cls, "_ignored"), pointer(sequence(ctx, "private", const("/private"))))
    made_of = {obj.key[2]: elements for obj, elements in enumerations.mark(ctx, cls)}
    return cls, made_of


@pytest.mark.parametrize(
    ("external", "enumerates"),
    [(("enum.Enum",), True), (("enum.IntFlag",), True), (("builtins.object",), False), ((), False)],
)
def test_a_class_enumerates_if_a_base_is_an_enumeration(ctx, external, enumerates):
    base = a_class(ctx, "Base", external=external)
    assert enumerations.enumerates(base) is enumerates
    assert enumerations.enumerates(a_class(ctx, "Derived", base)) is enumerates


def test_sequences_in_the_class_become_marked_members(ctx, channel):
    cls, made_of = channel
    assert made_of == {"SCAN": [const("/scan"), ONE], "LEVEL": [const(3)]}
    assert ctx.members
    (member,) = ctx.store.get((cls, "SCAN")).pts
    assert enumerations.is_member(member)
    assert ctx.store.get((member, item_field(0))) == const("/scan")
    (level,) = ctx.store.get((cls, "LEVEL")).pts
    assert (level.kind, level.info) == ("instance", cls)
    assert ctx.store.get((level, "value")) == const(3)
    assert ctx.store.get((level, "name")) == const("LEVEL")
    (private,) = ctx.store.get((cls, "_ignored")).pts
    assert not enumerations.is_member(private)


def test_each_enum_member_is_a_separate_mapping_key(ctx, channel):
    cls, _ = channel
    member = ctx.store.get((cls, "SCAN"))
    assert member.item_keys() == frozenset([ClassKey(next(iter(member.pts)).key)])
    assert pointer(sequence(ctx, "other", const("/scan"))).item_keys() is None


def test_enum_member_has_value_name_and_class_attributes(ctx, channel):
    cls, _ = channel
    member = ctx.store.get((cls, "SCAN"))
    (obj,) = member.pts
    assert enumerations.attribute(ctx, member, "value") == pointer(obj)
    assert enumerations.attribute(ctx, member, "name") == const("SCAN")
    ctx.store.put((cls, "shared"), ONE)
    assert enumerations.attribute(ctx, member, "shared") == ONE
    ctx.store.put((obj, "shared"), const(5))  # set by `__init__`
    assert enumerations.attribute(ctx, member, "shared") == const(5)
    assert enumerations.attribute(ctx, member, "absent") == Value()


def test_other_objects_are_not_members_of_an_enumeration(ctx, channel):
    other = recency.intern(ctx, "sequence", "plain")
    assert enumerations.attribute(ctx, pointer(other), "value") is None
    assert not enumerations.is_member(recency.intern(ctx, "mapping", "x", "member of an enumeration"))


@pytest.mark.parametrize(
    ("base", "before", "number"),
    [("Enum", 4, 5), ("Enum", None, 1), ("IntFlag", 4, 8), ("Flag", None, 1), ("StrEnum", None, "low")],
)
def test_auto_gives_the_value_that_follows_the_last_value(ctx, base, before, number):
    cls = a_class(ctx, "Level", external=(f"enum.{base}",))
    if before is not None:
        ctx.store.put((cls, "FIRST"), const(before))
    ctx.store.put((cls, "LOW"), enumerations.automatic(ctx, None))
    made_of = {obj.key[2]: elements for obj, elements in enumerations.mark(ctx, cls)}
    if base == "Enum":
        assert made_of["LOW"] == [const(number)]
    else:
        assert ctx.store.get((cls, "LOW")) == const(number)
        assert made_of == {}


def test_the_members_are_the_public_attributes_with_known_values(ctx, channel):
    cls, _ = channel
    assert [name for name, _ in enumerations.members(ctx, cls)] == ["SCAN", "LEVEL"]
    assert enumerations.members(ctx, a_class(ctx, "Other")) is None
    ctx.store.put((cls, "UNKNOWN"), ONE)  # after the members were marked
    assert enumerations.members(ctx, cls) is None


def test_constant_selects_the_enum_member_of_its_value(ctx, channel):
    cls, _ = channel
    assert enumerations.with_value(ctx, cls, const(3)) == ctx.store.get((cls, "LEVEL"))
    assert enumerations.with_value(ctx, cls, const(4)) is None
    assert enumerations.with_value(ctx, cls, ONE) is None


def test_enum_maps_names_to_members(ctx, channel):
    cls, _ = channel
    (table,) = enumerations.by_name(ctx, pointer(cls)).pts
    assert ctx.store.get((table, item_field("LEVEL"))) == ctx.store.get((cls, "LEVEL"))
    assert enumerations.by_name(ctx, pointer(table)) is None


def test_base_initialiser_is_bound_to_the_enum_member(ctx):
    base = a_class(ctx, "Named", external=("enum.Enum",))
    cls = a_class(ctx, "Level", base)
    member = made(ctx, "instance", "low")
    assert heap.through_class(ctx, member, cls, "__init__") is None
    function = made(ctx, "closure", "init")
    ctx.store.put((base, "__init__"), pointer(function))
    (bound,) = heap.through_class(ctx, member, cls, "__init__").pts
    assert bound.info[:2] == (function, member)
