"""rosidl_runtime_py.convert: messages as dictionaries, YAML and comma-separated values.

`truncate_length` cuts sequences and strings off after this many elements. `no_arr` and `no_str` show the type and
length of arrays and strings instead of their content.
"""

from __future__ import annotations

import array
import re
import sys
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from pytest_tarl.ros.missing import unsupported_module

__all__ = ["get_message_slot_types", "message_to_csv", "message_to_ordereddict", "message_to_yaml"]


_SEQUENCE = re.compile(r"sequence<(?P<element>.+?)(, *(?P<bound>\d+))?>$")
_ARRAY = re.compile(r"(?P<element>.+)\[(?P<size>\d+)\]$")


@dataclass(frozen=True)
class _Style:
    truncate_length: int | None = None
    no_arr: bool = False
    no_str: bool = False

    def cuts(self, length: int) -> bool:
        return self.truncate_length is not None and length > self.truncate_length


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Return a message as YAML. Raise UnsupportedModuleError if PyYAML is not installed."""
    try:
        import yaml
    except ModuleNotFoundError as error:
        raise unsupported_module("yaml") from error
    plain = _plain(_fields(msg, _Style(truncate_length, no_arr, no_str)))
    text: str = yaml.safe_dump(
        plain, allow_unicode=True, sort_keys=False, width=sys.maxsize, default_flow_style=flow_style
    )
    return text


def message_to_csv(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> str:
    """Return the values of a message, and of the messages in it, separated by commas."""
    fields = _fields(msg, _Style(truncate_length, no_arr, no_str))
    return ",".join(str(value) for value in _leaves(fields))


def message_to_ordereddict(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> OrderedDict[str, Any]:
    """Return the fields of a message in order; nested messages become dictionaries, arrays become lists."""
    return _fields(msg, _Style(truncate_length, no_arr, no_str))


def get_message_slot_types(msg: Any) -> OrderedDict[str, Any]:
    """Return the type of each field."""
    return OrderedDict(msg.get_fields_and_field_types())


def _fields(msg: Any, style: _Style) -> OrderedDict[str, Any]:
    types = msg.get_fields_and_field_types()
    return OrderedDict((name, _value(getattr(msg, name), style, types[name])) for name in types)


def _value(value: Any, style: _Style, kind: str = "") -> Any:
    if isinstance(value, bytes):
        shown = "".join(map(chr, value[: style.truncate_length]))
        return f"{shown}..." if style.cuts(len(value)) else shown
    if isinstance(value, str):
        if style.no_str:
            return f"<string length: <{len(value)}>>"
        return f"{value[: style.truncate_length]}..." if style.cuts(len(value)) else value
    if isinstance(value, (list, tuple, array.array, np.ndarray)):
        return _elements(value, style, kind)
    if isinstance(value, np.generic):
        return value.item()
    return value if isinstance(value, (bool, int, float)) else _fields(value, style)


def _elements(values: Any, style: _Style, kind: str) -> Any:
    if style.no_arr and kind:
        return _described(len(values), kind)
    made = [_value(one, style) for one in values[: style.truncate_length]]
    made += ["..."] if style.cuts(len(values)) else []
    return tuple(made) if isinstance(values, tuple) else made


def _described(length: int, kind: str) -> str:
    """Return the type and length of an array, shown instead of its elements."""
    if fixed := _ARRAY.match(kind):
        return f"<array type: {fixed['element']}[{fixed['size']}]>"
    sequence = _SEQUENCE.match(kind)
    element = sequence["element"] if sequence else kind
    bound = f", bound: {sequence['bound']}" if sequence and sequence["bound"] else ""
    return f"<sequence type: {element}{bound}, length: {length}>"


def _leaves(value: Any) -> Iterator[Any]:
    if isinstance(value, OrderedDict):
        value = list(value.values())
    if isinstance(value, (list, tuple)):
        for one in value:
            yield from _leaves(one)
    else:
        yield value


def _plain(value: Any) -> Any:
    """Return only dictionaries and lists, which YAML writes without tags."""
    if isinstance(value, OrderedDict):
        return {name: _plain(one) for name, one in value.items()}
    return [_plain(one) for one in value] if isinstance(value, (list, tuple)) else value
