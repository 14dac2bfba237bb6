"""Instances that a library finds by their class."""

from __future__ import annotations

import pytest

from tarl_lint.memory.library_instances import looked_up, note
from tarl_lint.memory.values import BOTTOM, Obj, Value, pointer
from tests.lint.memory.test_values import instance, made_class


def instances(value: Value) -> set[Obj]:
    return {one for one in value.objects if one.kind == "instance"}


@pytest.fixture
def program(ctx):
    """An interpreter whose program made an object of a class and one of its subclass."""
    base = made_class("Base")
    view = made_class("View", base)
    made = {"base": instance(base), "view": instance(view)}
    for obj in made.values():
        ctx.objects[obj.key] = obj
    return ctx, base, view, made


def test_instance_query_returns_instances_of_subclasses(program):
    ctx, base, view, made = program
    assert instances(looked_up(ctx, "query_one", [pointer(view)])) == {made["view"]}
    assert instances(looked_up(ctx, "get_component", [pointer(base)])) == {made["base"], made["view"]}


@pytest.mark.parametrize("name", ["push_screen", "gets", "query2"])
def test_methods_that_are_not_queries_return_no_instances(program, name):
    ctx, _, view, _ = program
    assert looked_up(ctx, name, [pointer(view)]) == BOTTOM
    assert ctx.looked_up == set()


def test_an_instance_made_after_the_query_is_also_found(program):
    ctx, base, view, made = program
    looked_up(ctx, "find", [pointer(base)])
    late = Obj("instance", "late")
    late.info = view
    note(ctx, late, view)
    assert instances(looked_up(ctx, "find", [pointer(base)])) == {*made.values(), late}


def test_instances_are_recorded_only_for_queried_classes(program):
    ctx, _base, view, made = program
    note(ctx, Obj("instance", "unasked"), view)
    assert instances(looked_up(ctx, "find", [pointer(view)])) == {made["view"]}
