"""The existence of attributes, as in `"x" in vars(obj)`."""

from __future__ import annotations

from tarl_lint.memory import namespaces
from tarl_lint.memory.values import UNKNOWN, Value, const, pointer
from tests.lint.memory.test_heap import a_class, an_instance, made


def test_names_in_other_objects_are_not_attributes(ctx, frame):
    other = an_instance(ctx, a_class(ctx, "B", external=("Unknown",)), "other")
    for holder in (UNKNOWN, pointer(other), pointer(made(ctx, "mapping", "table"))):
        assert namespaces.contains(ctx, holder, const("x"), frame, "slot") is None


def test_the_value_of_an_attribute_does_not_decide_whether_it_exists(ctx, frame):
    obj = an_instance(ctx, a_class(ctx, "A"))
    value = ctx.node(frame, "value", "assign")
    ctx.store.put((obj, "speed"), Value(frozenset([value])))
    for name in (const("speed"), UNKNOWN):
        found = namespaces.contains(ctx, pointer(obj), name, frame, ("slot", name is UNKNOWN))
        assert found is not None
        assert len(found.deps) == 1
        assert value not in found.deps
    assert namespaces.contains(ctx, pointer(obj), const("other"), frame, "slot") == Value()


def test_an_attribute_that_is_never_stored_has_no_node(ctx, frame):
    obj = an_instance(ctx, a_class(ctx, "A"))
    assert namespaces.existence(ctx, [obj], ["speed"], frame, "slot") is None
    ctx.store.put((obj, "speed"), UNKNOWN)
    assert len(namespaces.existence(ctx, [obj], ["speed"], frame, "slot") or ()) == 1
