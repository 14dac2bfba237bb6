"""Models of py_trees: composites and decorators. The statuses of their children decide the order of execution."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.interpret.run_order import Group
from tarl_lint.memory import recency
from tarl_lint.memory.values import UNKNOWN, ClassInfo, Obj, Value, inherited_from, pointer
from tarl_lint.models import blackboards, containers, sizes, states_and_behaviours

SUCCESS, FAILURE, RUNNING = "SUCCESS", "FAILURE", "RUNNING"
STATUSES: Final = frozenset([SUCCESS, FAILURE, RUNNING])
PLACES: Final = ("py_trees.composites", "py_trees")
CHAINS: Final[Mapping[str, str]] = {"Sequence": SUCCESS, "Selector": FAILURE, "Chooser": FAILURE}
# decorator → the statuses of its child that the decorator replaces
RENAMES: Final[Mapping[str, Mapping[str, str]]] = {
    "Inverter": {SUCCESS: FAILURE, FAILURE: SUCCESS},
    "FailureIsRunning": {FAILURE: RUNNING},
    "FailureIsSuccess": {FAILURE: SUCCESS},
    "RunningIsFailure": {RUNNING: FAILURE},
    "RunningIsSuccess": {RUNNING: SUCCESS},
    "SuccessIsFailure": {SUCCESS: FAILURE},
    "SuccessIsRunning": {SUCCESS: RUNNING},
    "Retry": {FAILURE: RUNNING},
    "Repeat": {},
    "Timeout": {},
    "OneShot": {},
    "StatusToBlackboard": {},
    "PassThrough": {},
}
COMPOSITES: Final = tuple(f"{place}.{name}" for place in PLACES for name in (*CHAINS, "Parallel"))
DECORATORS: Final = tuple(f"py_trees.decorators.{name}" for name in RENAMES)
# behaviours of the library that always have the same status
CONSTANT: Final[Mapping[str, str]] = {"Success": SUCCESS, "Failure": FAILURE, "Running": RUNNING}
CONSTANTS: Final = tuple(f"py_trees.behaviours.{name}" for name in CONSTANT)
COMPARISON: Final = "py_trees.common.ComparisonExpression"
CHECKS: Final = tuple(
    f"py_trees.behaviours.{name}"
    for name in ("CheckBlackboardVariableValue", "WaitForBlackboardVariableValue", "BlackboardToStatus")
)
ADDS: Final = frozenset(["add_child", "add_children", "insert_child", "prepend_child"])
VARIABLE: Final = "variable"


def composite(ctx: Interpreter, it: Invocation) -> Value:
    """Return a composite with the children among its arguments."""
    made = _made(ctx, it)
    for obj in made.objects:
        group = states_and_behaviours.group_of(ctx, obj, _new_group(it.name.rpartition(".")[2]))
        for value in (*it.arguments[0], *it.arguments[1].values()):
            for child in _listed(ctx, value):
                _add(group, child)
    return made


def decorator(ctx: Interpreter, it: Invocation) -> Value:
    """Return a decorator with its child."""
    made = _made(ctx, it)
    for obj in made.objects:
        group = states_and_behaviours.group_of(ctx, obj, _new_group(it.name.rpartition(".")[2]))
        for value in (*it.arguments[0], *it.arguments[1].values()):
            for child in value.objects:
                _add(group, child)
    return made


def _made(ctx: Interpreter, it: Invocation) -> Value:
    """Return the new object of a class of a library. The object keeps no data of its children."""
    return pointer(recency.allocate(ctx, "lib", it.frame, ("made", it.call.slot)))


def _new_group(name: str) -> Group[Obj]:
    if name in RENAMES:
        return Group("wrapper", renames=RENAMES[name], offers=STATUSES)
    if name in CHAINS:
        return Group("chain", goes_on=CHAINS[name], offers=STATUSES)
    return Group("fork", offers=STATUSES)


def _listed(ctx: Interpreter, value: Value) -> Iterator[Obj]:
    """Yield the children in a list of children."""
    if any(obj.kind == "sequence" for obj in value.pts):
        known = sizes.unpacked(ctx, value)
        for one in known if known is not None else [containers.elements_of_any(ctx, value)]:
            yield from one.objects


def _add(group: Group[Obj], child: Obj) -> None:
    if child.kind in ("lib", "instance"):
        group.add(str(child.number), child)


def adds(ctx: Interpreter, target: Obj, name: str) -> bool:
    """Return whether a method adds children to a composite."""
    return name in ADDS and (target in ctx.groups or _kind(target) is not None)


def add(ctx: Interpreter, target: Obj, it: Invocation) -> Value:
    """Add children to a composite, or to an instance of a class that inherits from a composite."""
    group = states_and_behaviours.group_of(ctx, target, _new_group(_kind(target) or ""))
    for value in (*it.arguments[0][:1], *it.arguments[1].values()):
        for child in _listed(ctx, value) if it.name == "add_children" else value.objects:
            if it.name == "prepend_child":
                group.members = {str(child.number): {child: None}, **group.members}
            else:
                _add(group, child)
    return UNKNOWN


def _kind(target: Obj) -> str | None:
    """Return the name of the composite from which the class of an instance inherits; None for other objects."""
    if (
        target.kind != "instance"
        or not isinstance(target.info, Obj)
        or not isinstance(target.info.info, ClassInfo)
    ):
        return None
    names = sorted(n for n in inherited_from(pointer(target)) if n in COMPOSITES or n in DECORATORS)
    return names[0].rpartition(".")[2] if names else None


def inherit(ctx: Interpreter, target: Obj, it: Invocation) -> None:
    """Note the children that an instance passes to the constructor of its base class, if this is a composite."""
    kind = _kind(target)
    if kind is not None:
        group = states_and_behaviours.group_of(ctx, target, _new_group(kind))
        for value in (*it.arguments[0], *it.arguments[1].values()):
            for child in (*_listed(ctx, value), *(value.objects if kind in RENAMES else ())):
                _add(group, child)


def constant(ctx: Interpreter, it: Invocation) -> Value:
    """Return a behaviour that always has the same status."""
    made = _made(ctx, it)
    node = ctx.node(it.frame, ("status", it.call.slot), "condition")
    for obj in made.objects:
        status = CONSTANT[it.name.rpartition(".")[2]]
        states_and_behaviours.part_of(ctx, obj, it.frame).answers[node] = frozenset([status])
    return made


def comparison(ctx: Interpreter, it: Invocation) -> Value:
    """Return a comparison of a key of the blackboard with a value."""
    made = _made(ctx, it)
    for obj in made.objects:
        ctx.store.put((obj, VARIABLE), it.argument((0, VARIABLE)))
        ctx.store.put((obj, "value"), it.argument((1, "value")))
    return made


def check(ctx: Interpreter, it: Invocation) -> Value:
    """Return a behaviour whose status depends on a key of the blackboard."""
    made = _made(ctx, it)
    node = ctx.node(it.frame, ("status", it.call.slot), "condition")
    client = blackboards.any_client(ctx)
    for given in (*it.arguments[0][1:], *it.arguments[1].values()):
        names = given.texts() or tuple(t for o in given.objects if o.kind == "lib" for t in _variable(ctx, o))
        for name in names:
            ctx.graph.flow(ctx.use(blackboards.value_of(ctx, client, name)), node)
    for obj in made.objects:
        part = states_and_behaviours.part_of(ctx, obj, it.frame)
        ctx.graph.depend(node, [part.runs])
        part.answers[node] = None
    return made


def _variable(ctx: Interpreter, obj: Obj) -> tuple[str, ...]:
    stored = ctx.store.get((obj, VARIABLE))
    return stored.texts() if stored is not None else ()
