"""Classes of an interpreted file and their objects: data classes, named tuples, enumerations and others."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from typing import Any, Final

from tarl_lint.workspace.python.builtin_functions import BUILTINS
from tarl_lint.workspace.python.elements import as_data, settled
from tarl_lint.workspace.python.evaluation import Evaluation, Execution, call_of, unknown
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.objects import ENUMERATIONS, FLAGS, TUPLES, Class, Function, Method
from tarl_lint.workspace.python.values import Field, Library, OpaqueError, Partial, Scope, Unknown

DATA: Final = "dataclasses.dataclass"
_TOTAL: Final = "functools.total_ordering"
AUTO: Final = Unknown(0, "auto()")  # the result of `enum.auto`


def of_statement(run: Execution, statement: ast.ClassDef, names: Scope) -> Any:
    """Return the class of a `class` statement, or the result of its decorators."""
    bases = tuple(run.value(one, names) for one in statement.bases)
    kinds = {one.name for one in bases if isinstance(one, Library)} | {
        base.name
        for one in bases
        if isinstance(one, Class)
        for base in one.library_bases()
        if isinstance(base, Library)
    }
    body = _Numbered(kinds) if kinds & ENUMERATIONS else {}
    inside = Scope(body, names, of_class=True)
    run.body(statement.body, inside)
    stated = []
    for one in statement.decorator_list:
        given = one.keywords if isinstance(one, ast.Call) else []
        called = run.value(one.func if isinstance(one, ast.Call) else one, names)
        stated.append((called, {key.arg: run.value(key.value, names) for key in given}))
    made: Any = defined(statement, bases, stated, inside.names)
    _announce(made, {one.arg: run.value(one.value, names) for one in statement.keywords if one.arg})
    for node, (called, _) in reversed(list(zip(statement.decorator_list, stated, strict=True))):
        if isinstance(called, Function | Method | Partial):
            decorator = called if not isinstance(node, ast.Call) else run.value(node, names)
            made = run.call(decorator, [made], {}, call_of(statement.name, statement.lineno))
    return made


def defined(
    statement: ast.ClassDef,
    bases: tuple[Any, ...],
    decorators: Iterable[tuple[Any, Any]],
    names: dict[str, Any],
) -> Class:
    """Return the class of a `class` statement, given its bases, its decorators with their keywords, and its `names`.

    The values of an enumeration in `names` are replaced with its members.
    """
    libraries = {one.name for one in bases if isinstance(one, Library)}
    stated = {one.name: given for one, given in decorators if isinstance(one, Library)}
    is_data = DATA in stated or TUPLES in libraries
    options = {**(stated.get(DATA) or {}), "total": _TOTAL in stated}
    annotated = dict(_annotated(statement))
    fields = tuple(annotated) if is_data else None
    stated_fields = {name: names[name] for name in fields or () if isinstance(names.get(name), Field)}
    options["hidden"] = tuple(name for name, one in stated_fields.items() if not one.shown)
    options["passed"] = tuple(name for name, text in annotated.items() if "InitVar" in text)
    options["ignored"] = tuple(name for name, one in stated_fields.items() if not one.compared)
    made = Class(statement.name, bases, names, fields, TUPLES in libraries, options)
    if made.is_enumeration():
        _enumerate(made)
    return made


def _announce(made: Class, keywords: dict[str, Any]) -> None:
    """Call `__set_name__` and `__init_subclass__` for a new class."""
    for name, value in list(made.names.items()):
        if isinstance(value, Made) and value.has("__set_name__"):
            value.run("__set_name__", made, name)
    above = next(((one.names["__init_subclass__"], one) for one in made.order()[1:]
                  if "__init_subclass__" in one.names), None)  # fmt: skip
    if above is not None and isinstance(above[0], Function):
        above[0].run(
            above[0], [made], {key: one for key, one in keywords.items() if key != "metaclass"}, above[1]
        )


def _annotated(statement: ast.ClassDef) -> Iterable[tuple[str, str]]:
    """Yield the annotated attributes of a class, without class variables."""
    for one in statement.body:
        if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name):
            text = ast.unparse(one.annotation)
            if "ClassVar" not in text and not text.endswith("KW_ONLY"):
                yield one.target.id, text


def _enumerate(made: Class) -> None:
    """Replace the values of an enumeration with the members of the enumeration."""
    found: dict[int, Made] = {}
    for name, value in list(made.names.items()):
        if isinstance(value, Function | Class | Partial) or name.startswith("_"):
            continue
        same = next((one for one in found.values() if _equal(one.attributes["value"], value)), None)
        member = Made(made, {"name": name, "value": value}) if same is None else same
        start = made.find("__init__")
        if same is None and start is not None and isinstance(start[0], Function):
            args = value if isinstance(value, tuple) else (value,)
            start[0].run(start[0], [member, *args], {}, start[1])
        found[id(member)] = member
        made.names[name] = member


def _equal(one: Any, other: Any) -> bool:
    return bool(settled([one, other]) and type(one) is type(other) and one == other)


class _Numbered(dict[str, Any]):
    """The names in the body of an enumeration; `auto()` is replaced with its value immediately."""

    def __init__(self, kinds: set[str]) -> None:
        super().__init__()
        self._kinds = kinds

    def __setitem__(self, name: str, value: Any) -> None:
        super().__setitem__(name, self._automatic(name) if value is AUTO else value)

    def _automatic(self, name: str) -> Any:
        if "enum.StrEnum" in self._kinds:
            return name.lower()
        numbers = [one for one in self.values() if isinstance(one, int)]
        if self._kinds & FLAGS:
            return 1 if not numbers else 2 ** max(numbers).bit_length()
        return max(numbers, default=0) + 1


def instance(run: Evaluation, kind: Class, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
    """Return a new object of a class of the file, or a member of an enumeration."""
    if kind.is_enumeration():
        return _member(run, kind, args, node)
    made, fields = _new(kind, args, keywords), kind.all_fields()
    if not isinstance(made, Made) or made.kind is not kind:
        return made
    start = kind.find("__init__")
    if start is not None and isinstance(start[0], Function):
        if kind.error() is not None:
            made.attributes["args"] = tuple(args)
        start[0].run(start[0], [made, *args], keywords, start[1])
    elif fields is not None:
        _fill(run, made, fields, args, keywords, node)
    elif kind.error() is not None:
        made.attributes["args"] = tuple(args)
    return made


def _new(kind: Class, args: list[Any], keywords: dict[str, Any]) -> Any:
    """Return a new object, or the result of the class's `__new__`."""
    made = kind.find("__new__")
    if made is not None and isinstance(made[0], Function):
        return made[0].run(made[0], [kind, *args], keywords, made[1])
    return blank(kind, args, keywords)


def blank(kind: Class, args: list[Any], keywords: dict[str, Any]) -> Made:
    """Return a new object; if its class is derived from list, int or the like, with the value of that type.

    Raise OpaqueError if a text or number would be made of values that are not constants.
    """
    container = kind.container()
    if container is None or kind.unpacked:
        return Made(kind, {})
    start = kind.find("__init__")
    own = start is not None and isinstance(start[0], Function)
    if own and container not in (str, int, float, BUILTINS["tuple"]):
        args, keywords = [], {}  # the class has an `__init__`, which fills the empty container
    elif not settled(args) and container in (str, int, float):
        raise OpaqueError("not a constant")
    return Made(kind, {}, container(*args, **keywords))


def _fill(
    run: Evaluation,
    made: Made,
    fields: tuple[str, ...],
    args: list[Any],
    keywords: dict[str, Any],
    node: ast.Call,
) -> None:
    """Set the fields of a data class or named tuple, and call `__post_init__`."""
    kind = made.kind
    positional = [name for name in fields if _takes(kind, name)]
    given = {**dict(zip(positional, args, strict=False)), **keywords}
    if run.trying and (len(args) > len(positional) or any(name not in fields for name in keywords)):
        raise OpaqueError("an exception of a data class")
    passed = {name: given.get(name, _default(run, kind, name, node)) for name in _passed(kind)}
    for name in fields:
        if name in passed:
            continue
        value = given[name] if name in given else _default(run, kind, name, node)
        if name in given or not _is_set_later(kind, name):
            made.attributes[name] = value
    after = kind.find("__post_init__")
    if after is not None and isinstance(after[0], Function):
        after[0].run(after[0], [made, *passed.values()], {}, after[1])


def _passed(kind: Class) -> list[str]:
    """Return the names of the arguments of `__post_init__`."""
    return [name for one in reversed(kind.order()) for name in one.options.get("passed", ())]


def _is_set_later(kind: Class, name: str) -> bool:
    """Return whether a field of a data class is not set by `__init__`."""
    found = kind.find(name)
    value = found[0] if found is not None else None
    return (
        isinstance(value, Field)
        and not value.init
        and value.factory is None
        and isinstance(value.default, Unknown)
    )


def _takes(kind: Class, name: str) -> bool:
    """Return whether a positional argument of the constructor can set a field."""
    found = kind.find(name)
    value = found[0] if found is not None else None
    return not (isinstance(value, Field) and (not value.init or value.keyword))


def _default(run: Evaluation, kind: Class, name: str, node: ast.Call) -> Any:
    found = kind.find(name)
    value = found[0] if found is not None else unknown(node)
    if isinstance(value, Field):
        return value.default if value.factory is None else run.call(value.factory, [], {}, node)
    return value


def _member(run: Evaluation, kind: Class, args: list[Any], node: ast.Call) -> Any:
    """Return the member of an enumeration with a value."""
    if len(args) != 1 or not settled(args):
        return unknown(node)
    wanted = args[0]
    if isinstance(wanted, Made) and wanted.kind is kind:
        return wanted
    same = kind.with_value(wanted)
    if same is not None:
        return same
    missing = kind.find("_missing_")
    if missing is not None and isinstance(missing[0], Function):
        return missing[0].run(missing[0], [kind, wanted], {}, missing[1])
    if run.trying:
        raise ValueError(f"{wanted!r} is not a valid {kind.name}")
    return unknown(node)


def as_mapping(value: Any, **keywords: Any) -> Any:
    """Return the result of `dataclasses.asdict`: a new dict of the fields, with nested data classes as dicts.

    Raise OpaqueError if a `dict_factory` is given.
    """
    if keywords:
        raise OpaqueError("a function makes the dict")
    return _converted(value, dict, 0)


def as_values(value: Any, **keywords: Any) -> Any:
    """Return the result of `dataclasses.astuple`. Raise OpaqueError if a `tuple_factory` is given."""
    if keywords:
        raise OpaqueError("a function makes the tuple")
    return _converted(value, tuple, 0)


def _converted(value: Any, make: Any, depth: int) -> Any:
    if depth > 30:
        raise OpaqueError("too deep")
    if isinstance(value, Made) and value.kind.fields is not None and not value.kind.unpacked:
        names = [name for name in value.kind.all_fields() or () if name not in _passed(value.kind)]
        pairs = {name: _converted(value.attributes.get(name), make, depth + 1) for name in names}
        return pairs if make is dict else tuple(pairs.values())
    if isinstance(value, Made) and value.kind.unpacked:
        inner = {key: _converted(one, make, depth + 1) for key, one in value.attributes.items()}
        return Made(value.kind, inner)
    if isinstance(value, list | tuple):
        return type(value)(_converted(one, make, depth + 1) for one in value)
    if isinstance(value, dict):
        found = {key: _converted(one, make, depth + 1) for key, one in value.items()}
        return found if type(value) is dict else as_data(found)
    return value


def replaced(value: Any, **changes: Any) -> Any:
    """Return the result of `dataclasses.replace`: a copy of an object in which some fields have new values.

    Raise OpaqueError for anything but an object of a data class.
    """
    if not isinstance(value, Made) or value.kind.all_fields() is None:
        raise OpaqueError("no data class")
    made = Made(
        value.kind, {name: value.attributes.get(name) for name in value.kind.all_fields() or ()} | changes
    )
    after = value.kind.find("__post_init__")
    if after is not None and isinstance(after[0], Function):
        after[0].run(after[0], [made], {}, after[1])
    return made


def field_names(value: Any) -> list[Made]:
    """Return the result of `dataclasses.fields`: objects with the names of the fields.

    Raise OpaqueError for anything but a data class or an object of one.
    """
    kind = value.kind if isinstance(value, Made) else value
    if not isinstance(kind, Class):
        raise OpaqueError("no data class")
    shape = Class("Field", (), {})
    names = [name for name in kind.all_fields() or () if name not in _passed(kind)]
    return [Made(shape, {"name": name}) for name in names]
