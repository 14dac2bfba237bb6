"""Substitutions of ROS 2 launch files, and their strings.

A string known only on the robot stays symbolic: it contains the values on which it depends as `$(…)`, as in `/$(var
robot)/odom`.
"""

from __future__ import annotations

import posixpath
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.python.evaluator import Library, Unknown, constant
from tarl_lint.workspace.python.libraries import LIBRARIES
from tarl_lint.workspace.python.paths import FilePath
from tarl_lint.workspace.python.values import SpentError
from tarl_lint.workspace.substitutions import ALWAYS_SET

TRUE: Final = frozenset({"true", "1"})
FALSE: Final = frozenset({"false", "0"})
DEEPEST: Final = 50  # maximum nesting of a value
LONGEST: Final = 100_000  # maximum length of a text (characters)
WORK: Final = 300_000  # maximum number of substitutions that are replaced for one launch file
# names for expressions: those of `math`, with and without `math.`
_NAMES: Final = {"math": Library("math"), **{name.removeprefix("math."): value for name, value in LIBRARIES.items()
                                             if name.startswith("math.")}}  # fmt: skip


@dataclass
class Context:
    """The context of an action: its file, and the settings of earlier actions. Each group gets a copy."""

    workspace: Workspace
    file: Path
    configurations: dict[str, str] = field(default_factory=dict)
    namespace: str = "/"
    # remappings and parameters that all following nodes get. In launch_ros, a group shares a list with its
    # surroundings unless the list is empty, so elements that a group appends also apply after the group
    remaps: list[tuple[str, str]] = field(default_factory=list)
    settings: list[Setting] = field(default_factory=list)
    # names of the launch configurations that were read; shared by all groups
    asked: set[str] = field(default_factory=set)
    # number of substitutions that may still be replaced; shared by all groups
    left: list[int] = field(default_factory=lambda: [WORK])
    readable: frozenset[str] = frozenset({"launch_configurations", "perform_substitution"})
    saved: list[Context] = field(default_factory=list)  # contexts saved by PushLaunchConfigurations
    environment: dict[str, str] = field(default_factory=dict)  # variables that the launch file sets

    def spend(self) -> None:
        """Count a substitution. Raises SpentError if there were too many substitutions."""
        self.left[0] -= 1
        if self.left[0] < 0:
            raise SpentError("it has too many substitutions")

    @property
    def launch_configurations(self) -> dict[str, Any]:
        """Return the launch configurations for the function of an OpaqueFunction."""
        return _Configurations(self.asked, {name: known(text) for name, text in self.configurations.items()})

    def perform_substitution(self, value: Any) -> Any:
        """Return the text of a substitution for the function of an OpaqueFunction; Unknown if it is symbolic."""
        return known(performed(value, self))

    def inside(self) -> Context:
        """Return the context of a group; its settings do not apply outside the group."""
        return Context(
            self.workspace,
            self.file,
            dict(self.configurations),
            self.namespace,
            self.remaps or [],
            self.settings or [],
            self.asked,
            self.left,
            environment=dict(self.environment),
        )

    def reset(self) -> None:
        """Forget all launch configurations. The package launch keeps namespace, remappings and parameters there."""
        self.configurations = {}
        self.namespace, self.remaps, self.settings = "/", [], []

    def restore(self, other: Context) -> None:
        """Take the launch configurations of another context."""
        self.configurations = dict(other.configurations)
        self.namespace, self.remaps, self.settings = other.namespace, other.remaps, other.settings


class _Configurations(dict[str, Any]):
    """Launch configurations that record which of them are read."""

    readable: ClassVar = frozenset({"get", "items", "keys", "values"})

    def __init__(self, asked: set[str], values: dict[str, Any]) -> None:
        super().__init__(values)
        self._asked = asked

    def __getitem__(self, name: str) -> Any:
        self._asked.add(name)
        return super().__getitem__(name)

    def __contains__(self, name: object) -> bool:
        self._asked.add(str(name))
        return super().__contains__(name)

    def get(self, name: str, default: Any = None) -> Any:
        """Return a value, or the default."""
        self._asked.add(name)
        return super().get(name, default)


class Substitution:
    """A string that depends on the context. Launch files call `perform` in an OpaqueFunction."""

    readable: ClassVar = frozenset({"perform"})

    def text(self, context: Context, depth: int) -> str:
        """Return the text in a context."""
        raise NotImplementedError

    def perform(self, context: Any) -> Any:
        """Return the text; Unknown if it is symbolic."""
        return known(performed(self, context)) if isinstance(context, Context) else Unknown(0, "perform")


@dataclass(frozen=True)
class Configuration(Substitution):
    """`LaunchConfiguration(name, default=…)`, `$(var name)`."""

    name: Any
    default: Any = None

    def text(self, context: Context, depth: int) -> str:
        """Return the value of the launch argument."""
        name = performed(self.name, context, depth)
        context.asked.add(name)
        if name in context.configurations:
            return context.configurations[name]
        return f"$(var {name})" if self.default is None else performed(self.default, context, depth)


@dataclass(frozen=True)
class Joined(Substitution):
    """A list of substitutions, or the parts of a path (`between` is a slash)."""

    parts: tuple[Any, ...]
    between: str = ""

    def text(self, context: Context, depth: int) -> str:
        """Return the joined texts of the parts."""
        texts = [performed(part, context, depth) for part in self.parts]
        return posixpath.join(*texts) if self.between and texts else "".join(texts)


@dataclass(frozen=True)
class Anonymous(Substitution):
    """`AnonName`, `$(anon name)`: a name that the robot makes unique; here without the unique part."""

    name: Any

    def text(self, context: Context, depth: int) -> str:
        """Return the name."""
        return performed(self.name, context, depth)


@dataclass(frozen=True)
class Expression(Substitution):
    """`PythonExpression([…])`, `$(eval …)`: evaluated if it is constant."""

    parts: tuple[Any, ...]

    def text(self, context: Context, depth: int) -> str:
        """Return the value as text."""
        whole = "".join(performed(part, context, depth) for part in self.parts)
        try:
            value = constant(whole, _NAMES)
        except ValueError:
            return f"$(eval {whole})"
        return f"$(eval {whole})" if isinstance(value, Unknown | Library) else str(value)


@dataclass(frozen=True)
class Comparison(Substitution):
    """`EqualsSubstitution` and `NotEqualsSubstitution`."""

    left: Any
    right: Any
    equal: bool = True

    def text(self, context: Context, depth: int) -> str:
        """Return `true` or `false`."""
        one, other = (performed(side, context, depth) for side in (self.left, self.right))
        if symbolic(one) or symbolic(other):
            return f"$({'equals' if self.equal else 'not-equals'} {one} {other})"
        truths = truth(one), truth(other)
        same = one == other if None in truths else truths[0] == truths[1]
        return str(same is self.equal).lower()


@dataclass(frozen=True)
class Logic(Substitution):
    """`not`, `and`, `or` of truth values."""

    kind: str
    operands: tuple[Any, ...]

    def text(self, context: Context, depth: int) -> str:
        """Return `true` or `false`."""
        texts = [performed(one, context, depth) for one in self.operands]
        values = [truth(one) for one in texts]
        if None in values:
            return f"$({self.kind} {' '.join(texts)})"
        found = not values[0] if self.kind == "not" else all(values) if self.kind == "and" else any(values)
        return str(found).lower()


@dataclass(frozen=True)
class Choice(Substitution):
    """`IfElseSubstitution`."""

    condition: Any
    then: Any = ""
    otherwise: Any = ""

    def text(self, context: Context, depth: int) -> str:
        """Return the text of the selected branch."""
        holds = truth(performed(self.condition, context, depth))
        if holds is None:
            return f"$(if {performed(self.condition, context, depth)})"
        return performed(self.then if holds else self.otherwise, context, depth)


@dataclass(frozen=True)
class Package(Substitution):
    """`FindPackageShare`: the source folder of a workspace package stands for its share directory."""

    name: Any
    # function that returns the folder of a package
    found: Callable[[Any], Any] | None = field(default=None, compare=False)
    readable: ClassVar = frozenset({"perform", "find"})

    def text(self, context: Context, depth: int) -> str:
        """Return the folder."""
        name = performed(self.name, context, depth)
        found = context.workspace.package(name)
        return f"$(find-pkg-share {name})" if found is None else str(found.folder)

    def find(self, name: Any) -> Any:
        """Return the folder of a package; launch files call this before there is a context."""
        return Unknown(0, "find") if self.found is None else self.found(name)


@dataclass(frozen=True)
class Here(Substitution):
    """`ThisLaunchFileDir` and `ThisLaunchFile`."""

    whole: bool = False

    def text(self, context: Context, depth: int) -> str:  # noqa: ARG002 - shared signature
        """Return the path of the launch file, or of its folder."""
        return str(context.file if self.whole else context.file.parent)


@dataclass(frozen=True)
class Content(Substitution):
    """`FileContent`, `$(file-content path)`: the text of a file of the workspace."""

    path: Any

    def text(self, context: Context, depth: int) -> str:
        """Return the text of the file."""
        path = performed(self.path, context, depth)
        if not symbolic(path) and Path(path).is_relative_to(context.workspace.root):
            try:
                found = read_text(Path(path), LONGEST)
            except UnreadableError:
                found = "$("
            if not symbolic(found):
                return found
        return f"$(file-content {path})"


@dataclass(frozen=True)
class OnRobot(Substitution):
    """A string known only on the robot: a command's output, an environment variable without a default."""

    what: str
    default: Any = None

    def text(self, context: Context, depth: int) -> str:
        """Return the value that the launch file sets, the default, or else the values on which it depends as `$(…)`."""
        kind, _, rest = self.what.partition(" ")
        if kind in ("env", "optenv") and rest.split(" ")[0] in context.environment:
            return context.environment[rest.split(" ")[0]]
        always = self.what.split()[1:2] and self.what.split()[1] in ALWAYS_SET
        return (
            f"$({self.what})" if self.default is None or always else performed(self.default, context, depth)
        )


def performed(value: Any, context: Context, depth: int = 0) -> str:
    """Return the text of a value, with substitutions replaced or symbolic."""
    context.spend()
    if depth > DEEPEST:
        return "$(too deep)"
    if isinstance(value, Substitution):
        return value.text(context, depth + 1)[:LONGEST]
    if isinstance(value, list | tuple):
        return "".join(performed(one, context, depth + 1) for one in value)[:LONGEST]
    if isinstance(value, Unknown):
        return f"$({value.text})"
    if isinstance(value, str | int | float | bool | FilePath):
        return str(value)
    return "$(unknown)" if value is not None else ""


def symbolic(text: str) -> bool:
    """Return whether a string depends on values known only on the robot."""
    return "$(" in text


def known(text: str) -> Any:
    """Return a string; Unknown if it is symbolic."""
    return Unknown(0, text.removeprefix("$(").removesuffix(")")) if symbolic(text) else text


def truth(text: str) -> bool | None:
    """Return the boolean that a string represents; None if it is symbolic or not a boolean."""
    plain = text.strip().lower()
    return True if plain in TRUE else False if plain in FALSE else None
