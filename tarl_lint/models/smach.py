"""Models of smach's state machines: states that calls add, and the order in which their outcomes let them run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from tarl_lint.interpret.interpreter import Interpreter
from tarl_lint.interpret.invocation import Invocation
from tarl_lint.interpret.run_order import Group, Kind
from tarl_lint.memory import userdata
from tarl_lint.memory.values import BOTTOM, UNKNOWN, Obj, Value, inherited_from, pointer
from tarl_lint.models import sizes

# kinds of objects that a library can call if it gets them as arguments
LATER = frozenset(["closure", "bound", "partial"])
KINDS: Final[Mapping[str, Kind]] = {
    "StateMachine": "machine",
    "Sequence": "machine",
    "Iterator": "machine",
    "Concurrence": "fork",
}
# class → its module, if the module's name is not that of the class
MODULES: Final = {"StateMachine": "state_machine"}
MACHINES: Final = tuple(
    f"smach.{path}{name}" for name in KINDS for path in ("", f"{MODULES.get(name, name.lower())}.")
)
STARTS: Final = "set_initial_state"
CONTAINS: Final = "set_contained_state"
ADDS: Final = frozenset(["add", "add_auto", CONTAINS, STARTS])
CONNECTOR: Final = "connector_outcome"


def new_machine(ctx: Interpreter, it: Invocation) -> Value:
    """Return a new container of states; `outcomes` are the outcomes of its machine."""
    made = ctx.ops.generic(ctx, it.name, it.arguments, it.frame, it.call)
    for obj in made.objects:
        _describe(ctx, obj, it.name, it)
    return made


def _describe(ctx: Interpreter, obj: Obj, name: str, it: Invocation) -> None:
    kind = name.rpartition(".")[2]
    group = ctx.groups.setdefault(obj, Group(KINDS[kind]))
    plain, named = it.arguments
    if kind == "Sequence":
        connects = named.get(CONNECTOR, plain[1] if len(plain) > 1 else UNKNOWN).texts()
        group.goes_on = connects[0] if connects else ""
    if kind == "Concurrence":
        group.offers = frozenset(_texts(ctx, named.get("outcomes", plain[0] if plain else UNKNOWN)))


def _texts(ctx: Interpreter, listed: Value) -> list[str]:
    return [text for one in sizes.unpacked(ctx, listed) or () for text in one.texts()]


def add_state(ctx: Interpreter, it: Invocation) -> Value:
    """Add a state to the machine of the innermost `with`; `remapping` maps names of the state to shared fields."""
    opened = [o for value in reversed(ctx.opened) for o in value.objects if holds_states(ctx, o)]
    add(ctx, opened[0] if opened else None, it)
    return UNKNOWN


def holds_states(ctx: Interpreter, obj: Obj) -> bool:
    """Return whether an object is a container of states."""
    return obj in ctx.groups or (
        obj.kind == "instance" and not inherited_from(pointer(obj)).isdisjoint(MACHINES)
    )


def add(ctx: Interpreter, machine: Obj | None, it: Invocation) -> Value:
    """Add a state to a machine, or set its initial state."""
    plain, named = it.arguments
    labels = it.argument((0, "label")).texts()
    states = plain[1] if len(plain) > 1 else named.get("state", UNKNOWN)
    remapping = plain[3] if len(plain) > 3 else named.get("remapping", UNKNOWN)
    for renaming in _tables(ctx, remapping):
        pairs = [(n, texts[0]) for n, texts in renaming]
        for state in states.objects:
            userdata.rename(ctx, state, pairs)
    group = None
    if machine is not None:
        base = sorted(inherited_from(pointer(machine)) & set(MACHINES)) if machine.kind == "instance" else []
        kind = KINDS[base[0].rpartition(".")[2]] if base else "machine"
        group = ctx.groups.setdefault(machine, Group(kind))
    if group is None or len(labels) != 1:
        return UNKNOWN
    for state in states.objects:
        if state.kind in ("lib", "instance"):
            group.add(labels[0], state)
    _connect(ctx, group, labels[0], it)
    return UNKNOWN


def _connect(ctx: Interpreter, group: Group[Obj], label: str, it: Invocation) -> None:
    """Note where the outcomes of a state lead."""
    third = (2, "connector_outcomes" if it.name.endswith("add_auto") else "transitions")
    transitions = it.argument((3, "transitions")) if it.name.endswith("add_auto") else it.argument(third)
    for table in _tables(ctx, transitions):
        for outcome, targets in table:
            group.ways.setdefault((label, outcome), {}).update(dict.fromkeys(targets))
    if it.name.endswith("add_auto"):
        for outcome in _texts(ctx, it.argument(third)):
            group.automatic.setdefault(label, {})[outcome] = None
    if it.name.endswith(CONTAINS):  # these outcomes start the next iteration
        for outcome in _texts(ctx, it.argument((2, "loop_outcomes"))):
            group.ways.setdefault((label, outcome), {})[label] = None


def set_initial(ctx: Interpreter, machine: Obj, it: Invocation) -> Value:
    """Set the first state of a machine."""
    labels = _texts(ctx, it.argument((0, "initial_states")))
    if machine in ctx.groups and labels:
        ctx.groups[machine].first = labels[0]
    return UNKNOWN


def _tables(ctx: Interpreter, mapping: Value) -> Iterator[list[tuple[str, tuple[str, ...]]]]:
    """Yield the texts under the keys of each possible mapping."""
    if mapping is BOTTOM:
        return
    ctx.look(mapping.pts)
    for table in mapping.objects:
        held = ((n, ctx.store.get((table, n))) for n in list(table.fields) if n.startswith("['"))
        yield [(n[2:-2], v.texts()) for n, v in held if v is not None and v.texts()]


def call(ctx: Interpreter, machine: Obj, it: Invocation) -> Value:
    """Call a method of a container of states that adds a state or sets the first one."""
    return set_initial(ctx, machine, it) if it.name == STARTS else add(ctx, machine, it)
