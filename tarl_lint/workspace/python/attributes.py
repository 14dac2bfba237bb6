"""Attributes of values: of modules, of classes and objects of the file, and of Python's own types."""

from __future__ import annotations

import ast
import functools
import operator
from collections import OrderedDict
from collections.abc import Callable, Mapping
from pathlib import PurePosixPath
from typing import Any, Final

from tarl_lint.workspace.python.classes import blank
from tarl_lint.workspace.python.containers import type_of
from tarl_lint.workspace.python.elements import listed
from tarl_lint.workspace.python.evaluation import Evaluation, call_of, unknown
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.methods import METHODS, READ, method, updated
from tarl_lint.workspace.python.objects import Above, Class, Function, Method
from tarl_lint.workspace.python.operators import limited
from tarl_lint.workspace.python.paths import FilePath
from tarl_lint.workspace.python.values import Bound, Library, Namespace, Partial, Stream


def attribute(run: Evaluation, base: Any, name: str, node: ast.AST) -> tuple[Any] | None:
    """Return a tuple with an attribute of a value; None if the attribute is not known."""
    if isinstance(base, Library):
        full = f"{base.name}.{name}"
        return (run.models.get(full, Library(full)),)
    if isinstance(base, Namespace):
        inner = base.names[name] if name in base.names else run.imported(f"{base.module}.{name}")
        return None if inner is None else (inner,)
    if isinstance(base, Made | Class | Above):
        found = _of_class(run, base, name, node) or _of_every_object(base, name)
        return _fallback(base, name) if found is None else found
    if isinstance(base, Function | Method):
        function = base if isinstance(base, Function) else base.function
        names = {"__name__": function.called(), "__qualname__": function.called()}
        return (names[name],) if name in names else None
    return _of_library(run, base, name)


def _of_library(run: Evaluation, base: Any, name: str) -> tuple[Any] | None:
    """Return a tuple with an attribute of a value of Python's own types."""
    kind = type(base)
    if name in METHODS.get(kind, ()):
        return (Bound(base, name),)
    if name in READ.get(kind, ()):
        return (getattr(base, name),)
    if isinstance(base, FilePath) and f"pathlib.Path.{name}" in run.models:
        return (functools.partial(run.models[f"pathlib.Path.{name}"], base),)
    if name in getattr(kind, "readable", ()) or name in getattr(base, "readable", ()):
        found = getattr(base, name)
        return (FilePath(found) if isinstance(found, PurePosixPath) else found,)
    if name == "__class__" and kind in (str, int, float, bool):
        return (kind,)
    if isinstance(base, BaseException) and name == "args":
        return (base.args,)
    return _of_type(base, name)


def _of_type(base: Any, name: str) -> tuple[Any] | None:
    """Return a tuple with an attribute of a built-in type: its name, or a method as a function."""
    kind = base if isinstance(base, type) else type_of(base)
    if kind is None:
        return None
    if name in ("__name__", "__qualname__"):
        return ({"Unique": "set", "FilePath": "PosixPath"}.get(kind.__name__, kind.__name__),)
    if kind is str and name == "maketrans":
        return (Partial(_translation),)
    if kind in (dict, OrderedDict) and name == "fromkeys":
        return (Partial(lambda keys, value=None: kind.fromkeys(listed(keys), value)),)
    if kind is FilePath and name in ("cwd", "home"):
        return None
    if name in METHODS.get(kind, ()):
        return (Partial(lambda of, *args, **keywords: method(Bound(of, name), list(args), keywords)),)
    return None


def _translation(one: Any, *more: Any) -> dict[Any, Any]:
    limited(len(one))
    return str.maketrans(one, *more)


def _of_class(run: Evaluation, base: Made | Class | Above, name: str, node: ast.AST) -> tuple[Any] | None:
    found, instance = _found(base, name)
    own = isinstance(base, Made) and name in base.attributes
    if own and not (found is not None and isinstance(found[0], Function) and found[0].kind == "property"):
        return (base.attributes[name],)  # type: ignore[union-attr] # `own` says that it is an object
    if found is None:
        return None
    value, owner = found
    if isinstance(value, Function):
        if value.kind == "classmethod":
            return (Method(value, instance.kind if isinstance(instance, Made) else _class_of(base), owner),)
        if instance is not None and value.kind != "staticmethod":
            bound = Method(value, instance, owner)
            if value.kind in ("property", "cached_property") and isinstance(instance, Made):
                result = run.call(bound, [], {}, ast.copy_location(call_of(name, 0), node))
                if value.kind == "cached_property":
                    instance.attributes[name] = result
                return (result,)
            return (bound,)
    if isinstance(value, Made) and value.has("__get__"):
        kind = base if isinstance(base, Class) else owner
        return (value.run("__get__", instance, instance.kind if isinstance(instance, Made) else kind),)
    return (value,)


def _found(base: Made | Class | Above, name: str) -> tuple[tuple[Any, Class] | None, Any]:
    """Return the definition of an attribute, and the object to which it belongs."""
    if not isinstance(base, Above):
        kind = base if isinstance(base, Class) else base.kind
        return kind.find(name), None if isinstance(base, Class) else base
    start = (
        base.of.kind if isinstance(base.of, Made) else base.of if isinstance(base.of, Class) else base.owner
    )
    order = start.order()
    rest = order[order.index(base.owner) + 1 :] if base.owner in order else base.owner.order()[1:]
    found = next(((one.names[name], one) for one in rest if name in one.names), None)
    return found, base.of


def _class_of(base: Any) -> Any:
    return base.of if isinstance(base, Above) else base


def _fallback(base: Made | Class | Above, name: str) -> tuple[Any] | None:
    """Return the result of the class's `__getattr__`."""
    if isinstance(base, Made) and base.has("__getattr__") and not name.startswith("__"):
        return (base.run("__getattr__", name),)
    return None


def _of_super(base: Above, name: str) -> tuple[Any] | None:
    """Return a tuple with a method of a built-in base class, for `super()`."""
    if name in ("__init__", "__init_subclass__", "__post_init__"):
        return (Partial(functools.partial(_initialised, base.of)),)
    if name == "__new__":
        return (Partial(lambda kind, *args, **keywords: blank(kind, list(args), keywords)),)
    if isinstance(base.of, Made) and base.of.held is not None:
        return _of_held(base.of.held, name)
    if name == "__str__" and isinstance(base.of, Made) and base.of.has("__repr__"):
        return (Partial(lambda: base.of.run("__repr__")),)
    if name == "__setattr__" and isinstance(base.of, Made):
        return (Partial(lambda key, value: base.of.attributes.update({key: value})),)
    return None


def _of_every_object(base: Made | Class | Above, name: str) -> tuple[Any] | None:
    """Return a tuple with an attribute that all classes and objects have, such as `__class__`."""
    if isinstance(base, Above):
        return _of_super(base, name)
    if isinstance(base, Made):
        return _of_object(base, name)
    if name in ("__name__", "__qualname__"):
        return (base.name,)
    if name == "__members__" and base.is_enumeration():
        return ({key: one for key, one in base.names.items() if isinstance(one, Made) and one.kind is base},)
    if base.unpacked and name == "_fields":
        return (base.all_fields(),)
    if base.unpacked and name == "_make":
        return (Partial(lambda values: Made(base, dict(zip(base.all_fields() or (), values, strict=True)))),)
    if name == "__doc__":
        return (unknown(ast.Name("__doc__", ast.Load())),)
    return None


_ITEMS: Final[Mapping[str, Callable[..., Any]]] = {
    "__getitem__": operator.getitem, "__setitem__": operator.setitem, "__delitem__": operator.delitem,
    "__len__": len, "__contains__": operator.contains, "__iter__": lambda held: Stream(iter(list(held))),
    "__repr__": repr, "__str__": str, "__eq__": operator.eq,
}  # fmt: skip


def _of_held(held: Any, name: str) -> tuple[Any] | None:
    """Return a tuple with a method that an object inherits from list, dict or another built-in type."""
    if name in METHODS.get(type(held), ()):
        return (Bound(held, name),)
    return (Partial(functools.partial(_ITEMS[name], held)),) if name in _ITEMS else None


def _initialised(of: Any, *args: Any, **keywords: Any) -> None:
    """Initialise an exception or a container as its built-in `__init__` does: store the arguments."""
    if isinstance(of, Made) and isinstance(of.held, list):
        of.held[:] = listed(*args) if args else []
    if isinstance(of, Made) and isinstance(of.held, dict):
        updated(of.held, list(args), keywords)
    if isinstance(of, Made) and of.kind.error() is not None:
        of.attributes["args"] = args


def _of_object(base: Made, name: str) -> tuple[Any] | None:
    values = {"__class__": base.kind, "__dict__": base.attributes}
    if name in values:
        return (values[name],)
    if base.kind.unpacked and name == "_asdict":
        return (Partial(lambda: dict(base.attributes)),)
    if base.kind.unpacked and name == "_replace":
        return (Partial(lambda **changes: Made(base.kind, {**base.attributes, **changes})),)
    if base.kind.unpacked and name == "_fields":
        return (base.kind.all_fields(),)
    plain = base.plain()
    return None if plain is base or name not in METHODS.get(type(plain), ()) else (Bound(plain, name),)
