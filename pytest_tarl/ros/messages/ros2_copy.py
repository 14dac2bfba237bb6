"""Generate the function that copies a ROS 2 message; nested messages are inline for speed."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable
from typing import Any

from pytest_tarl.ros.messages import field_values
from pytest_tarl.ros.messages.field_values import CODES
from pytest_tarl.ros.messages.type_definitions import Field

Nested = Callable[[str], type[Any]]
Scope = dict[str, Any]


def copy_function(fields: Iterable[Field], nested: Nested, scope: Scope) -> list[str]:
    """Return the source of `copy(m)`; put its globals into `scope`, to which the caller adds `cls`."""
    return [
        "def copy(m):",
        "    n = new(cls)",
        *_assignments(fields, nested, scope, "m", "n"),
        "    return n",
    ]


def _assignments(
    fields: Iterable[Field], nested: Nested, scope: Scope, source: str, target: str
) -> list[str]:
    lines = []
    for field in fields:
        slot = f"_{field.name}"
        if field.shape == "one" and not field.primitive:
            lines += _inlined(field, nested, scope, f"{source}.{slot}", f"{target}.{slot}")
        elif field.shape == "one" and field.base != "float32":
            lines.append(f"    {target}.{slot} = {source}.{slot}")
        else:
            copier = _named(scope, _copier(field, nested))
            lines.append(f"    {target}.{slot} = {copier}({source}.{slot})")
    return lines


def _inlined(field: Field, nested: Nested, scope: Scope, source: str, target: str) -> list[str]:
    made = nested(field.base)
    if not hasattr(made, "_tarl_fields"):
        return [f"    {target} = {_named(scope, made._tarl_copy)}({source})"]
    inner_source, inner_target = (f"{letter}{len(scope)}" for letter in "st")
    begin = [f"    {inner_source} = {source}", f"    {target} = {inner_target} = new({_named(scope, made)})"]
    return [*begin, *_assignments(made._tarl_fields, nested, scope, inner_source, inner_target)]


def _named(scope: Scope, value: Any) -> str:
    name = f"part{len(scope)}"
    scope[name] = value
    return name


def _copier(field: Field, nested: Nested) -> Callable[[Any], Any]:
    if not field.primitive:
        element = nested(field.base)._tarl_copy
        return lambda value: [element(item) for item in value]
    # a single value is sent unchanged, except that float32 is rounded
    if field.shape == "one":
        return lambda value: field_values.as_float32(value, field.name)
    if field.base in CODES and field.base != "byte":
        return (
            operator.itemgetter(slice(None)) if field.shape == "sequence" else operator.methodcaller("copy")
        )
    return list
