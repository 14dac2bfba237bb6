"""The compact form of functions: it has few kinds of statements and expressions, and resolved names."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

Pos = tuple[int, int, int, int]  # (line, column, end line, end column) as `ast` counts them
Scope = Literal["local", "free", "global"]
FunctionNode = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda


@dataclass(slots=True, eq=False)
class Const:
    """A literal, possibly signed; `known` caches its value."""

    value: object
    pos: Pos
    known: Any = None


@dataclass(slots=True, eq=False)
class Name:
    """A variable; for a free variable, `level` is the number of enclosing functions up to the one that owns it."""

    name: str
    scope: Scope
    level: int
    pos: Pos


@dataclass(slots=True, eq=False)
class Attribute:
    """`base.name`."""

    base: Expr
    name: str
    pos: Pos
    slot: int = 0


@dataclass(slots=True, eq=False)
class Item:
    """`base[index]`."""

    base: Expr
    index: Expr
    pos: Pos


@dataclass(slots=True, eq=False)
class Slice:
    """`lower:upper:step`, or another index that selects several elements."""

    parts: Sequence[Expr]
    pos: Pos
    bounds: Sequence[Expr | None] = ()  # `lower`, `upper` and `step`; None for a bound that is left out


@dataclass(slots=True, eq=False)
class Call:
    """A call; keyword None means `**`.

    `certain` marks a conversion that cannot fail, because a test around it has shown that its argument is a number.
    """

    function: Expr
    arguments: Sequence[Expr]
    keywords: Sequence[tuple[str | None, Expr]]
    pos: Pos
    slot: int
    certain: bool = False

    def inner(self, number: int = 0) -> Call:
        """Return a call that a library makes during this call, with its own slot; `number` counts such calls."""
        return replace(self, slot=-1000 * (abs(self.slot) + 1) - number)

    def inner_bare(self, number: int = 0) -> Call:
        """Return an inner call without the arguments that the source text has."""
        return replace(self.inner(number), arguments=(), keywords=())


@dataclass(slots=True, eq=False)
class Operation:
    """Any operator: the result contains the data of all parts.

    `operator` is set for operators that constant folding knows.
    """

    operator: str
    parts: Sequence[Expr]
    pos: Pos


@dataclass(slots=True, eq=False)
class Choice:
    """`then if test else other`."""

    test: Expr
    then: Expr
    other: Expr
    pos: Pos
    slot: int


@dataclass(slots=True, eq=False)
class SequenceDisplay:
    """A tuple, list or set literal."""

    items: Sequence[Expr]
    pos: Pos
    slot: int


@dataclass(slots=True, eq=False)
class MappingDisplay:
    """A dict literal; key None means `**`."""

    items: Sequence[tuple[Expr | None, Expr]]
    pos: Pos
    slot: int


@dataclass(slots=True, eq=False)
class Comprehension:
    """A comprehension or generator expression; that of a dict yields its values."""

    loops: Sequence[tuple[Expr, Expr, Sequence[Expr]]]
    key: Expr | None
    element: Expr
    pos: Pos
    slot: int
    node: ast.expr  # the syntax tree of `element`
    tests: Sequence[ast.expr] = ()  # the syntax trees of the conditions after `if`
    lazy: bool = False  # whether the evaluation may stop early, as in `all(part.ready() for part in parts)`


@dataclass(slots=True, eq=False)
class Starred:
    """`*value` among arguments, elements or targets."""

    value: Expr
    pos: Pos


@dataclass(slots=True, eq=False)
class Walrus:
    """`(target := value)`."""

    target: Expr
    value: Expr
    pos: Pos
    slot: int


@dataclass(slots=True, eq=False)
class Yield:
    """`yield value`, `yield from value` and `await value`."""

    value: Expr
    kind: Literal["yield", "from", "await"]
    pos: Pos


@dataclass(slots=True, eq=False)
class Parameter:
    """One parameter; `default` is lowered in the enclosing scope."""

    name: str
    kind: Literal["plain", "star", "keyword", "mapping"]
    default: Expr | None = None


@dataclass(slots=True, eq=False)
class Function:
    """A function or lambda. The body is lowered when the function is first called."""

    name: str
    qualname: str
    parameters: Sequence[Parameter]
    decorators: Sequence[Expr]
    node: FunctionNode
    module: str
    scope: object
    pos: Pos
    body: Sequence[Stmt] | None = None
    control: object = None
    # number of a statement → names of the exceptions that its calls raise, BLOCKED or SUSPENDED
    raising: dict[int, dict[str, None]] = field(default_factory=dict)
    generator: bool = False  # whether the function yields; only known once the body is lowered
    # whether the function registers something or starts a node; None until computed
    starts: bool | None = None
    answers: bool | None = None  # whether the function returns anything but None; None until computed

    def may_leave(self, statement: Stmt, name: str) -> None:
        """Record that a statement may not complete, and why; drop the control dependence if this is new."""
        known = self.raising.setdefault(statement.id, {})
        if name not in known:
            known[name] = None
            self.control = None


@dataclass(slots=True, eq=False)
class Lambda:
    """A lambda expression."""

    function: Function
    pos: Pos
    slot: int


Expr = (
    Const
    | Name
    | Attribute
    | Item
    | Slice
    | Call
    | Operation
    | Choice
    | SequenceDisplay
    | MappingDisplay
    | Comprehension
    | Starred
    | Walrus
    | Yield
    | Lambda
)


@dataclass(slots=True, eq=False)
class Stmt:
    """Base of all statements: a number within the function and the position of the header's first part."""

    id: int
    pos: Pos


@dataclass(slots=True, eq=False)
class Assign(Stmt):
    """Assignment; `augmented` if the value already contains the target's previous value."""

    targets: Sequence[Expr]
    value: Expr
    augmented: bool = False


@dataclass(slots=True, eq=False)
class Evaluate(Stmt):
    """An expression for its effect."""

    value: Expr


@dataclass(slots=True, eq=False)
class If(Stmt):
    """`if`, one `case` of `match`, or `assert` (whose `else` raises)."""

    test: Expr
    body: Sequence[Stmt]
    orelse: Sequence[Stmt] = ()


@dataclass(slots=True, eq=False)
class Loop(Stmt):
    """`while test` (without target) or `for target in source`."""

    source: Expr
    target: Expr | None
    body: Sequence[Stmt]
    orelse: Sequence[Stmt]
    endless: bool = False
    nodes: Sequence[ast.stmt] = ()  # the syntax trees of the body of a `for`
    end: int = 0  # of a `for`: its own number and those of the statements in its body are below this one

    def has(self, number: int) -> bool:
        """Return whether a number is the number of this `for`, or of a statement in its body."""
        return self.id <= number < self.end


@dataclass(slots=True, eq=False)
class Try(Stmt):
    """`try` with its handlers: (types, name to bind, body)."""

    body: Sequence[Stmt]
    handlers: Sequence[tuple[Expr | None, Name | None, Sequence[Stmt]]]
    orelse: Sequence[Stmt]
    final: Sequence[Stmt]


@dataclass(slots=True, eq=False)
class With(Stmt):
    """`with`: (context expression, target) and the body."""

    items: Sequence[tuple[Expr, Expr | None]]
    body: Sequence[Stmt]


@dataclass(slots=True, eq=False)
class Return(Stmt):
    """`return`, also the body of a lambda."""

    value: Expr | None


@dataclass(slots=True, eq=False)
class Raise(Stmt):
    """`raise`."""

    value: Expr | None


@dataclass(slots=True, eq=False)
class Jump(Stmt):
    """`break` or `continue`."""

    kind: Literal["break", "continue"]


@dataclass(slots=True, eq=False)
class Define(Stmt):
    """`def`, bound to its name."""

    target: Expr
    function: Function


@dataclass(slots=True, eq=False)
class Class(Stmt):
    """`class`: the body runs with the class as its frame."""

    target: Expr
    name: str
    qualname: str
    bases: Sequence[Expr]
    body: Sequence[Stmt]
    decorators: Sequence[Expr] = ()
    fields: tuple[str, ...] = ()  # names that the class body annotates, such as `x: int`
    only_named: frozenset[str] = frozenset()  # the fields after `_: KW_ONLY`
    keywords: Sequence[tuple[str, Expr]] = ()  # except the metaclass
    metaclass: Expr | None = None
    passed: frozenset[str] = frozenset()  # the `fields` with `InitVar`, which `__post_init__` gets
    control: object = None


@dataclass(slots=True, eq=False)
class Import(Stmt):
    """Bindings (target, dotted module, member or None); a member `*` imports all names of the module."""

    bindings: Sequence[tuple[Expr | None, str, str | None]]


@dataclass(slots=True, eq=False)
class Delete(Stmt):
    """`del`."""

    targets: Sequence[Expr]


@dataclass(slots=True, eq=False)
class Program:
    """A module's lowered top level; bodies of functions follow on demand."""

    name: str
    path: str
    body: Sequence[Stmt]
    function: Function
    package: str = ""
    takes_part: bool = True  # whether words in the module suggest that it subscribes or publishes
    stars: list[str] = field(default_factory=list)
