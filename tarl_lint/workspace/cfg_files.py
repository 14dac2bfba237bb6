"""Read dynamic_reconfigure's `.cfg` files: names, types, defaults, ranges and groups of parameters.

A `.cfg` file is a Python program; the calls `gen.add`, `add_group`, `const`, `enum` and `generate` are interpreted. The
result has the structure of `config_description` in the generated module `PACKAGE.cfg.NAMEConfig`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Final

from tarl_lint.workspace.model import Problem
from tarl_lint.workspace.python.evaluator import Library, Unknown
from tarl_lint.workspace.python.interpreter import Interpreter

_TYPES: Final[Mapping[str, type]] = {"str": str, "int": int, "double": float, "bool": bool}
_LOWEST: Final[Mapping[str, Any]] = {"int": -(2**31), "double": -math.inf, "str": "", "bool": False}
_HIGHEST: Final[Mapping[str, Any]] = {"int": 2**31 - 1, "double": math.inf, "str": "", "bool": True}
_DEFAULT: Final[Mapping[str, Any]] = {"int": 0, "double": 0, "str": "", "bool": False}
_CTYPES: Final = {"str": "std::string", "int": "int", "double": "double", "bool": "bool"}
_CONSTANTS: Final = {
    "str": "const char * const",
    "int": "const int",
    "double": "const double",
    "bool": "const bool",
}
_MODULES: Final = (
    "dynamic_reconfigure.parameter_generator_catkin",
    "dynamic_reconfigure.parameter_generator",
)
_LEVELS: Final = {
    "RECONFIGURE_CLOSE": 3,
    "RECONFIGURE_STOP": 1,
    "RECONFIGURE_RUNNING": 0,
}  # constants of driver_base/SensorLevels


@dataclass(frozen=True)
class Configuration:
    """One generated configuration, the module `PACKAGE.cfg.{name}Config`."""

    name: str
    description: dict[str, Any]
    constants: dict[str, Any]
    problems: tuple[Problem, ...] = ()


@dataclass
class _Group:
    """A group of parameters, the result of `gen.add_group`."""

    generator: _Generator
    name: str
    type: str = ""
    state: bool = True
    number: int = 0
    above: _Group | None = None
    parameters: list[dict[str, Any]] = field(default_factory=list)
    groups: list[_Group] = field(default_factory=list)
    line: int = 0
    readable: ClassVar = frozenset({"add", "add_group"})

    def add(
        self,
        name: Any,
        paramtype: Any,
        level: Any = 0,
        description: Any = "",
        default: Any = None,
        min: Any = None,  # noqa: A002 (the generator's name)
        max: Any = None,  # noqa: A002
        edit_method: Any = "",
    ) -> None:
        """Add a parameter."""
        made = self.generator
        if not isinstance(name, str) or paramtype not in _TYPES:
            made.file.problem(made.file.line, "the name or type of a parameter is not constant")
            return
        one = {
            "name": name,
            "type": paramtype,
            "default": made.typed(name, paramtype, "default", default, _DEFAULT),
            "level": level if isinstance(level, int) else 0,
            "description": "" if isinstance(description, Unknown | Library) else description,
            "min": made.typed(name, paramtype, "min", min, _LOWEST),
            "max": made.typed(name, paramtype, "max", max, _HIGHEST),
            "srcline": made.file.line,
            "srcfile": made.file.file.name,
            "edit_method": edit_method if isinstance(edit_method, str) else "",
            "ctype": _CTYPES[paramtype],
            "cconsttype": _CONSTANTS[paramtype],
        }
        self.parameters.append(one)

    def add_group(self, name: Any, type: Any = "", state: Any = True) -> _Group:  # noqa: A002
        """Add a group within this one."""
        made = self.generator
        made.groups += 1
        shown = name.replace(" ", "_") if isinstance(name, str) else "group"
        one = _Group(made, shown, type, state, made.groups, self, line=made.file.line)
        self.groups.append(one)
        return one

    def described(self) -> dict[str, Any]:
        """Return the group in the form of the generated module."""
        path = [one.name for one in reversed(list(self._upwards()))]
        upper = [name.upper() for name in path]
        return {
            "name": self.name,
            "type": self.type,
            "state": self.state,
            "cstate": "true" if self.state else "false",
            "id": self.number,
            "parent": self.above.number if self.above is not None else 0,
            "parameters": self.parameters,
            "groups": [one.described() for one in self.groups],
            "srcline": self.line,
            "srcfile": self.generator.file.file.name,
            "class": "::".join(upper),
            "parentclass": "::".join(upper[:-1]),
            "parentname": (self.above or self).name,
            "field": "::".join([*upper[:-1], self.name.lower()]),
            "upper": self.name.upper(),
            "lower": "groups" if self.number == 0 else self.name.lower(),
        }

    def _upwards(self) -> Iterator[_Group]:
        yield self
        if self.above is not None:
            yield from self.above._upwards()


@dataclass
class _Generator:
    """The model of a `ParameterGenerator`."""

    file: Interpreter
    groups: int = 0
    top: _Group = field(init=False)
    constants: dict[str, Any] = field(default_factory=dict)
    made: list[Configuration] = field(default_factory=list)
    readable: ClassVar = frozenset({"add", "add_group", "const", "enum", "generate"})

    def __post_init__(self) -> None:
        self.top = _Group(self, "Default", line=self.file.line)
        self.add, self.add_group = self.top.add, self.top.add_group

    def const(self, name: Any, type: Any, value: Any, descr: Any = "") -> Any:  # noqa: A002
        """Add a constant."""
        if not isinstance(name, str) or isinstance(value, Unknown | Library) or type not in _TYPES:
            self.file.problem(self.file.line, "a constant's name or value is not constant")
            return {}
        self.constants[name] = _TYPES[type](value)
        return {
            "name": name,
            "type": type,
            "value": _TYPES[type](value),
            "srcline": self.file.line,
            "srcfile": self.file.file.name,
            "description": descr,
            "ctype": _CTYPES[type],
            "cconsttype": _CONSTANTS[type],
        }

    def enum(self, constants: Any, description: Any) -> str:
        """Return the edit method of an enumeration."""
        return repr({"enum": constants, "enum_description": description})

    def generate(self, pkgname: Any, nodename: Any, name: Any) -> int:  # noqa: ARG002 (the generator's signature)
        """Record the configuration."""
        if isinstance(name, str):
            named = {f"{name}_{key}": value for key, value in self.constants.items()}
            self.made.append(Configuration(name, self.top.described(), named))
        return 0

    def typed(self, name: str, kind: str, what: str, value: Any, otherwise: Mapping[str, Any]) -> Any:
        """Convert a value to its parameter's type."""
        if value is None:
            return otherwise[kind]
        if isinstance(value, Unknown | Library):
            self.file.problem(self.file.line, f"the {what} of {name} is not constant")
            return otherwise[kind]
        try:
            return _TYPES[kind](value)
        except (TypeError, ValueError):
            self.file.problem(self.file.line, f"the {what} of {name} is not of type {kind}")
            return otherwise[kind]


def configurations(path: Path) -> tuple[list[Configuration], list[Problem]]:
    """Return the configurations that a `.cfg` file generates, and the problems found while reading it."""
    made: list[_Generator] = []

    def generator() -> _Generator:
        made.append(_Generator(file))
        return made[-1]

    models: dict[str, Any] = {f"driver_base.msg.SensorLevels.{key}": value for key, value in _LEVELS.items()}
    for module in _MODULES:
        models[f"{module}.ParameterGenerator"] = generator
        models |= {f"{module}.{kind}_t": kind for kind in _TYPES}
    file = Interpreter(path, models)
    file.run()
    found = [one for each in made for one in each.made]
    if not found:
        file.problem(0, "no call of generate with a constant name was found")
    return found, file.problems
