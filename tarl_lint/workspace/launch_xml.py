"""Read ROS 1 launch files: nodes with namespaces, remappings and parameters. No command is run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final
from xml.etree.ElementTree import Element

from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.conditions import combined
from tarl_lint.workspace.launch_documents import LINE, xml_root
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.model import Problem, Workspace
from tarl_lint.workspace.name_resolution import joined, package_in
from tarl_lint.workspace.ros_arguments import ros1
from tarl_lint.workspace.substitutions import Scope, SymbolicError, scalar

DEEPEST: Final = 20  # maximum nesting of includes
LARGEST: Final = 1_000_000  # maximum size of a launch, text or YAML file (bytes)
MOST: Final = 5_000  # maximum number of elements of a launch file with its includes


@dataclass(frozen=True)
class _Place:
    """The context of an element: the substitutions of its file, and the settings of enclosing groups."""

    scope: Scope
    namespace: str = "/"
    remaps: tuple[tuple[str, str], ...] = ()
    private: tuple[Setting, ...] = ()  # private parameters that all following nodes get
    # (file, arguments) of each including file, outermost first
    including: tuple[object, ...] = ()
    visit: int = 0  # number of the file, in the order in which files were included
    condition: str = ""  # the enclosing condition, if it is known only on the robot


@dataclass
class _Reader:
    workspace: Workspace
    nodes: list[LaunchedNode] = field(default_factory=list)
    settings: list[Setting] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    arguments: set[str] = field(default_factory=set)  # names of the arguments of the outermost file
    required: set[str] = field(default_factory=set)  # names of the outermost file's arguments without a value
    seen: int = 0
    visits: int = 0  # number of files included so far
    before: list[int] = field(default_factory=list)  # for each node, the number of `settings` set before it

    def file(self, path: Path, arguments: Mapping[str, str | None], place: _Place | None) -> None:
        """Read a launch file with its arguments."""
        root = xml_root(path, self.problems)
        if root is not None:
            scope = Scope(self.workspace, path, dict(arguments))
            here = (path, frozenset(arguments.items()))
            if place is None:
                self.elements(root, _Place(scope, including=(here,)))
            elif here in place.including or len(place.including) > DEEPEST:
                said = "it includes itself" if here in place.including else "files include each other"
                raise SymbolicError(f"{path.name}: {said}")
            else:
                self.visits += 1
                inside = replace(place, scope=scope, including=(*place.including, here), visit=self.visits)
                self.elements(root, inside)

    def elements(self, parent: Iterable[Element], place: _Place) -> None:
        """Read the elements of a launch file or group, in order."""
        for element in parent:
            self.seen += 1
            if self.seen > MOST:
                return
            try:
                holds, unsure = self._holds(element, place)
                if holds:
                    inside = replace(place, condition=combined(place.condition, unsure))
                    place = replace(self._element(element, inside, unsure), condition=place.condition)
            except SymbolicError as reason:
                hides = element.tag in ("include", "group", "node")
                self._problem(
                    element,
                    place,
                    f"<{element.tag}>: {reason}",
                    hides=hides,
                    package=package_in(element.get("file", "")) if element.tag == "include" else "",
                    given=_given(element, place) if element.tag == "include" else (),
                )
                if (
                    element.tag == "param"
                    and "value" in element.attrib
                    and "$(" not in element.get("name", "")
                ):
                    place = self._set(place, _unset(element, place, place.namespace))

    def _element(self, element: Element, place: _Place, unsure: str) -> _Place:
        """Read one element; return the context of the following ones. `unsure` is the element's unknown condition."""
        if element.tag == "arg":
            return self._argument(element, place, unsure)
        if element.tag == "remap":
            pair = self._name(element, "from", place), self._name(element, "to", place)
            return replace(place, remaps=(*place.remaps, (pair[0], _perhaps(pair[1], unsure))))
        if element.tag == "group":
            namespace = joined(place.namespace, self._name(element, "ns", place))
            self.elements(element, replace(place, namespace=namespace))
        elif element.tag == "include":
            self._include(element, place)
        elif element.tag in ("node", "test"):
            self._node(element, place)
        elif element.tag in ("param", "rosparam"):
            setting = self._setting(element, place, place.namespace, unsure)
            return place if setting is None else self._set(place, setting)
        return place

    def _set(self, place: _Place, setting: Setting) -> _Place:
        """Add a parameter outside a node; return the context of the following elements."""
        if setting.name.startswith("~"):
            return replace(place, private=(*place.private, setting))
        self.settings.append(setting)
        return place

    def _argument(self, element: Element, place: _Place, unsure: str) -> _Place:
        name = element.get("name", "")
        if len(place.including) == 1 and "value" not in element.attrib:
            self.arguments.add(name)
            if "default" not in element.attrib and name not in place.scope.arguments:
                self.required.add(name)
        if name in place.scope.arguments and "value" not in element.attrib:
            return place  # the including file has set this argument, so its default is not used
        stated = element.get("value", element.get("default"))
        value: str | None = None
        if stated is not None:
            value = self._value(element, name, stated, place)
            if value != place.scope.arguments.get(name):
                value = _perhaps(value, unsure)
        arguments = {**place.scope.arguments, name: value}
        return replace(place, scope=replace(place.scope, arguments=arguments))

    def _include(self, element: Element, place: _Place) -> None:
        path = Path(place.scope.text(element.get("file", "")))
        if not path.is_file():
            raise SymbolicError(f"{path.name} does not exist")
        given: dict[str, str | None] = {}
        if element.get("pass_all_args", "").lower() in ("true", "1"):
            given = dict(place.scope.arguments)
        for one in element:
            holds, unsure = self._holds(one, place) if one.tag == "arg" else (False, "")
            if holds:
                name, stated = one.get("name", ""), one.get("value", one.get("default", ""))
                given[name] = _perhaps(self._value(one, name, stated, place), unsure)
        namespace = joined(place.namespace, self._name(element, "ns", place))
        self.file(path, given, replace(place, namespace=namespace))

    def _value(self, element: Element, name: str, stated: str, place: _Place) -> str:
        """Return the value of an argument; the value is symbolic if it is known only on the robot."""
        text, reasons = place.scope.symbolic(stated)
        for reason in reasons:
            self._problem(element, place, f"<arg name={name!r}>: {reason}")
        return text

    def _node(self, element: Element, place: _Place) -> None:
        """Read a node, or a test; rostest runs tests beside the nodes."""
        named = "name" if element.tag == "node" or "name" in element.attrib else "test-name"
        package, executable, name = (self._name(element, key, place) for key in ("pkg", "type", named))
        inner, settings = place, list(place.private)
        for one in element:
            try:
                holds, unsure = self._holds(one, place)
                if not holds:
                    continue
                if one.tag == "remap":
                    inner = self._element(one, inner, unsure)
                elif one.tag in ("param", "rosparam"):
                    setting = self._setting(one, place, "~", unsure)
                    settings += [setting] if setting is not None else []
            except SymbolicError as reason:
                self._problem(one, place, f"<{one.tag}> of {name}: {reason}")
                if one.tag == "param" and "$(" not in one.get("name", ""):
                    settings.append(_unset(one, place, "~"))
        arguments = self._name(element, "args", place)
        given = ros1(arguments)
        settings += [Setting(one, place.scope.file, yaml=value) for one, value in given.parameters]
        namespace = joined(place.namespace, given.namespace or self._name(element, "ns", place))
        own = inner.remaps[len(place.remaps) :]
        line = int(element.get(LINE, "0"))
        self.before.append(len(self.settings))
        self.nodes.append(
            LaunchedNode(
                package,
                executable,
                name,
                namespace,
                place.scope.file,
                line,
                (*place.remaps, *given.remaps, *own),
                tuple(settings),
                arguments,
                "test" if element.tag == "test" else "node",
                place.condition,
                inherited=len(place.remaps),
                anonymous=f"file {place.visit}" if "$(anon " in element.get("name", "") else "",
            )
        )

    def _setting(self, element: Element, place: _Place, above: str, unsure: str) -> Setting | None:
        """Return a parameter, or the parameters of a file; unknown if they are set under an unknown condition."""
        made = (
            self._yaml(element, place, above)
            if element.tag == "rosparam"
            else self._param(element, place, above)
        )
        return replace(made, unknown=True) if made is not None and unsure else made

    def _param(self, element: Element, place: _Place, above: str) -> Setting | None:
        text = place.scope.text
        name = _param_name(above, text(element.get("name", "")))
        if "command" in element.attrib:
            raise SymbolicError(f"{name} is what a command prints on the robot")
        if "binfile" in element.attrib:
            raise SymbolicError(f"{name} is the content of a file that is not text")
        kind = element.get("type", "auto")
        if "textfile" in element.attrib:
            return Setting(name, place.scope.file, self._read(Path(text(element.attrib["textfile"]))))
        value = text(element.get("value", "")).strip()
        if kind == "yaml":
            return Setting(name, place.scope.file, yaml=value)
        return Setting(name, place.scope.file, scalar(value, kind))

    def _yaml(self, element: Element, place: _Place, above: str) -> Setting | None:
        text = place.scope.text
        if element.get("command", "load") != "load":
            return None
        ns, param = text(element.get("ns", "")), text(element.get("param", ""))
        name = param if param.startswith("/") or not ns else f"{ns}/{param}"
        path = Path(text(element.attrib["file"])) if "file" in element.attrib else place.scope.file
        content = self._read(path) if "file" in element.attrib else element.text or ""
        if element.get("subst_value", "").lower() in ("true", "1"):
            content, reasons = place.scope.symbolic(content)
            for reason in reasons:
                self._problem(element, place, f"<rosparam>: {reason}")
        return Setting(_parameter(above, name.rstrip("/")), path, yaml=content)

    def _name(self, element: Element, key: str, place: _Place) -> str:
        """Return an attribute; parts known only on the robot are written as `$(…)`."""
        text, reasons = place.scope.symbolic(element.get(key, ""))
        for reason in reasons:
            self._problem(element, place, f"{key} of <{element.tag}>: {reason}")
        return text

    def _holds(self, element: Element, place: _Place) -> tuple[bool, str]:
        """Return whether `if` and `unless` keep an element.

        If the condition is unknown, the element is kept, and the condition is returned, too.
        """
        for key, wanted in (("if", True), ("unless", False)):
            if key in element.attrib:
                try:
                    return scalar(place.scope.text(element.attrib[key]), "bool") is wanted, ""
                except SymbolicError as reason:
                    self._problem(element, place, f"{key} of <{element.tag}>: {reason}")
                    return True, f"{key} {place.scope.symbolic(element.attrib[key])[0]}"
        return True, ""

    def _read(self, path: Path) -> str:
        try:
            return read_text(path, LARGEST)
        except UnreadableError as reason:
            raise SymbolicError(f"{path.name}: {reason}") from None

    def _problem(
        self,
        element: Element,
        place: _Place,
        reason: str,
        *,
        hides: bool = False,
        package: str = "",
        given: tuple[str, ...] = (),
    ) -> None:
        line = int(element.get(LINE, "0"))
        problem = Problem(place.scope.file, line, reason, hides, package, given)
        if problem not in self.problems:
            self.problems.append(problem)


def read_xml(path: Path, workspace: Workspace, arguments: Mapping[str, str] | None = None) -> Launch:
    """Read a ROS 1 launch file, with defaults for missing arguments."""
    reader = _Reader(workspace)
    reader.file(path, dict(arguments or {}), None)
    nodes = zip(reader.nodes, reader.before, strict=True)
    return Launch(
        path,
        tuple(_overridden(node, reader.settings[count:]) for node, count in nodes),
        tuple(reader.settings),
        tuple(reader.problems),
        tuple(sorted(reader.arguments)),
        required=tuple(sorted(reader.required)),
    )


def _overridden(node: LaunchedNode, later: Iterable[Setting]) -> LaunchedNode:
    """Return a node with the private parameters that the launch file sets after the node, outside it."""
    full = joined(node.namespace, node.name)
    within = (one for one in later if node.name and f"{one.name}/".startswith(f"{full}/"))
    own = (replace(one, name=f"~{one.name[len(full) :].lstrip('/')}") for one in within)
    return replace(node, settings=(*node.settings, *own))


def _given(include: Element, place: _Place) -> tuple[str, ...]:
    """Return the values that an <include> passes on."""
    stated = (one.get("value", one.get("default", "")) for one in include if one.tag == "arg")
    return tuple(place.scope.symbolic(one)[0] for one in stated)


def _unset(param: Element, place: _Place, above: str) -> Setting:
    """Return a parameter whose value is known only on the robot."""
    return Setting(_param_name(above, param.get("name", "")), place.scope.file, unknown=True)


def _perhaps(text: str, condition: str) -> str:
    """Return a string that is valid under a condition; it is symbolic unless the condition is ""."""
    return f"$({text} {condition})" if condition else text


def _param_name(above: str, name: str) -> str:
    """Return the name of the parameter that a <param> sets; inside a <node>, it is private even with a slash."""
    return _parameter(above, name.lstrip("/") if above == "~" else name)


def _parameter(above: str, name: str) -> str:
    """Return the name of a parameter: private inside a node or with `~`, else absolute."""
    if name.startswith("~") or (above == "~" and not name.startswith("/")):
        return "~" + name.lstrip("~").strip("/")
    return joined(above if above != "~" else "/", name)
