"""Data types of a system: programs with their interfaces, the nodes that run them, and flows across nodes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

from tarl_lint.files import shown
from tarl_lint.model import Cut, Finding, Kind, Span
from tarl_lint.parameter_names import ParameterName
from tarl_lint.read.source import SourceError
from tarl_lint.system.sensor_drivers import offered
from tarl_lint.workspace.conditions import exclusive
from tarl_lint.workspace.launch_model import LaunchedNode, Setting
from tarl_lint.workspace.model import Problem
from tarl_lint.workspace.name_resolution import joined, remapped

Role = Literal[
    "publishes", "subscribes", "serves", "calls", "performs", "asks"
]  # what a node does with a name; `asks` means sending goals to an action server


@dataclass(frozen=True, slots=True)
class Qos:
    """Quality of service; a part is None if it is not constant in the code."""

    reliable: bool | None = None
    latched: bool | None = None  # whether the durability is "transient local"


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A use of a topic or service in a program. `names` are the names in the code; empty if they are unknown.

    If names contain parameters, `written` has the names as in the code, and `names` has the names with the values
    at launch. `type` is the type without its package. `whole_type` is `package/Name`, or "" if the type is unknown
    or may be one of several. `driven` says whether the program publishes commands or numbers repeatedly without any
    input.
    """

    role: Role
    names: tuple[str, ...]
    type: str
    span: Span
    qos: Qos | None = None
    place: str = ""  # qualified name of the function that contains the use
    written: tuple[str, ...] = ()
    whole_type: str = ""
    driven: bool = False

    @property
    def in_code(self) -> tuple[str, ...]:
        """Return the names before any launch."""
        return self.written or self.names


@dataclass(frozen=True, slots=True)
class Misfit:
    """A use of a field that its message type does not have."""

    type: str
    field: str
    span: Span
    place: str


@dataclass(frozen=True)
class Interface:
    """The topics, services and parameters of a program, by the names in its code.

    `flows` are the findings TARL101 to TARL103. `name` is the node's name in the code; "" if it is computed.
    `words` are all strings in the program. `parameters` is True if `words` includes every parameter that the
    program reads. `closed` is True if the program imports no code that could use topics on its own. `whole` is True
    if, in addition, all topics have constant names and the analysis was complete. `in_names` are the parameters
    that names contain; `deciding` are the parameters used in conditions. `stale` are publish calls that go on
    without new messages; `misfits` are uses of fields that a message type lacks. `uses` are uses of fields of types
    `package/Name` that are unknown here; their fields are dotted paths. `configured` are the classes
    `PACKAGE.cfg.NAMEConfig`, whose `.cfg` files name further parameters. `complete` is True if all endpoints of the
    program are known, though some may have no known name. `private_words` are the words that only private names
    (`~path`) contain. `exact` are the names of all parameters that the program reads, without `~`; None if some of
    them are not known. `private` are the parameters that a program of rospy reads only as private ones; `public`
    are those that it reads only in its namespace. `cut` are the parts that exhausted the budget of the analysis.
    """

    path: str
    name: str = ""
    package: str = ""
    endpoints: tuple[Endpoint, ...] = ()
    flows: tuple[Finding, ...] = ()
    words: frozenset[str] = frozenset()
    parameters: bool = False
    closed: bool = False
    whole: bool = False
    stale: tuple[Finding, ...] = ()
    misfits: tuple[Misfit, ...] = ()
    deciding: tuple[str, ...] = ()
    in_names: tuple[ParameterName, ...] = ()
    uses: tuple[Misfit, ...] = ()
    configured: tuple[str, ...] = ()
    complete: bool = False
    exact: frozenset[str] | None = None
    private_words: frozenset[str] = frozenset()
    private: frozenset[str] = frozenset()
    public: frozenset[str] = frozenset()
    cut: tuple[Cut, ...] = ()


@dataclass(frozen=True)
class Seen:
    """The topics and services of a node whose code was not read, from its C++ source or its arguments.

    `certain` is True if the node has no other topics and services, except those of transforms and parameters. `through`
    is True if data of each subscribed topic may reach each published topic. `kinds` are all types of messages and
    services that the node may use; None if they are unknown. `never` are types that it certainly does not use. `words`
    are the words of the names that the node may give topics and services; None if it may use any words.
    """

    ends: tuple[Endpoint, ...] = ()
    certain: bool = False
    through: bool = True
    kinds: frozenset[str] | None = None
    never: frozenset[str] = frozenset()
    words: frozenset[str] | None = None

    def may_use(self, kind: str) -> bool:
        """Return whether the node may use a type of messages or services."""
        return kind in self.kinds if self.kinds is not None else kind not in self.never

    def may_offer(self, kind: str, names: Sequence[str], texts: Iterable[str]) -> bool:
        """Return whether the node may use a type under a name, given its values `texts`."""
        if not self.may_use(kind):
            return False
        return self.words is None or any(offered(one, self.words) for one in names) or mention(texts, names)


@dataclass(frozen=True)
class Instance:
    """A launched node. Without an interface, `unread` is the reason why the node's program was not read.

    `broken` is the error in the node's Python file, if it has one.
    """

    node: LaunchedNode
    name: str
    interface: Interface | None = None
    unread: str = ""
    known: Seen = Seen()  # known facts about a node that could not be read
    silent: bool = False  # whether the node publishes nothing that other nodes subscribe to
    # for an unread node: the usable remappings of its launch groups
    meant: tuple[tuple[str, str], ...] = ()
    broken: SourceError | None = None

    def resolve(self, name: str) -> str:
        """Return the launched name of a topic or service in the code."""
        own = self.name.rpartition("/")[2]
        return remapped(name, self.node.namespace, own, self.node.remaps)

    @property
    def seen(self) -> tuple[Endpoint, ...]:
        """Return the known endpoints of an unread node."""
        return self.known.ends

    @property
    def certain(self) -> tuple[Endpoint, ...]:
        """Return the endpoints that the node certainly has."""
        if self.interface is not None:
            return self.interface.endpoints
        return self.seen if self.known.certain else ()

    @property
    def whole(self) -> bool:
        """Return whether the node certainly has no endpoints but the known ones."""
        return self.silent or (self.known.certain if self.interface is None else self.interface.whole)

    def may_use(self, kind: str) -> bool:
        """Return whether the node may have an unknown endpoint of a type."""
        if self.whole:
            return False
        if self.interface is None:
            return self.known.may_use(kind)
        unnamed = [one.type.split(" | ") for one in self.interface.endpoints if not one.names]
        return not self.interface.complete or any(
            kind in types or not {"", "AnyMsg"}.isdisjoint(types) for types in unnamed
        )

    def may_name(self, name: str) -> bool:
        """Return whether the node may have an unknown endpoint with this launched name."""
        if self.interface is not None or self.known.words is None or name.startswith(f"{self.name}/"):
            return True
        return offered(name, self.known.words)

    def ends(self, role: Role) -> Iterator[tuple[str, Endpoint]]:
        """Yield a role's endpoints with known names, as launched."""
        yield from self._launched(self.certain, role)

    def named(self, role: Role) -> Iterator[tuple[str, Endpoint]]:
        """Yield a role's endpoints, also those of an unread node."""
        yield from self._launched(self.seen if self.interface is None else self.certain, role)

    def _launched(self, ends: Iterable[Endpoint], role: Role) -> Iterator[tuple[str, Endpoint]]:
        for one in ends:
            if one.role == role:
                for name in one.names:
                    yield self.resolve(name), one

    @cached_property
    def touched(self) -> tuple[str, ...]:
        """Return the launched topics in the remappings of an unread node."""
        names = {self.resolve(old) for old, _ in (*self.meant, *self.node.remaps[self.node.inherited :])}
        return () if self.interface is not None or self.seen else tuple(sorted(names))


@dataclass(frozen=True)
class Hop:
    """The flows of one node from one topic to another, explicit ones first; empty if the node was not read.

    `started` are the launched nodes with the name `node` that have these flows.
    """

    node: str
    source: str
    sink: str
    kind: Kind | Literal["not read"]
    findings: tuple[Finding, ...] = ()
    started: tuple[LaunchedNode, ...] = ()

    def excludes(self, other: Hop) -> bool:
        """Return whether the nodes of two hops are never started together."""
        pairs = [(one, two) for one in self.started for two in other.started]
        return bool(pairs) and all(exclusive(one, two) for one, two in pairs)


@dataclass(frozen=True)
class Chain:
    """A flow across nodes: a chain of hops."""

    hops: tuple[Hop, ...]

    @property
    def kind(self) -> Kind | Literal["not read"]:
        """Return `explicit` if all hops are, `not read` if a node is not, else `implicit`."""
        kinds = {hop.kind for hop in self.hops}
        return "not read" if "not read" in kinds else "implicit" if "implicit" in kinds else "explicit"


@dataclass(frozen=True)
class System:
    """The nodes of one launch file. Hops and chains are sorted.

    `messages` are the fields of types `package/Name` of the workspace that the nodes use, each with its type or "".
    `packages` are the packages of the workspace. `included` has the known facts about nodes of packages outside the
    workspace whose launch files are included. `ros2` is True for a launch file of ROS 2. `silenced` are the
    findings that comments silence, `disabled` those that `per-file-ignores` disables in their files.
    """

    file: Path
    instances: tuple[Instance, ...] = ()
    settings: tuple[Setting, ...] = ()
    hops: tuple[Hop, ...] = ()
    problems: tuple[Problem, ...] = ()
    findings: tuple[Finding, ...] = ()
    silenced: tuple[Finding, ...] = ()
    disabled: tuple[Finding, ...] = ()
    arguments: tuple[tuple[str, str], ...] = field(default=())
    messages: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    packages: frozenset[str] = frozenset()
    included: Mapping[str, Seen] = field(default_factory=dict)
    ros2: bool = False

    def able(self, end: Endpoint) -> Iterator[Instance]:
        """Yield the nodes that may have unknown endpoints with the type of an endpoint.

        Nodes of other packages do not use types that packages of this workspace define.
        """
        own = self._is_own(end)
        yield from (one for one in self.instances
                    if (not own or one.node.package in self.packages) and one.may_use(end.type))  # fmt: skip

    def _is_own(self, end: Endpoint) -> bool:
        """Return whether a package of the workspace defines the type of an endpoint."""
        return end.whole_type.partition("/")[0] in self.packages

    def hides(self, end: Endpoint, *names: str) -> bool:
        """Return whether an unread part of the launch may start a node with such an endpoint.

        `names` are the launched names that the endpoint may have. If a package of the workspace defines the type,
        launch files of other packages start no such node.
        """
        own = self._is_own(end)
        return any(
            one.hides
            and (not own or not one.package or one.package in self.packages)
            and self.included.get(one.package, Seen()).may_offer(end.type, names, one.given)
            for one in self.problems
        )

    def ends(self, role: Role) -> Iterator[tuple[str, Instance, Endpoint]]:
        """Yield the endpoints that all nodes have in a role, by launched name."""
        for instance in self.instances:
            for name, endpoint in instance.ends(role):
                yield name, instance, endpoint

    def named(self, role: Role) -> Iterator[tuple[str, Instance, Endpoint]]:
        """Yield the endpoints of a role by launched name, including the known endpoints of unread nodes."""
        for instance in self.instances:
            for name, endpoint in instance.named(role):
                yield name, instance, endpoint


def mention(texts: Iterable[str], names: Iterable[str]) -> bool:
    """Return whether a text contains the last part of a name, as a word."""
    lasts = "|".join(re.escape(name.rpartition("/")[2]) for name in names)
    word = re.compile(rf"(?<!\w)(?:{lasts})(?!\w)")
    return any(word.search(text) for text in texts)


def full_name(node: LaunchedNode, own: str) -> str:
    """Return the name of a launched node; `own` is its name in the code."""
    return joined(node.namespace, node.name or own or node.executable.rpartition("::")[2])


def place_of(instance: Instance) -> Span:
    """Return the place where a launch file starts a node."""
    line = max(instance.node.line, 1)
    return Span(shown(instance.node.file), line, 1, line, 2)
