"""The values that every stage of the linter hands on: frozen, standard library only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from tarl_lint.rule_codes import rule_codes

Dependence = Literal["data", "control", "context"]
Kind = Literal["explicit", "implicit"]
CODES: Final[Mapping[Kind, str]] = {"explicit": "TARL101", "implicit": "TARL102"}
OFF_BY_DEFAULT: Final = frozenset({"TARL103"})  # wanted only where they are named in full
RULES: Final = rule_codes()
Role = Literal["register", "receive", "assign", "call", "return", "condition", "publish"]


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A stretch of source text. Lines and columns count from 1; `end_column` is one past the last character.

    Columns are characters of the line, not UTF-8 bytes.
    """

    path: str
    line: int
    column: int
    end_line: int
    end_column: int


@dataclass(frozen=True, slots=True, order=True)
class SiteId:
    """A statement's identity, which survives moved lines.

    `text` is the statement as `ast.unparse` writes it, of a compound statement only its header;
    `ordinal` counts statements with the same module, qualified name and text, from 0 in file order.
    """

    module: str
    qualname: str
    text: str
    ordinal: int = 0

    def __str__(self) -> str:
        ordinal = f" #{self.ordinal + 1}" if self.ordinal else ""
        return f"{self.module}:{self.qualname or '<module>'}:{self.text}{ordinal}"


@dataclass(frozen=True, slots=True)
class Step:
    """One statement of a flow. Of a compound statement, `span` and `code` cover the header only."""

    site: SiteId
    span: Span
    code: str
    role: Role
    dependence: Dependence


@dataclass(frozen=True, slots=True)
class Source:
    """A message arriving through a subscription. `span` is the subscription call; `topics` is empty when unknown."""

    id: str
    span: Span
    topics: tuple[str, ...]
    type: str
    callback: str
    api: str
    registered: tuple[Span, ...] = ()
    via: tuple[Span, ...] = ()
    module: str = ""
    qualname: str = ""


@dataclass(frozen=True, slots=True)
class Sink:
    """The argument of a publish call. `span` is the call; `topics` is empty when unknown."""

    id: str
    span: Span
    topics: tuple[str, ...]
    type: str
    api: str
    module: str = ""
    qualname: str = ""


@dataclass(frozen=True, slots=True)
class Flow:
    """One (subscription, publish call) pair with its taint list: `steps` in topological order from the source.

    `chain` holds the places in `steps` of the shortest path from the message's arrival to the publish call: of data
    for an explicit flow, of data and decisions for an implicit one. It is empty where no single path was found.
    """

    kind: Kind
    source: Source
    sink: Sink
    steps: tuple[Step, ...]
    chain: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Finding:
    """One diagnostic: a flow (TARL101 to TARL103) or a hazard (TARL2xx).

    `package` is the ROS package, else Python's, else the script, that a finding begins in. Of a hazard, `about` is
    what it speaks of and `place` the qualified name of the function it is in: neither lines nor local names, so that it
    is known again in an edited file.
    """

    code: str
    span: Span
    message: str
    flow: Flow | None = None
    fingerprint: str = ""
    status: Literal["new", "accepted"] = "new"
    about: str = ""
    place: str = ""
    package: str = ""


@dataclass(frozen=True, slots=True, order=True)
class Cut:
    """A program that was too large to follow in every detail: flows of it may be missing.

    `path` is the file that is run, `node` the name of its node, "" where that is not written there.
    """

    path: str
    node: str = ""

    @property
    def message(self) -> str:
        """Say what that means."""
        node = f" (node {self.node})" if self.node else ""
        return f"{self.path}{node}: too large to follow in every detail; flows may be missing"


@dataclass(frozen=True, slots=True)
class Operand:
    """The use of a constant by a site: what a repair may replace.

    `span` is the expression that uses it, on the site's own lines; `code` its text (`5`, `self.kp`).
    `value` is the constant, or None when it is known only at run time (a parameter without default).
    `definition` is where the constant is written, equal to `span` for a literal.
    """

    site: SiteId
    span: Span
    code: str
    value: bool | int | float | None
    definition: Span | None = None

    @property
    def literal(self) -> bool:
        """Tell whether the constant is written at its use."""
        return self.definition == self.span
