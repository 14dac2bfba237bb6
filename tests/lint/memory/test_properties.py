"""Functions and properties, seen through their class."""

from __future__ import annotations

import dataclasses

from tarl_lint.ir import nodes as ir
from tarl_lint.memory import properties, recency
from tarl_lint.memory.values import BOTTOM, pointer

POS = (1, 0, 1, 1)


def function(ctx, frame, *decorators):
    obj = recency.intern(ctx, "closure", decorators, "speed")
    made = dataclasses.replace(frame.function, decorators=decorators)
    owner = recency.intern(ctx, "class", "Motor", "Motor")
    obj.info = (made, None, frame.program, owner)
    return obj, owner


def test_the_parts_of_a_property_are_its_getter_and_setter(ctx, frame):
    getter, owner = function(ctx, frame, ir.Name("property", "global", 0, POS))
    assert properties.is_property(getter.info[0])
    assert properties.part(ctx, getter, "fget") == properties.part(ctx, getter, "__get__") == pointer(getter)
    assert properties.part(ctx, getter, "fset") is BOTTOM
    ctx.store.put((owner, "speed.setter"), pointer(owner))
    assert properties.part(ctx, getter, "__set__") == pointer(owner)


def test_a_method_has_no_getter(ctx, frame):
    method, _ = function(ctx, frame)
    assert not properties.is_property(method.info[0])
    assert properties.part(ctx, method, "__get__") is None
