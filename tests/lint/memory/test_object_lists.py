"""Lists of objects of analysed classes: their order is known as long as each object is appended once."""

from __future__ import annotations

import pytest

from tarl_lint.memory.heap import item_field
from tarl_lint.memory.values import Obj, Value, const, pointer
from tarl_lint.models import object_lists
from tests.lint.memory.test_heap import ONE, a_class, made


def an_object(ctx, key: str) -> Value:
    obj = made(ctx, "instance", key)
    obj.info = a_class(ctx, "Part")
    return pointer(obj)


def a_list(ctx, *elements: Value) -> Value:
    obj = made(ctx, "sequence", "list")
    for number, element in enumerate(elements):
        ctx.store.put((obj, item_field(number)), element)
    return pointer(obj)


def test_an_object_is_appended_after_the_known_elements(ctx):
    first, second, third = (an_object(ctx, key) for key in "abc")
    listed = a_list(ctx, first)
    assert object_lists.place(ctx, listed, [second, third]) == 1
    object_lists.appended(ctx, listed, 1, [second, third])
    (obj,) = listed.pts
    assert [ctx.store.get((obj, item_field(number))) for number in range(3)] == [first, second, third]
    assert object_lists.place(ctx, listed, [second]) is None, "it is in the list"


@pytest.mark.parametrize(
    "news",
    [
        lambda ctx: [],
        lambda ctx: [const(1)],
        lambda ctx: [ONE],
        lambda ctx: [pointer(made(ctx, "lib", "x"))],
        lambda ctx: [Value(pts=an_object(ctx, "x").pts | an_object(ctx, "y").pts)],
    ],
    ids=["nothing", "a number", "data", "an object of a library", "one of two objects"],
)
def test_values_of_other_types_have_no_known_index(ctx, news):
    assert object_lists.place(ctx, a_list(ctx, an_object(ctx, "a")), news(ctx)) is None


def test_objects_that_contain_data_have_no_known_index(ctx):
    laden = an_object(ctx, "x")
    next(iter(laden.pts)).laden = True
    assert object_lists.place(ctx, a_list(ctx), [laden]) is None


def test_other_elements_in_the_list_make_the_index_unknown(ctx):
    assert object_lists.place(ctx, a_list(ctx, const("text")), [an_object(ctx, "a")]) is None


def test_empty_lists_are_ignored_if_there_are_other_lists(ctx):
    full = a_list(ctx, an_object(ctx, "a"))
    empty = pointer(Obj("sequence", "empty"))
    both = Value(pts=full.pts | empty.pts)
    assert object_lists.without_empty(ctx, both) == full
    assert object_lists.without_empty(ctx, empty) is empty
    mixed = Value(pts=full.pts | {made(ctx, "lib", "x")})
    assert object_lists.without_empty(ctx, mixed) is mixed


def test_elements_can_be_objects_numbers_or_tuples(ctx):
    part = an_object(ctx, "a")
    pair = a_list(ctx, const(0), part)
    assert object_lists.asked(ctx, [part, const(1), pair])
    assert not object_lists.asked(ctx, [part, ONE])
    assert not object_lists.asked(ctx, [const("left"), const("right")])
    assert not object_lists.asked(ctx, [a_list(ctx, ONE, part)])
