"""Fields of dataclasses and named tuples: their order, and the options of `field(...)` and of the decorator."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.ir import nodes as ir
from tarl_lint.memory.values import ClassInfo, Obj, Value, lineage

PLAIN: Final = frozenset(
    ["abc.ABC", "typing.Generic", "typing.Protocol"]
)  # base classes without a constructor of their own


def fields(cls: Obj) -> Iterator[tuple[Obj, str]]:
    """Yield the fields of a class and of its base classes, in the order of the constructor's parameters.

    A field that a class declares again keeps its place, but has the options of the new declaration.
    """
    found: dict[str, Obj] = {}
    made = any(isinstance(o.info, ClassInfo) and not set(o.info.external) <= PLAIN for o in lineage(cls))
    for owner in reversed(lineage(cls)):
        info = owner.info if isinstance(owner.info, ClassInfo) else None
        for name in info.fields if info is not None and (made or _decorated(info)) else ():
            found[name] = owner
    for name, owner in found.items():
        yield owner, name


def positional(ctx: Interpreter, cls: Obj) -> list[str]:
    """Return the fields that the constructor takes by position, which are the `__match_args__` of the class."""
    found: list[str] = []
    for owner, name in fields(cls):
        chosen = options(ctx, owner, name)
        if not says(chosen, "init", False) and not only_named(owner, name, chosen):
            found.append(name)
    return found


def compared(ctx: Interpreter, cls: Obj) -> list[str] | None:
    """Return the fields by which instances of a dataclass are compared; None for another class."""
    found = list(fields(cls))
    if not found:
        return None
    return [name for owner, name in found if not says(options(ctx, owner, name), "compare", False)]


def compared_by_identity(cls: Obj) -> bool:
    """Return whether instances of a class without `__eq__` equal only themselves."""
    return not any(True for _ in fields(cls)) or _says_of_class(cls, "eq", False)


def options(ctx: Interpreter, owner: Obj, name: str) -> dict[str, Value] | None:
    """Return the options of a dataclass field's `field(...)`; None if the field has no such call."""
    preset = ctx.store.get((owner, name))
    spec = next((o for o in preset.pts if o.kind == "field"), None) if preset is not None else None
    return spec.info if spec is not None and isinstance(spec.info, dict) else None


def says(given: Mapping[str, Value] | None, name: str, answer: bool) -> bool:
    """Return whether `field(...)` certainly has an option."""
    return given is not None and name in given and given[name].constant() == (True, answer)


def only_named(owner: Obj, name: str, given: Mapping[str, Value] | None) -> bool:
    """Return whether the constructor takes a field only by its name: `kw_only` of the field or of its class."""
    if given is not None and "kw_only" in given:
        return says(given, "kw_only", True)
    statement = _statement(owner)
    named = statement is not None and name in statement.only_named
    return named or _says_of_class(owner, "kw_only", True)


def handed_on(cls: Obj) -> frozenset[str]:
    """Return the fields of a class that its objects do not have, because `__post_init__` gets their values."""
    statement = _statement(cls)
    return frozenset() if statement is None else statement.passed


def is_named_tuple(cls: object) -> bool:
    """Return whether a class is a named tuple, whose fields are also elements."""
    infos = [o.info for o in lineage(cls)] if isinstance(cls, Obj) else []
    return any(isinstance(i, ClassInfo) and (i.named or "typing.NamedTuple" in i.external) for i in infos)


def _statement(cls: Obj) -> ir.Class | None:
    return cls.info.statement if isinstance(cls.info, ClassInfo) else None


def _decorated(info: ClassInfo) -> bool:
    """Return whether a class has a decorator, like a dataclass. Annotations in a class without one are not fields."""
    return info.statement is None or bool(info.statement.decorators)


def _says_of_class(cls: Obj, name: str, answer: bool) -> bool:
    """Return whether a decorator of a class has an option, as in `@dataclass(kw_only=True)`."""
    statement = _statement(cls)
    for decorator in statement.decorators if statement is not None else ():
        for keyword, value in decorator.keywords if isinstance(decorator, ir.Call) else ():
            if keyword == name and isinstance(value, ir.Const) and value.value is answer:
                return True
    return False
