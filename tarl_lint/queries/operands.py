"""Operands: the expressions that a repair may replace. Numbers are included, but not indices, sizes or rates."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Final, Protocol

from tarl_lint.ir import nodes as ir
from tarl_lint.memory.values import Value

NOT_BEHAVIOUR: Final = frozenset(
    [
        "Rate", "create_rate", "sleep", "range", "zeros", "ones", "empty", "reshape", "deque", "Subscriber",
        "Publisher", "create_subscription", "create_publisher", "create_timer", "create_service", "Timer", "Service",
        "declare_parameter", "declare_parameters", "waitKey", "namedWindow", "QoSProfile", "init_node", "spin_once",
        "wait_for_message", "wait_for_service", "get_parameter", "zfill", "ljust", "rjust", "seed", "time_ns",
    ]
)  # fmt: skip
MOST_NUMBERS: Final = 16  # maximum number of literals in a list or table whose numbers a repair may change
TIMING: Final = frozenset(
    ["sleep", "Rate", "create_rate", "create_timer", "Timer"]
)  # names of calls whose first argument is a duration or a frequency
PERIODS: Final = frozenset(["period", "timer_period_sec", "seconds", "secs", "hz", "frequency"])
PARAMETER_CALLS: Final = frozenset(["get_param"])
READING: Final = frozenset(["get", "getattr"])  # calls that read a stored value
LOGGING: Final = frozenset(
    [
        "info",
        "debug",
        "warn",
        "warning",
        "error",
        "fatal",
        "loginfo",
        "logdebug",
        "logwarn",
        "logerr",
        "print",
    ]
)


class Constant(Protocol):
    """A constant: its value, or None if it is not a number or only known at run time."""

    @property
    def value(self) -> bool | int | float | None:
        """Return the value."""
        ...


class Constants(Protocol):
    """Interface of a query for the constants of an expression."""

    def of(self, expr: ir.Expr, value: Value | None) -> Collection[Constant]:
        """Return the origins of an expression's constants; empty if the expression is not constant."""
        ...

    def entries(self, value: Value | None, index: Value | None) -> object:
        """Return the origins of the entries of a table of constants; a falsy value for other expressions."""
        ...


def uses(statement: ir.Stmt, values: Mapping[ir.Pos, Value], constants: Constants) -> Iterator[ir.Expr]:
    """Yield the expressions of a statement that may be constants, outermost first."""
    for expr in _expressions(statement):
        yield from _inside(expr, values, constants)


def timing_uses(
    statement: ir.Stmt, values: Mapping[ir.Pos, Value], constants: Constants
) -> Iterator[ir.Expr]:
    """Yield possibly constant expressions that set a waiting time or a rate."""
    for call in _timing_calls(_expressions(statement)):
        for when in [*call.arguments[:1], *(value for name, value in call.keywords if name in PERIODS)]:
            yield from _inside(when, values, constants)


def sets_timing(statement: ir.Stmt) -> bool:
    """Return whether a statement waits or sets a rate."""
    return any(True for _ in _timing_calls(_expressions(statement)))


def fills_an_object(statement: ir.Stmt) -> bool:
    """Return whether a statement passes arguments to a call, or stores a list or table of a few numbers."""
    if not isinstance(statement, (ir.Assign, ir.Evaluate)) or getattr(statement, "augmented", False):
        return False
    inner = [*_all(_expressions(statement))]
    if any(isinstance(one, ir.Call) and (one.arguments or one.keywords) for one in inner):
        return True
    numbers = sum(isinstance(one, ir.Const) and type(one.value) in (int, float) for one in inner)
    displays = any(isinstance(one, (ir.SequenceDisplay, ir.MappingDisplay)) for one in inner)
    return displays and numbers <= MOST_NUMBERS


def constructions(statement: ir.Stmt) -> list[ir.Call]:
    """Return the calls of a statement whose function is a name, as in `Wheel(0.16)`."""
    inner = _all(_expressions(statement))
    return [one for one in inner if isinstance(one, ir.Call) and isinstance(one.function, ir.Name)]


def _all(expressions: Iterable[ir.Expr]) -> Iterator[ir.Expr]:
    """Yield the parts of which a value is made, outermost first."""
    for expr in expressions:
        yield expr
        if isinstance(expr, ir.Call):
            yield from _all([*expr.arguments, *(value for _, value in expr.keywords)])
        else:
            yield from _all(_parts(expr))


def _timing_calls(expressions: Sequence[ir.Expr]) -> Iterator[ir.Call]:
    for expr in expressions:
        if isinstance(expr, ir.Call):
            name = expr.function.name if isinstance(expr.function, (ir.Name, ir.Attribute)) else ""
            if name in TIMING:
                yield expr
            else:
                yield from _timing_calls(expr.arguments)


def _expressions(statement: ir.Stmt) -> Sequence[ir.Expr]:
    """Return the expressions that a statement's header evaluates, without assignment targets."""
    if isinstance(statement, ir.Assign):
        if statement.augmented and isinstance(statement.value, ir.Operation):
            return statement.value.parts[1:]
        return [statement.value]
    if isinstance(statement, (ir.Evaluate, ir.Return, ir.Raise)):
        return [statement.value] if statement.value is not None else []
    if isinstance(statement, ir.If):
        return [statement.test]
    if isinstance(statement, ir.Loop):
        return [statement.source]
    if isinstance(statement, ir.With):
        return [context for context, _ in statement.items]
    return []


def _inside(expr: ir.Expr, values: Mapping[ir.Pos, Value], constants: Constants) -> Iterator[ir.Expr]:
    if isinstance(expr, (ir.Const, ir.Name)):
        yield expr
        return
    if isinstance(expr, (ir.Attribute, ir.Item)):
        if constants.of(expr, values.get(expr.pos)) or _entry(expr, values, constants):
            yield expr
        else:
            yield from _inside(expr.base, values, constants)
        return
    if isinstance(expr, ir.Call):
        yield from _call(expr, values, constants)
        return
    for part in _parts(expr):
        yield from _inside(part, values, constants)


def _entry(expr: ir.Attribute | ir.Item, values: Mapping[ir.Pos, Value], constants: Constants) -> bool:
    """Return whether an expression selects a number from a table by a computed index."""
    if not isinstance(expr, ir.Item):
        return False
    return bool(constants.entries(values.get(expr.pos), values.get(expr.index.pos)))


def _call(expr: ir.Call, values: Mapping[ir.Pos, Value], constants: Constants) -> Iterator[ir.Expr]:
    function = expr.function
    name = function.name if isinstance(function, (ir.Name, ir.Attribute)) else ""
    if name in PARAMETER_CALLS:
        yield expr
        return
    if name in NOT_BEHAVIOUR or name in LOGGING:
        return
    passed = name in READING or not (_literals(expr) or _takes_constant(expr, values, constants))
    if passed and constants.of(expr, values.get(expr.pos)):
        yield expr
        return
    if isinstance(function, ir.Attribute) and not isinstance(function.base, ir.Name):
        yield from _inside(function.base, values, constants)
    for argument in expr.arguments:
        yield from _inside(argument, values, constants)
    for keyword, argument in expr.keywords:
        if keyword not in ("queue_size", "qos_profile", "timeout", "timeout_sec", "dtype", "axis"):
            yield from _inside(argument, values, constants)


def _literals(expr: ir.Call) -> bool:
    """Return whether a call has a literal number as argument."""
    given = [*expr.arguments, *(value for _, value in expr.keywords)]
    return any(isinstance(each, ir.Const) and isinstance(each.value, (int, float)) for each in given)


def _takes_constant(expr: ir.Call, values: Mapping[ir.Pos, Value], constants: Constants) -> bool:
    """Return whether a call has a named constant as argument; in `math.cos(YAW)`, a repair changes YAW."""
    given = [*expr.arguments, *(value for _, value in expr.keywords)]
    named = (one for one in given if isinstance(one, (ir.Name, ir.Attribute, ir.Item, ir.Call)))
    origins = (origin for one in named for origin in constants.of(one, values.get(one.pos)))
    return any(origin.value is not None for origin in origins)


def _parts(expr: ir.Expr) -> Sequence[ir.Expr]:
    """Return the subexpressions that contribute to the value as numbers."""
    if isinstance(expr, ir.Operation):
        lists = [one for one in expr.parts if isinstance(one, ir.SequenceDisplay)]
        # the value does not contain the other operand as a number: in `[0.1] * 5`, 5 is a size
        return () if expr.operator == "text" else lists or expr.parts
    if isinstance(expr, ir.Choice):
        return (expr.test, expr.then, expr.other)
    if isinstance(expr, ir.SequenceDisplay):
        return expr.items
    if isinstance(expr, ir.MappingDisplay):
        return [value for _, value in expr.items]
    if isinstance(expr, ir.Comprehension):
        return [expr.element, *(c for _, _, conditions in expr.loops for c in conditions)]
    if isinstance(expr, (ir.Starred, ir.Walrus, ir.Yield)):
        return (expr.value,)
    return ()
