"""Records of the ends of flows (subscriptions and publish calls) and of publishers."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Literal

from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Obj

NAMESPACE = "topic_ns"  # field of a marker server that holds the namespace of its topics
Kind = Literal["topic", "service", "action", "transform"]


class DefaultName(str):
    """A topic that a parameter, the environment or the command line may replace."""

    __slots__ = ()


@dataclass(slots=True, eq=False)
class SourceRecord:
    """A subscription: its place, its topics, and the nodes at which its messages arrive.

    `key` distinguishes subscriptions at the same place: by their topics or, for a launch file, by their call
    contexts. `contexts` are the call contexts and iterations of unrolled loops in which the place is reached.
    `types` are the names of the types without packages; `whole_types` are the names with packages ("" if a package
    is unknown).
    """

    path: str
    pos: ir.Pos
    key: tuple[Hashable, ...]
    api: str
    module: str
    qualname: str
    statement: ir.Stmt
    frame: Frame
    topics: set[str] = field(default_factory=set)
    types: set[str] = field(default_factory=set)
    whole_types: set[str] = field(default_factory=set)
    callbacks: set[str] = field(default_factory=set)
    nodes: set[int] = field(default_factory=set)
    registered: set[tuple[str, ir.Pos]] = field(default_factory=set)
    via: set[tuple[str, ir.Pos]] = field(default_factory=set)
    messages: dict[Hashable, Obj] = field(default_factory=dict)
    kind: Kind = "topic"
    contexts: set[tuple[Hashable, ...]] = field(default_factory=set)


@dataclass(slots=True, eq=False)
class SinkRecord:
    """A publish call: its place and its topics.

    `contexts` are the call contexts and iterations of unrolled loops in which the place is reached.
    """

    path: str
    pos: ir.Pos
    api: str
    module: str
    qualname: str
    topics: set[str] = field(default_factory=set)
    types: set[str] = field(default_factory=set)
    nodes: set[int] = field(default_factory=set)
    # (path, position) of each call that creates one of the publishers
    publishers: set[tuple[str, ir.Pos]] = field(default_factory=set)
    kind: Kind = "topic"
    contexts: set[tuple[Hashable, ...]] = field(default_factory=set)


@dataclass(slots=True, eq=False)
class Acceptance:
    """The decision of an action server whether a goal runs: the return value of its `goal_callback`.

    `node` is the decision. `answers` are the nodes of the returned values, with the name or constant of each.
    """

    node: int
    answers: dict[int, Hashable] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class Publisher:
    """A publisher: its topics, types (as in SourceRecord), the place of its creation, and whether it is used.

    `nodes` are the objects whose method made the publisher.
    """

    topics: set[str] = field(default_factory=set)
    types: set[str] = field(default_factory=set)
    whole_types: set[str] = field(default_factory=set)
    api: str = ""
    path: str = ""
    pos: ir.Pos = (0, 0, 0, 0)
    used: bool = False
    kind: Kind = "topic"
    methods: frozenset[str] = frozenset(["publish"])  # names of the methods that send a message
    nodes: set[Obj] = field(default_factory=set)
