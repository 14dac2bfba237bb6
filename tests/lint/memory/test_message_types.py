"""The types of messages and the names of their fields."""

from __future__ import annotations

import dataclasses

import pytest

from tarl_lint.memory import message_types, recency, updates
from tarl_lint.memory.heap import MEMBERS
from tarl_lint.memory.values import UNKNOWN, Obj, Value, const, pointer


@pytest.fixture
def path() -> Obj:
    made = Obj("message", "path")
    made.defined = "Path"
    return made


def elements(ctx, value: Value) -> list[Value | None]:
    (listed,) = value.pts
    return [ctx.store.get((listed, f"[{number}]")) for number in range(3)]


def test_a_part_of_a_message_has_the_type_of_its_definition(ctx, path):
    stamped = path.sub("poses").sub("[0]")
    assert message_types.type_of(ctx, stamped) == "PoseStamped"
    assert message_types.type_of(ctx, stamped.sub("pose").sub("position")) == "Point"
    assert message_types.type_of(ctx, stamped.sub("pose").sub("position").sub("x")) == ""
    assert message_types.type_of(ctx, path.sub("other").sub("[0]")) == ""


def test_a_message_that_the_program_makes_has_the_type_of_its_class(ctx, frame):
    made = recency.allocate(ctx, "lib", frame, "made")
    assert message_types.type_of(ctx, made) == ""
    made.name = "geometry_msgs.msg.Vector3"
    assert message_types.type_of(ctx, made) == "Vector3"
    assert message_types.field_names(ctx, made) == ("x", "y", "z")


def test_a_description_has_one_element_for_each_field(ctx, path):
    point = path.sub("poses").sub("[0]").sub("pose").sub("position")
    slots = message_types.description(ctx, point, "__slots__", MEMBERS)
    assert elements(ctx, slots) == [const("x"), const("y"), const("z")]
    assert next(iter(slots.pts)).name == MEMBERS
    assert elements(ctx, message_types.description(ctx, point, "_slot_types", MEMBERS)) == [UNKNOWN] * 3


def test_the_names_of_an_unknown_type_are_not_known(ctx):
    slots = message_types.description(ctx, Obj("message", "other"), "__slots__", MEMBERS)
    (listed,) = slots.pts
    assert elements(ctx, slots) == [None] * 3
    assert ctx.store.get((listed, "*")) == UNKNOWN
    assert listed.name == ""


def test_names_of_ros_2_begin_with_an_underscore(ctx, frame, path):
    assert not message_types.of_ros2(ctx)
    ctx.stack.append(frame)
    assert not message_types.of_ros2(ctx)
    module = ctx.modules[frame.program.path]
    ctx.modules[module.path] = dataclasses.replace(module, text="import rclpy\n")
    assert message_types.of_ros2(ctx)
    slots = message_types.description(ctx, path, "__slots__", MEMBERS)
    assert elements(ctx, slots)[:2] == [const("_header"), const("_poses")]


def test_a_name_with_an_underscore_stands_for_a_field(ctx, path):
    assert message_types.field(ctx, pointer(path), "_poses") == "poses"
    assert message_types.field(ctx, pointer(path), "poses") == "poses"
    assert message_types.field(ctx, pointer(path), "_other") == "_other"
    assert message_types.field(ctx, pointer(Obj("instance", "own")), "_poses") == "_poses"


def test_a_store_into_one_of_several_fields_keeps_the_former_value(ctx, frame):
    obj = recency.allocate(ctx, "lib", frame, "made")
    updates.write_field(ctx, pointer(obj), "x", const(1))
    updates.weaken_field(ctx, pointer(obj), "x", const(2))
    assert ctx.store.get((obj, "x")) == Value(consts=frozenset([1, 2]))


@pytest.mark.parametrize(
    ("defined", "parts", "number", "whole"),
    [
        ("Float64", ("data",), True, False),
        ("Int32", ("data",), True, True),
        ("String", ("data",), False, False),
        ("Twist", ("linear", "x"), True, False),
        ("Twist", ("linear",), False, False),
        ("LaserScan", ("ranges", "[0]"), True, False),
        ("JointState", ("name", "[0]"), False, False),
        ("", ("data",), False, False),
    ],
)
def test_numeric_fields_of_known_messages_are_numbers(ctx, defined, parts, number, whole):
    part = made = Obj("message", "got")
    made.defined = defined
    for name in parts:
        part = part.sub(name)
    assert message_types.is_number(ctx, pointer(part), whole=False) is number
    assert message_types.is_number(ctx, pointer(part), whole=True) is whole
    assert not message_types.is_number(ctx, UNKNOWN, whole=False)
