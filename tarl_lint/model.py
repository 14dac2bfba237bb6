"""Data types shared by all stages of the linter: frozen, standard library only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from tarl_lint.rule_codes import rule_codes

Dependence = Literal["data", "control", "context"]
Kind = Literal["explicit", "implicit"]
CODES: Final[Mapping[Kind, str]] = {"explicit": "TARL101", "implicit": "TARL102"}
OFF_BY_DEFAULT: Final = frozenset({"TARL103"})  # codes of rules that only their full code enables
RULES: Final = rule_codes()
Role = Literal["register", "receive", "assign", "call", "return", "condition", "publish"]


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A range of source text. Lines and columns count from 1; `end_column` is one past the last character.

    Columns count characters, not UTF-8 bytes.
    """

    path: str
    line: int
    column: int
    end_line: int
    end_column: int


@dataclass(frozen=True, slots=True, order=True)
class SiteId:
    """A statement's identity, which survives moved lines.

    `text` is the statement as `ast.unparse` formats it; for a compound statement, only its header. `ordinal` counts
    statements with the same module, qualified name and text, from 0 in file order.
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
    """One statement of a flow. For a compound statement, `span` and `code` cover the header only."""

    site: SiteId
    span: Span
    code: str
    role: Role
    dependence: Dependence


@dataclass(frozen=True, slots=True)
class Source:
    """A subscription at which messages arrive. `span` is the subscription call; `topics` is empty if unknown.

    `default_topics` is the part of `topics` that a parameter, the environment or the command line may replace.
    """

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
    default_topics: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Sink:
    """The argument of a publish call. `span` is the call; `topics` is empty if unknown.

    `default_topics` is the part of `topics` that a parameter, the environment or the command line may replace.
    """

    id: str
    span: Span
    topics: tuple[str, ...]
    type: str
    api: str
    module: str = ""
    qualname: str = ""
    default_topics: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Flow:
    """One (subscription, publish call) pair with its taint list: `steps` in topological order from the source.

    `chain` has the indices in `steps` of the shortest path from the message's arrival to the publish call. The path
    of an explicit flow follows data only. The path of an implicit flow follows data and conditions. `chain` is
    empty if no single path was found.
    """

    kind: Kind
    source: Source
    sink: Sink
    steps: tuple[Step, ...]
    chain: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Finding:
    """One diagnostic: a flow (TARL101 to TARL103) or a hazard (TARL2xx).

    `package` is where the finding begins: a ROS package if there is one, else a Python package, else a script. For
    a hazard, `about` is its subject and `place` the qualified name of its function. Neither of these two contains
    line numbers or local names, so the hazard is recognised in an edited file.
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
    """A program that exhausted its budget: some of its flows may be missing.

    `path` is the file that is run. `node` is the name of its node; "" if the name is not a literal.
    """

    path: str
    node: str = ""

    @property
    def message(self) -> str:
        """Return the message for the user."""
        node = f" (node {self.node})" if self.node else ""
        return f"{self.path}{node}: too large to analyse completely; flows may be missing"


@dataclass(frozen=True, slots=True)
class Operand:
    """A use of a constant by a site. A repair may replace the constant.

    `span` is the expression that uses the constant, on the site's own lines; `code` is the text of this expression
    (`5`, `self.kp`). `value` is the constant. It is None if it is known only at run time, as for a parameter
    without default. `definition` is the place where the constant is defined; for a literal, it equals `span`. An
    expression may stand for several constants, for example a parameter of a function with two calls. Then
    `definition` is None, and `definitions` contains all places. `setting` is the key of a value that is loaded from
    a file.
    """

    site: SiteId
    span: Span
    code: str
    value: bool | int | float | None
    definition: Span | None = None
    setting: str = ""
    definitions: tuple[Span, ...] = ()

    @property
    def literal(self) -> bool:
        """Return whether the constant is a literal at its use."""
        return self.value is not None and self.definition == self.span
