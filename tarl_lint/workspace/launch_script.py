"""Read Python scripts that start nodes with the `roslaunch` API of ROS 1. Nothing is executed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, Final

from tarl_lint.workspace import launch_reads
from tarl_lint.workspace.conditions import combined
from tarl_lint.workspace.launch_branches import BranchingInterpreter
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.launch_py import module_file
from tarl_lint.workspace.launch_xml import read_xml
from tarl_lint.workspace.model import Problem, Workspace
from tarl_lint.workspace.name_resolution import joined
from tarl_lint.workspace.python.evaluator import Unknown
from tarl_lint.workspace.python.paths import FilePath
from tarl_lint.workspace.ros_arguments import ros1

_PARENTS: Final = ("roslaunch.parent.ROSLaunchParent", "roslaunch.ROSLaunchParent")
_NODES: Final = ("roslaunch.core.Node", "roslaunch.Node")
_OF_NODE: Final = ("package", "node_type", "name", "namespace", "machine_name", "args")
MOST: Final = 100  # maximum number of launch files that a script starts


@dataclass
class _Started:
    """What a script starts so far."""

    nodes: list[LaunchedNode] = field(default_factory=list)
    settings: list[Setting] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    files: int = 0


@dataclass(frozen=True)
class _Api:
    """The `roslaunch` API during the interpretation of a script."""

    path: Path
    workspace: Workspace
    started: _Started = field(default_factory=_Started)
    interpreter: list[BranchingInterpreter] = field(default_factory=list)

    @property
    def file(self) -> BranchingInterpreter:
        """Return the interpreter of the script."""
        return self.interpreter[0]

    def models(self) -> dict[str, Any]:
        """Return the functions of the API by full name."""
        return {
            **dict.fromkeys(_PARENTS, self.parent),
            **dict.fromkeys(_NODES, self.node),
            "roslaunch.scriptapi.ROSLaunch": lambda *_, **__: _Script(self),
            "roslaunch.rlutil.resolve_launch_arguments": self.resolved,
            "rospkg.RosPack": lambda *_, **__: _RosPack(self),
            "roslib.packages.get_pkg_dir": self.folder,
            "rospy.myargv": lambda *_, **__: Unknown(self.file.line, "rospy.myargv()"),
            **launch_reads.models(self.workspace),
        }

    def parent(self, _: Any = None, roslaunch_files: Any = (), *__: Any, **___: Any) -> Unknown:
        """Start launch files, as paths or as pairs of a path and its arguments."""
        if not isinstance(roslaunch_files, list | tuple):
            self.problem(f"the launch files {_text(roslaunch_files)} are known on the robot only")
            roslaunch_files = ()
        for one in roslaunch_files:
            pair = isinstance(one, list | tuple) and len(one) == 2
            self.launch(one[0] if pair else one, one[1] if pair else ())
        return Unknown(self.file.line, "ROSLaunchParent")

    def launch(self, path: Any, arguments: Any = ()) -> None:
        """Start a launch file with arguments `name:=value`."""
        text = _text(path)
        if "$(" in text or self.started.files >= MOST:
            self.problem(f"the launch file {text} is known on the robot only")
            return
        file = Path(text) if Path(text).is_absolute() else self.path.parent / text
        if not file.is_file():
            self.problem(f"the launch file {file.name} does not exist")
            return
        given = (
            [_text(one).partition(":=") for one in arguments] if isinstance(arguments, list | tuple) else []
        )
        self.started.files += 1
        found = read_xml(file, self.workspace, {name: value for name, _, value in given})
        for node in found.nodes:
            anonymous = f"{node.anonymous} of {self.started.files}" if node.anonymous else ""
            condition = combined(self.file.condition, node.condition)
            self.started.nodes.append(replace(node, anonymous=anonymous, condition=condition))
        self.started.settings += found.settings
        self.started.problems += found.problems

    def node(self, *values: Any, remap_args: Any = (), **keywords: Any) -> Unknown:
        """Start a node."""
        given = {**dict(zip(_OF_NODE, values, strict=False)), **keywords}
        package, executable, name, namespace, _, arguments = (_text(given.get(key)) for key in _OF_NODE)
        named = ("package", "executable", "name", "namespace", "command line")
        for what, text in zip(named, (package, executable, name, namespace, arguments), strict=True):
            self.unknown(f"the {what} of a node", text)
        if isinstance(remap_args, Unknown):
            self.problem(f"the remappings of a node: `{remap_args.text}` is not constant", hides=False)
        stated = ros1(arguments)
        pairs = remap_args if isinstance(remap_args, list | tuple) else ()
        remaps = [
            (_text(one[0]), _text(one[1])) for one in pairs if isinstance(one, list | tuple) and len(one) == 2
        ]
        for old, new in remaps:
            self.unknown("a remapping of a node", old, new)
        self.started.nodes.append(
            LaunchedNode(
                package,
                executable,
                name or executable.partition(".")[0],
                joined("/", stated.namespace or namespace),
                self.path,
                self.file.line,
                (*stated.remaps, *remaps),
                tuple(Setting(one, self.path, yaml=value) for one, value in stated.parameters),
                arguments,
                condition=self.file.condition,
                anonymous="" if name else f"line {self.file.line}",
            )
        )
        return Unknown(self.file.line, "Node")

    def resolved(self, arguments: Any, *_: Any, **__: Any) -> Any:
        """Return the path of a launch file named by path or package."""
        words = (
            [one for one in arguments if isinstance(one, str)] if isinstance(arguments, list | tuple) else []
        )
        if len(words) > 1 and not words[0].endswith(".launch"):
            package = self.workspace.package(words[0])
            files = package.launch_files if package is not None else ()
            named = next((str(one) for one in files if one.name == words[1]), None)
            return [named if named is not None else Unknown(self.file.line, f"find {words[0]}/{words[1]}")]
        return words[:1]

    def folder(self, package: Any, *_: Any, **__: Any) -> Any:
        """Return the folder of a package."""
        known = self.workspace.package(package) if isinstance(package, str) else None
        return str(known.folder) if known is not None else Unknown(self.file.line, f"find {package}")

    def problem(self, reason: str, *, hides: bool = True) -> None:
        """Note what could not be read."""
        self.started.problems.append(Problem(self.path, self.file.line, reason, hides))

    def unknown(self, what: str, *texts: str) -> None:
        """Note a value of a node that is known only on the robot."""
        if any("$(" in one for one in texts):
            self.problem(f"{what} is known on the robot only: {' -> '.join(texts)}", hides=False)


@dataclass(frozen=True)
class _Script:
    """The script API, `roslaunch.scriptapi.ROSLaunch()`; a node starts as soon as it is made."""

    api: _Api
    readable: ClassVar = frozenset({"load"})

    def load(self, path: Any) -> None:
        """Start a launch file."""
        self.api.launch(path)


@dataclass(frozen=True)
class _RosPack:
    """`rospkg.RosPack()`."""

    api: _Api
    readable: ClassVar = frozenset({"get_path"})

    def get_path(self, package: Any) -> Any:
        """Return the folder of a package."""
        return self.api.folder(package)


def _text(value: Any) -> str:
    if isinstance(value, Unknown):
        return f"$({value.text})"
    return str(value) if isinstance(value, str | int | float | FilePath) else ""


def is_script(text: str) -> bool:
    """Return whether the text of a Python file starts nodes with the `roslaunch` API."""
    return "generate_launch_description" not in text and any(
        word in text for word in ("ROSLaunchParent", "scriptapi", "roslaunch.core", "roslaunch.Node")
    )


def read_script(path: Path, workspace: Workspace) -> Launch:
    """Read a script that uses the `roslaunch` API, as if it were run without arguments.

    Every node and launch file that the script creates counts as started. Launch files are those that a
    `ROSLaunchParent` gets.
    """
    api = _Api(path, workspace)
    api.interpreter.append(
        BranchingInterpreter(path, api.models(), lambda name: module_file(path, workspace, name))
    )
    api.file.problems = api.started.problems
    api.file.run()
    started = api.started
    if not started.nodes and not started.problems:
        api.problem("it starts no launch file or node that can be followed")
    return Launch(path, tuple(started.nodes), tuple(started.settings), tuple(_once(started.problems)))


def _once(problems: list[Problem]) -> Iterator[Problem]:
    yield from dict.fromkeys(problems)
