"""Functions, classes and objects that an interpreted file defines.

Objects have the special methods of their class, such as `__str__` and `__lt__`, so that Python's own operations apply
to them: these methods interpret the functions of the file, and never execute them.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.python.values import Library, OpaqueError, Partial, Scope, Unknown

FLAGS: Final = frozenset({"enum.Flag", "enum.IntFlag"})
ENUMERATIONS: Final = frozenset({"enum.Enum", "enum.IntEnum", "enum.StrEnum", *FLAGS})
TUPLES: Final = "typing.NamedTuple"
_MIXED: Final = {"enum.IntEnum": int, "enum.IntFlag": int, "enum.StrEnum": str}


@dataclass(frozen=True, slots=True, eq=False)
class Function:
    """A function of a file, with the scope around it and the values of its defaults."""

    node: ast.FunctionDef
    scope: Scope
    defaults: dict[str, Any]
    file: Path
    # function that interprets it, given arguments, keywords and the class that defines it
    run: Callable[[Function, list[Any], dict[str, Any], Class | None], Any]
    kind: str = ""  # `staticmethod`, `classmethod`, `property`, `cached_property` or `contextmanager`
    setter: Function | None = None  # of a property
    name: str = ""  # the name that `functools.wraps` gives it

    def called(self) -> str:
        """Return its name."""
        return self.name or self.node.name


@dataclass(frozen=True, slots=True, eq=False)
class Class:
    """A class of a file. `fields` are those of a data class, in order; `bases` are classes and library names."""

    name: str
    bases: tuple[Any, ...]
    names: dict[str, Any]
    fields: tuple[str, ...] | None = None
    unpacked: bool = False  # whether objects of the class are tuples
    options: dict[str, Any] = field(
        default_factory=dict
    )  # arguments of the decorator `dataclass`, and others

    def find(self, name: str) -> tuple[Any, Class] | None:
        """Return an attribute of the class or its bases, and the class that has it."""
        return next(((one.names[name], one) for one in self.order() if name in one.names), None)

    def order(self) -> list[Class]:
        """Return the class and its bases in the order in which attributes are looked up."""
        above = [base.order() for base in self.bases if isinstance(base, Class)]
        lists = [*above, [base for base in self.bases if isinstance(base, Class)]]
        found = [self]
        while lists := [one for one in lists if one]:
            first = next(
                (one[0] for one in lists if not any(one[0] in other[1:] for other in lists)), lists[0][0]
            )
            found.append(first)
            lists = [[one for one in each if one is not first] for each in lists]
        return found

    def all_fields(self) -> tuple[str, ...] | None:
        """Return the fields of a data class with those of its bases; None for other classes."""
        known = [one.fields for one in reversed(self.order()) if one.fields is not None]
        return tuple(dict.fromkeys(name for one in known for name in one)) if known else None

    def is_a(self, other: object) -> bool:
        """Return whether this is another class, or derived from it."""
        return other in self.order()

    def library_bases(self) -> list[Any]:
        """Return the bases that the file does not define: names of libraries, and built-in classes."""
        return [base for one in self.order() for base in one.bases if not isinstance(base, Class)]

    def is_enumeration(self) -> bool:
        """Return whether the class is an enumeration."""
        names = {base.name for base in self.library_bases() if isinstance(base, Library)}
        return bool(names & ENUMERATIONS)

    def is_flag(self) -> bool:
        """Return whether the class is an enumeration of flags."""
        return any(isinstance(base, Library) and base.name in FLAGS for base in self.library_bases())

    def mixed(self) -> type | None:
        """Return the type of the members of an enumeration whose members are numbers or texts."""
        if not self.is_enumeration():
            return None
        for base in self.library_bases():
            if isinstance(base, Library) and base.name in _MIXED:
                return _MIXED[base.name]
            if base in (int, str, float):
                return base  # type: ignore[no-any-return] # one of three types
        return None

    def members(self) -> list[Any]:
        """Return the members of an enumeration."""
        found = [one for one in self.names.values() if isinstance(one, Made) and one.kind is self]
        if self.is_flag():  # neither combinations nor zero, as since Python 3.11
            found = [one for one in found if _is_single(one.attributes["value"])]
        return list({id(one): one for one in found}.values())

    def with_value(self, value: Any) -> Any:
        """Return the member of an enumeration with a value, also a combination of flags; None if there is none."""
        found = [one for one in self.names.values() if isinstance(one, Made) and one.kind is self]
        return next((one for one in found if one.attributes["value"] == value), None)

    def error(self) -> type[BaseException] | None:
        """Return the built-in exception that the class is derived from; None if it is no exception."""
        known = [one for one in self.library_bases() if isinstance(one, type)]
        return next((one for one in known if issubclass(one, BaseException)), None)


def _is_single(value: Any) -> bool:
    """Return whether a flag is a single bit."""
    return isinstance(value, int) and value > 0 and not value & (value - 1)


class Made:
    """An object of a class of the file. Operations raise OpaqueError if their result is not known."""

    __slots__ = ("attributes", "kind")

    def __init__(self, kind: Class, attributes: dict[str, Any]) -> None:
        self.kind, self.attributes = kind, attributes

    def has(self, name: str) -> bool:
        """Return whether the class defines a method."""
        found = self.kind.find(name)
        return found is not None and isinstance(found[0], Function)

    def run(self, name: str, *args: Any) -> Any:
        """Return the result of a method. Raises OpaqueError if the class has no such method, or it is not known."""
        found = self.kind.find(name)
        if found is None or not isinstance(found[0], Function):
            raise OpaqueError(f"{self.kind.name} has no {name}")
        function, owner = found
        result = function.run(
            function, [*(() if function.kind == "staticmethod" else (self,)), *args], {}, owner
        )
        if isinstance(result, Unknown | Library):
            raise OpaqueError(f"{self.kind.name}.{name}")
        return result

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        """Call the object. Raises OpaqueError if it is not callable."""
        found = self.kind.find("__call__")
        if found is None or not isinstance(found[0], Function):
            raise OpaqueError(f"{self.kind.name} is not callable")
        return found[0].run(found[0], [self, *args], keywords, found[1])

    def plain(self) -> Any:
        """Return a member of an enumeration of numbers or texts as such, and a named tuple as a tuple."""
        if self.kind.unpacked:
            return tuple(self.attributes.get(name) for name in self.kind.all_fields() or ())
        return self.attributes.get("value") if self.kind.mixed() is not None else self

    def __str__(self) -> str:
        if self.has("__str__"):
            return str(self.run("__str__"))
        if self.kind.mixed() is not None and str not in self.kind.bases and int not in self.kind.bases:
            return str(self.attributes["value"])
        if self.kind.is_enumeration():
            return f"{self.kind.name}.{self.attributes['name']}"
        if self.kind.error() is not None:
            args = self.attributes.get("args", ())
            return str(args[0]) if len(args) == 1 else str(args) if args else ""
        return repr(self)

    def __repr__(self) -> str:
        if self.has("__repr__"):
            return str(self.run("__repr__"))
        if self.kind.is_enumeration():
            return f"<{self.kind.name}.{self.attributes['name']}: {self.attributes['value']!r}>"
        fields = self.kind.all_fields()
        if fields is None or self.kind.options.get("repr") is False:
            raise OpaqueError("its text contains an address")
        hidden = self._marked("hidden") | self._marked("passed")
        values = {name: self.attributes.get(name) for name in fields if name not in hidden}
        if any(isinstance(one, Unknown | Library) for one in values.values()):
            raise OpaqueError("an unknown field")
        return f"{self.kind.name}({', '.join(f'{name}={value!r}' for name, value in values.items())})"

    def __format__(self, spec: str) -> str:
        if self.has("__format__"):
            return str(self.run("__format__", spec))
        return format(str(self), spec) if spec == "" or self.plain() is self else format(self.plain(), spec)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if self.has("__eq__"):
            return bool(self.run("__eq__", other))
        if self.plain() is not self:
            return bool(self.plain() == (other.plain() if isinstance(other, Made) else other))
        if isinstance(other, Made) and other.kind is self.kind and self._compares("eq", default=True):
            return bool(self._values() == other._values())
        return False

    def __hash__(self) -> int:
        if self.has("__hash__"):
            return int(self.run("__hash__"))
        if self.plain() is not self:
            return hash(self.plain())
        frozen = self._compares("frozen", default=False)
        return hash(self._values()) if frozen else object.__hash__(self)

    def __lt__(self, other: Any) -> bool:
        return self._ordered("__lt__", "__gt__", other)

    def __gt__(self, other: Any) -> bool:
        return self._ordered("__gt__", "__lt__", other)

    def __le__(self, other: Any) -> bool:
        return self._ordered("__le__", "__ge__", other)

    def __ge__(self, other: Any) -> bool:
        return self._ordered("__ge__", "__le__", other)

    def _ordered(self, name: str, mirrored: str, other: Any) -> bool:
        if self.has(name):
            return bool(self.run(name, other))
        if isinstance(other, Made) and other.has(mirrored):
            return bool(other.run(mirrored, self))
        if self.plain() is not self:
            return bool(getattr(self.plain(), name)(other.plain() if isinstance(other, Made) else other))
        if isinstance(other, Made) and other.kind is self.kind and self._compares("order", default=False):
            return bool(getattr(self._values(), name)(other._values()))
        if self.kind.options.get("total") and self.has("__lt__"):
            less = bool(self.run("__lt__", other))
            return {
                "__le__": less or self == other,
                "__gt__": not less and self != other,
                "__ge__": not less,
            }[name]
        raise OpaqueError("no order")

    def _compares(self, option: str, *, default: bool) -> bool:
        return self.kind.fields is not None and bool(self.kind.options.get(option, default))

    def _marked(self, option: str) -> set[str]:
        """Return the fields of a data class that an option names."""
        return {name for one in self.kind.order() for name in one.options.get(option, ())}

    def _values(self) -> tuple[Any, ...]:
        ignored = {
            name
            for one in self.kind.order()
            for name in (*one.options.get("ignored", ()), *one.options.get("passed", ()))
        }
        fields = [name for name in self.kind.all_fields() or () if name not in ignored]
        found = tuple(self.attributes.get(name) for name in fields)
        if any(isinstance(one, Unknown | Library) for one in found):
            raise OpaqueError("an unknown field")
        return found

    def __bool__(self) -> bool:
        if self.has("__bool__"):
            return bool(self.run("__bool__"))
        if self.has("__len__"):
            return len(self) > 0
        plain = self.attributes["value"] if self.kind.is_flag() else self.plain()
        return plain is self or bool(plain)

    def __len__(self) -> int:
        if self.kind.unpacked:
            return len(self.plain())
        return int(self.run("__len__"))

    def __iter__(self) -> Iterator[Any]:
        plain = self.plain()
        return iter(plain if isinstance(plain, tuple | str) else self.run("__iter__"))

    def __contains__(self, item: object) -> bool:
        if self.has("__contains__"):
            return bool(self.run("__contains__", item))
        if self.kind.is_flag() and isinstance(item, Made):
            value = item.attributes["value"]
            return bool(self.attributes["value"] & value == value)
        return any(one is item or one == item for one in self)

    def __getitem__(self, key: Any) -> Any:
        plain = self.plain()
        return plain[key] if isinstance(plain, tuple | str) else self.run("__getitem__", key)

    def __int__(self) -> int:
        plain = self.plain()
        return int(self.run("__int__") if plain is self else plain)

    def __float__(self) -> float:
        plain = self.plain()
        return float(self.run("__float__") if plain is self else plain)

    def __abs__(self) -> Any:
        plain = self.plain()
        return self.run("__abs__") if isinstance(plain, Made | tuple) else abs(plain)

    def __round__(self, digits: Any = None) -> Any:
        plain = self.plain()
        given = () if digits is None else (digits,)
        return self.run("__round__", *given) if isinstance(plain, Made | tuple) else round(plain, *given)

    def __index__(self) -> int:
        plain = self.plain()
        if isinstance(plain, int):
            return plain
        return int(self.run("__index__"))


@dataclass(frozen=True, slots=True, eq=False)
class Method:
    """A method of an object or class, or `super().name`; `owner` is the class that defines it."""

    function: Function
    first: Any
    owner: Class


@dataclass(frozen=True, slots=True, eq=False)
class Above:
    """The result of `super()`."""

    of: Any
    owner: Class


@dataclass(frozen=True, slots=True, eq=False)
class Interpreted(Partial):
    """A function or class of the file that built-in functions can call; `of` is the function or class."""

    of: Any
