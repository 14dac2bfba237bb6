"""The two ends of flows as found, subscriptions and publish calls, and the publishers between."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Literal

from tarl_lint.ir import nodes as ir
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.values import Obj

Kind = Literal["topic", "service", "action", "transform"]


@dataclass(slots=True, eq=False)
class SourceRecord:
    """A subscription as found: where, what, and the nodes at which its messages arrive."""

    path: str
    pos: ir.Pos
    api: str
    module: str
    qualname: str
    statement: ir.Stmt
    frame: Frame
    topics: set[str] = field(default_factory=set)
    types: set[str] = field(default_factory=set)
    callbacks: set[str] = field(default_factory=set)
    nodes: set[int] = field(default_factory=set)
    registered: set[tuple[str, ir.Pos]] = field(default_factory=set)
    via: set[tuple[str, ir.Pos]] = field(default_factory=set)
    messages: dict[Hashable, Obj] = field(default_factory=dict)
    kind: Kind = "topic"


@dataclass(slots=True, eq=False)
class SinkRecord:
    """A publish call as found."""

    path: str
    pos: ir.Pos
    api: str
    module: str
    qualname: str
    topics: set[str] = field(default_factory=set)
    types: set[str] = field(default_factory=set)
    nodes: set[int] = field(default_factory=set)
    publishers: set[tuple[str, ir.Pos]] = field(default_factory=set)  # where they are made
    kind: Kind = "topic"


@dataclass(slots=True, eq=False)
class Publisher:
    """What a publisher object is for, where it is made, and whether anything publishes with it."""

    topics: set[str] = field(default_factory=set)
    types: set[str] = field(default_factory=set)
    api: str = ""
    path: str = ""
    pos: ir.Pos = (0, 0, 0, 0)
    used: bool = False
    kind: Kind = "topic"
    methods: frozenset[str] = frozenset(["publish"])  # those that send
