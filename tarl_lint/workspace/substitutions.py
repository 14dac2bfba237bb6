"""Substitution arguments of ROS 1 launch files, such as `$(find …)`."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.launch_model import Scalar
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.python.evaluator import Library, Unknown, constant

_ARGUMENT: Final = re.compile(r"\$\(((?:[^()]|\([^()]*\))*)\)")
# environment variables that are always set; their defaults are never used
ALWAYS_SET: Final = frozenset({"HOME", "USER", "PATH"})
_EVAL: Final = "$(eval "
LONGEST: Final = 100_000  # maximum length of a text (characters)
_TRUTH: Final = {"true": True, "false": False}


class SymbolicError(Exception):
    """A string depends on values that are known only on the robot.

    The message is the reason. `text` represents the value, such as `$(env ROBOT)`. If `text` is empty, the original
    text represents the value.
    """

    def __init__(self, reason: str, text: str = "") -> None:
        super().__init__(reason)
        self.text = text


@dataclass(frozen=True, slots=True)
class Scope:
    """The names for substitutions: the arguments of the file, its folder, and the packages.

    An argument without a value is None. If the value of an argument is known only on the robot, the value is
    symbolic, such as `$(env ROBOT)`. All files to which the argument is passed on then have the same text for it.
    """

    workspace: Workspace
    file: Path
    arguments: Mapping[str, str | None]

    def text(self, text: str) -> str:
        """Return a string with its substitutions replaced. Raises SymbolicError if a substitution has no value."""
        if text.startswith(_EVAL) and text.endswith(")"):
            return str(self._evaluated(text[len(_EVAL) : -1]))
        replaced = _ARGUMENT.sub(lambda found: self._replaced(found[1].split()), text)
        if len(replaced) > LONGEST:
            raise SymbolicError("the text is too long")
        return replaced

    def symbolic(self, text: str) -> tuple[str, list[str]]:
        """Return a string with unknown parts as `$(arg robot)`, and the reasons."""
        reasons: list[str] = []

        def replaced(found: re.Match[str]) -> str:
            try:
                return self.text(found[0])
            except SymbolicError as reason:
                reasons.append(str(reason))
                return found[0] if found[0].startswith(_EVAL) else reason.text or found[0]

        if text.startswith(_EVAL) and text.endswith(")"):
            try:
                return self.text(text), []
            except SymbolicError as reason:
                return text, [str(reason)]
        whole = _ARGUMENT.sub(replaced, text)
        return (whole, reasons) if len(whole) <= LONGEST else (text, [*reasons, "the text is too long"])

    def _replaced(self, words: list[str]) -> str:
        command, *rest = words or [""]
        if command == "find" and len(rest) == 1:
            return self._found(rest[0])
        if command == "arg" and len(rest) == 1:
            return self._argument(rest[0])
        if command == "optenv" and rest and rest[0] not in ALWAYS_SET:
            return " ".join(rest[1:])
        if command == "dirname":
            return str(self.file.parent)
        if command == "anon" and rest:
            return rest[0]
        raise SymbolicError(f"$({' '.join(words)}) is known on the robot only")

    def _found(self, package: str) -> str:
        known = self.workspace.package(package)
        if known is None:
            raise SymbolicError(f"the package {package} is not in the workspace")
        return str(known.folder)

    def _argument(self, name: str) -> str:
        value = self.arguments.get(name)
        if value is None:
            raise SymbolicError(f"the argument {name} has no value")
        if "$(" in value:
            raise SymbolicError(f"the argument {name} is known on the robot only: {value}", value)
        return value

    def _evaluated(self, expression: str) -> Any:
        known = {key: one for key, one in self.arguments.items() if one is not None and "$(" not in one}
        names: dict[str, Any] = {key: scalar(one) for key, one in known.items()}
        names |= {"true": True, "false": False, "pi": math.pi, "e": math.e, "find": self._found}
        names |= {"arg": lambda name: scalar(self._argument(name)), "optenv": _otherwise}
        names["dirname"] = lambda: str(self.file.parent)
        try:
            value = constant(expression, names)
        except ValueError:
            raise SymbolicError(f"$(eval {expression}) is not a Python expression") from None
        if isinstance(value, Unknown | Library):
            raise SymbolicError(f"$(eval {expression}) is not constant")
        return value


def _otherwise(name: str, default: str = "") -> str:
    """Return the default of an environment variable, whose value is known only on the robot."""
    if name in ALWAYS_SET:
        raise SymbolicError(f"$(env {name}) is known on the robot only")
    return default


def scalar(text: str, kind: str = "auto") -> Scalar:
    """Convert a value to a `param` type: `int`, `double`, `bool`, `str`, or guessed for `auto`.

    Raises SymbolicError if the text does not fit the type.
    """
    stripped = text.strip()
    try:
        if kind in ("str", "string"):
            return text
        if kind == "int":
            return int(stripped)
        if kind in ("double", "float"):
            return float(stripped)
        if kind in ("bool", "boolean"):
            return {"true": True, "1": True, "false": False, "0": False}[stripped.lower()]
    except (ValueError, KeyError):
        raise SymbolicError(f"{text!r} is not of type {kind}") from None
    with contextlib.suppress(ValueError):
        return int(stripped)
    with contextlib.suppress(ValueError):
        return float(stripped)
    return _TRUTH.get(stripped.lower(), text)
