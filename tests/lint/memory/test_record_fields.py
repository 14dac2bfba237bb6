"""Fields of dataclasses and named tuples, with the options of `field(...)` and of the decorator."""

from __future__ import annotations

import ast
from textwrap import dedent

import pytest

from tarl_lint.ir.lower_statements import lower_module
from tarl_lint.memory import recency, record_fields
from tarl_lint.memory.values import ClassInfo, const, pointer
from tarl_lint.read.source import Module

BASE = """
    @dataclass
    class Base:
        a: float
        b: float = FIELD
        c: ClassVar[int] = 0
"""


def lowered(text):
    text = dedent(text)
    program = lower_module(Module("node.py", "node", text, ast.parse(text)))
    return program.function.body[0]


def a_class(ctx, text, *bases, external=(), **options):
    """Return the class that a text defines; `options` are those of a field's call of `field(...)`, by its name."""
    statement = lowered(text)
    cls = recency.intern(ctx, "class", statement.name, statement.name)
    cls.info = ClassInfo(
        statement.name, statement.name, list(bases), list(external), statement, fields=statement.fields
    )
    for name, given in options.items():
        spec = recency.intern(ctx, "field", (statement.name, name))
        spec.describe(given)
        ctx.store.put((cls, name), pointer(spec))
    return cls


def names(cls):
    return [name for _, name in record_fields.fields(cls)]


def test_fields_are_in_the_order_of_the_constructor(ctx):
    base = a_class(ctx, BASE)
    derived = a_class(ctx, "@dataclass\nclass Derived(Base):\n    d: float\n    a: float = 1.0", base)
    assert names(derived) == ["a", "b", "d"]
    assert next(record_fields.fields(derived)) == (derived, "a")


def test_annotations_without_a_decorator_are_no_fields(ctx):
    assert names(a_class(ctx, "class Plain:\n    a: float")) == []
    made = a_class(ctx, "class Made(NamedTuple):\n    a: float", external=["typing.NamedTuple"])
    assert names(made) == ["a"]
    assert record_fields.is_named_tuple(made)
    assert not record_fields.is_named_tuple(a_class(ctx, BASE))


@pytest.mark.parametrize(
    ("option", "positional"),
    [
        ({"init": const(value=False)}, ["a"]),
        ({"kw_only": const(value=True)}, ["a"]),
        ({"kw_only": const(value=False)}, ["a", "b"]),
        ({"default": const(1.0)}, ["a", "b"]),
    ],
)
def test_fields_that_the_constructor_takes_by_position(ctx, option, positional):
    cls = a_class(ctx, BASE, b=option)
    assert record_fields.options(ctx, cls, "b") == option
    assert record_fields.options(ctx, cls, "a") is None
    assert record_fields.positional(ctx, cls) == positional


def test_fields_passed_by_name_only(ctx):
    below = a_class(ctx, "@dataclass\nclass Below:\n    a: int\n    _: KW_ONLY\n    b: int")
    assert record_fields.positional(ctx, below) == ["a"]
    text = "@dataclass(kw_only=True)\nclass Named:\n    a: int\n    b: int"
    named = a_class(ctx, text, b={"kw_only": const(value=False)})
    assert record_fields.positional(ctx, named) == ["b"]
    assert record_fields.only_named(named, "a", None)
    assert not record_fields.only_named(named, "b", {"kw_only": const(value=False)})


def test_compared_fields(ctx):
    cls = a_class(ctx, BASE, b={"compare": const(value=False)})
    assert record_fields.says(record_fields.options(ctx, cls, "b"), "compare", False)
    assert record_fields.compared(ctx, cls) == ["a"]
    assert not record_fields.compared_by_identity(cls)


def test_instances_without_equality_are_compared_by_identity(ctx):
    plain = a_class(ctx, "class Plain:\n    pass")
    assert record_fields.compared(ctx, plain) is None
    assert record_fields.compared_by_identity(plain)
    assert record_fields.compared_by_identity(a_class(ctx, "@dataclass(eq=False)\nclass Own:\n    a: int"))


def test_fields_with_init_var_are_handed_on(ctx):
    text = """
        @dataclass
        class Base:
            a: float
            b: InitVar[float]
            c: "dataclasses.InitVar[int]" = 0
    """
    assert record_fields.handed_on(a_class(ctx, text)) == {"b", "c"}
    assert record_fields.handed_on(recency.intern(ctx, "class", "other", "other")) == frozenset()
