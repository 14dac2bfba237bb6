"""Functions that inspect objects and classes of an interpreted file: `getattr`, `vars`, `dataclasses.asdict`."""

from __future__ import annotations

import ast
import dataclasses
import functools
from collections.abc import Callable
from typing import Any, Final

from tarl_lint.workspace.python.assignment_targets import set_attribute
from tarl_lint.workspace.python.classes import AUTO, as_mapping, as_values, field_names, replaced
from tarl_lint.workspace.python.elements import listed
from tarl_lint.workspace.python.evaluation import call_of
from tarl_lint.workspace.python.evaluator import Evaluator
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.objects import Class, Function
from tarl_lint.workspace.python.values import Library, OpaqueError, Partial, Unknown

_WITH_KNOWN_ATTRIBUTES: Final = (Made, Class, str, int, float, list, dict, type(None))


def reflection(run: Evaluator) -> dict[str, Any]:
    """Return models of the functions that inspect attributes, by full name."""
    attribute = functools.partial(_attribute, run)
    return {
        "builtins.getattr": attribute, "builtins.hasattr": functools.partial(_has, run), "builtins.vars": _variables,
        "builtins.setattr": lambda of, name, value: set_attribute(run, of, name, value),
        **{f"builtins.{kind}": functools.partial(_descriptor, kind) for kind in
           ("property", "classmethod", "staticmethod")},
        "operator.attrgetter": lambda *names: _several(attribute, names),
        "operator.itemgetter": lambda *keys: _several(_element, keys),
        "operator.methodcaller": lambda name, *args, **keywords: Partial(
            lambda of: run.call(attribute(of, name), list(args), keywords, call_of("a method", 0))),
        "operator.getitem": _element, "operator.contains": lambda many, one: one in listed(many),
        "dataclasses.asdict": as_mapping, "dataclasses.astuple": as_values, "dataclasses.replace": replaced,
        "dataclasses.fields": field_names, "dataclasses.is_dataclass": _is_data, "enum.auto": lambda: AUTO,
        "functools.wraps": lambda of, **_: Partial(functools.partial(_wrapped, of)),
        "functools.lru_cache": _cached, "functools.cache": Partial(lambda made: made),
        "enum.unique": Partial(lambda made: made),
        **{f"functools.{name}": Partial(lambda *_: Unknown(0, "a function for several types"))
           for name in ("singledispatch", "singledispatchmethod")},
    }  # fmt: skip


def _attribute(run: Evaluator, of: Any, name: Any, *default: Any) -> Any:
    """Return the result of `getattr`. Raises OpaqueError if the value of the attribute is not known."""
    if not isinstance(name, str) or isinstance(of, Unknown):
        raise OpaqueError("an unknown attribute")
    found: Any = of
    for one in name.split("."):
        inner = run.attribute(found, one, ast.Name(name, ast.Load(), lineno=0, col_offset=0))
        if inner is None:
            if default and isinstance(found, _WITH_KNOWN_ATTRIBUTES):
                return default[0]
            if run.trying:
                raise AttributeError(name)
            raise OpaqueError("an unknown attribute")
        found = inner[0]
    return found


def _descriptor(kind: str, of: Any, setter: Any = None, *_: Any, **__: Any) -> Function:
    """Return the result of `property(…)` or a similar decorator for a function of the file."""
    if not isinstance(of, Function):
        raise OpaqueError("an unknown function")
    return dataclasses.replace(of, kind=kind, setter=setter if isinstance(setter, Function) else None)


def _wrapped(of: Any, made: Any) -> Any:
    """Return a function with the name of the function that it wraps."""
    if isinstance(of, Function) and isinstance(made, Function):
        return dataclasses.replace(made, name=of.called())
    return made


def _has(run: Evaluator, of: Any, name: Any) -> bool:
    missing = object()
    return _attribute(run, of, name, missing) is not missing


def _element(of: Any, key: Any) -> Any:
    if isinstance(of, Unknown | Library):
        raise OpaqueError("an unknown element")
    return of[key]


def _several(get: Callable[[Any, Any], Any], keys: tuple[Any, ...]) -> Partial:
    """Return a function that returns an element or attribute of a value; for several names, a tuple of these."""
    return Partial(lambda of: get(of, keys[0]) if len(keys) == 1 else tuple(get(of, one) for one in keys))


def _variables(of: Any) -> Any:
    if not isinstance(of, Made):
        raise OpaqueError("names of a module")
    return of.attributes


def _is_data(of: Any) -> bool:
    kind = of.kind if isinstance(of, Made) else of
    return isinstance(kind, Class) and kind.all_fields() is not None and not kind.unpacked


def _cached(*given: Any, **_: Any) -> Any:
    """Return a decorator, or the decorated function if `lru_cache` has no arguments."""
    made = given[0] if given else None
    return made if callable(made) or hasattr(made, "node") else Partial(lambda one: one)
