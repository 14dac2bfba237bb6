"""States of machines and behaviours of trees: the outcome of one of them decides whether others run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from typing import Final

from tarl_lint import catalog
from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.run_order import Dependence, Group, Part, dependences
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.value_flow_graph import Place
from tarl_lint.memory.values import Obj

BEHAVIOURS: Final = ("py_trees", "py_trees_ros")  # packages whose classes are bases of behaviours
UPDATES: Final = "update"  # method of a behaviour that returns its status
STARTS: Final = "initialise"
ENDS: Final = "terminate"  # method of a behaviour that is called when its status has changed


def part_of(ctx: Interpreter, obj: Obj, frame: Frame) -> Part:
    """Return the part that an object is in the value-flow graph."""
    part = ctx.parts.get(obj)
    if part is None:
        part = ctx.parts[obj] = Part(_decision(ctx, obj, "runs", frame), _decision(ctx, obj, "ended", frame))
    return part


def _decision(ctx: Interpreter, obj: Obj, what: str, frame: Frame, outcomes: Set[str] = frozenset()) -> int:
    """Return the node of a decision about a part."""
    place = Place(frame, None, "condition", (0, 0, 0, 0))
    return ctx.graph.node((what, obj.kind, obj.key, *sorted(outcomes)), place, frozenset())


def run_by_others(
    ctx: Interpreter, obj: Obj, closure: Obj, external: Set[str]
) -> tuple[Sequence[int], Part | None]:
    """Return the decisions whether a framework calls a method, and the object that receives the method's result."""
    packages = {name.partition(".")[0] for name in external}
    state = catalog.STATES in packages and closure.name == catalog.RUNS_STATE
    behaviour = not packages.isdisjoint(BEHAVIOURS) and closure.name in (UPDATES, STARTS, ENDS)
    if not (state or behaviour) or not isinstance(closure.info, tuple):
        return (), None
    part = part_of(ctx, obj, ctx.frames["module", closure.info[2].path])
    if closure.name in (UPDATES, catalog.RUNS_STATE):
        part.method = closure
    guards = (part.runs, part.ended) if closure.name == ENDS else (part.runs,)
    return guards, part if closure.name in (UPDATES, catalog.RUNS_STATE) else None


def group_of(ctx: Interpreter, obj: Obj, made: Group[Obj]) -> Group[Obj]:
    """Return the group of an object; if the object has no group yet, make one."""
    return ctx.groups.setdefault(obj, made)


def connect(ctx: Interpreter) -> bool:
    """Make parts depend on the outcomes of other parts that lead to them. Return whether any dependence is new."""
    if not ctx.groups:
        return False
    new = _represented(ctx)
    for part in ctx.parts.values():
        new |= _add(ctx, part.ended, _several(part.answers.items()))
    for one in dependences(ctx.groups, lambda obj: _outcomes(ctx, obj)):
        new |= _depend(ctx, one)
    return new


def _represented(ctx: Interpreter) -> bool:
    """Let objects whose method ran stand for the others of their class, if they are too many."""
    ran: dict[Obj, Part] = {}
    for part in ctx.parts.values():
        if part.answers and part.method is not None:
            ran.setdefault(part.method, part)
    new = False
    for part in ctx.parts.values():
        if part.method in ran and not part.answers and part.method is not None:
            first = ran[part.method]
            part.answers = first.answers
            new |= _add(ctx, first.runs, [part.runs])
    return new


def _add(ctx: Interpreter, node: int, decisions: Iterable[int]) -> bool:
    """Make a node depend on decisions. Return whether any of these dependences is new."""
    before = len(ctx.graph.control[node])
    ctx.graph.depend(node, decisions)
    return len(ctx.graph.control[node]) > before


def _outcomes(ctx: Interpreter, obj: Obj) -> frozenset[str]:
    part = ctx.parts.get(obj)
    return part.outcomes() if part is not None else frozenset()


def _depend(ctx: Interpreter, one: Dependence[Obj]) -> bool:
    """Add the edges of a dependence to the value-flow graph. Return whether any of the edges is new."""
    frame = next(iter(ctx.frames.values()))
    runs = part_of(ctx, one.part, frame).runs
    if one.outcomes == frozenset():  # the part is a member of a fork: it runs whenever the fork runs
        return _add(ctx, runs, [part_of(ctx, one.decider, frame).runs])
    if one.outcomes is None:
        answers = [n for part in _inside(ctx, one.decider) for n in _several(part.answers.items())]
    else:
        decider = ctx.parts.get(one.decider)
        answers = _several(decider.answers.items(), one.outcomes) if decider is not None else []
    if answers:
        node = _decision(
            ctx, one.decider, "led", ctx.graph.places[answers[0]].frame, one.outcomes or frozenset()
        )
        ctx.graph.places[node] = ctx.graph.places[answers[0]]
        return _add(ctx, node, answers) | _add(ctx, runs, [node])
    return False


def _several(answers: Iterable[tuple[int, frozenset[str] | None]], led: Set[str] | None = None) -> list[int]:
    """Return the nodes of the answers if the answers differ: in their outcomes, or in whether these are in `led`."""
    given = dict(answers)
    kinds: set[object] = set()
    for outcomes in given.values():
        if outcomes is None:
            return sorted(given)
        kinds |= outcomes if led is None else {outcome in led for outcome in outcomes}
    return sorted(given) if len(kinds) > 1 else []


def _inside(ctx: Interpreter, group: Obj) -> list[Part]:
    """Return the parts in a group, including those in its inner groups."""
    found: dict[Obj, None] = {}
    pending = [group]
    while pending:
        obj = pending.pop()
        if obj not in found:
            found[obj] = None
            pending += (
                [p for members in ctx.groups[obj].members.values() for p in members]
                if obj in ctx.groups
                else []
            )
    return [ctx.parts[obj] for obj in found if obj in ctx.parts]
