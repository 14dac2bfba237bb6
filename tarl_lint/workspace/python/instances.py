"""Objects of classes that an interpreted file defines.

The objects have the special methods of their class, such as `__str__` and `__lt__`, so Python's own operations work
on them. These methods interpret the functions of the file and never execute them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tarl_lint.workspace.python.jumps import Raised
from tarl_lint.workspace.python.objects import Class, Function
from tarl_lint.workspace.python.values import Library, OpaqueError, Unknown


class Made:
    """An object of a class of the file. Operations raise OpaqueError if their result is not known."""

    __slots__ = ("attributes", "held", "kind")

    def __init__(self, kind: Class, attributes: dict[str, Any], held: Any = None) -> None:
        self.kind, self.attributes = kind, attributes
        self.held = held  # the built-in value of an object whose class derives from list or the like

    def has(self, name: str) -> bool:
        """Return whether the class defines a method."""
        found = self.kind.find(name)
        return found is not None and isinstance(found[0], Function)

    def run(self, name: str, *args: Any) -> Any:
        """Return the result of a method.

        Raises OpaqueError if the class has no such method, or the result is not known.
        """
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
        """Return the object as a built-in value, if its class derives from one."""
        if self.held is not None:
            return self.held
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
        return str(self.held) if isinstance(self.held, str) else repr(self)

    def __repr__(self) -> str:
        if self.has("__repr__"):
            return str(self.run("__repr__"))
        if self.kind.is_enumeration():
            return f"<{self.kind.name}.{self.attributes['name']}: {self.attributes['value']!r}>"
        if self.held is not None:
            return repr(self.held)
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
        if self.plain() is not self and not isinstance(self.held, list | dict):
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
        """Return the fields of a data class for which an option is set."""
        return {name for one in self.kind.order() for name in one.options.get(option, ())}

    def _values(self) -> tuple[Any, ...]:
        ignored = self._marked("ignored") | self._marked("passed")
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
        if self.has("__len__"):
            return int(self.run("__len__"))
        return len(self._sized())

    def _sized(self) -> Any:
        """Return the built-in container from which the object is derived.

        Raises OpaqueError if it is not a container.
        """
        plain = self.plain()
        if plain is self or isinstance(plain, int | float):
            raise OpaqueError(f"{self.kind.name} is no container")
        return plain

    def __iter__(self) -> Iterator[Any]:
        if not self.has("__iter__"):
            return iter(self._sized())
        found = self.run("__iter__")
        return found.elements() if isinstance(found, Made) and found.has("__next__") else iter(found)

    def elements(self) -> Iterator[Any]:
        """Yield what `__next__` returns until it raises StopIteration."""
        while True:
            try:
                found = self.run("__next__")
            except Raised as left:
                if isinstance(left.error, StopIteration):
                    return
                raise
            yield found

    def __contains__(self, item: object) -> bool:
        if self.has("__contains__"):
            return bool(self.run("__contains__", item))
        if self.held is not None:
            return item in self._sized()
        if self.kind.is_flag() and isinstance(item, Made):
            value = item.attributes["value"]
            return bool(self.attributes["value"] & value == value)
        return any(one is item or one == item for one in self)

    def __getitem__(self, key: Any) -> Any:
        if self.has("__getitem__"):
            return self.run("__getitem__", key)
        if isinstance(self.held, dict) and key not in self.held and self.has("__missing__"):
            return self.run("__missing__", key)
        return self._sized()[key]

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
