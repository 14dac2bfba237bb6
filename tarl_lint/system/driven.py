"""Find publishers that repeat commands without input, such as a patrol."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Final

from tarl_lint.interpret.fixpoint import Linker
from tarl_lint.ir.nodes import Pos
from tarl_lint.model import Finding
from tarl_lint.read.source import Module
from tarl_lint.system.command_topics import is_command
from tarl_lint.system.staleness import Program
from tarl_lint.trees import last_name

# fields of commands that make something move
_FIELDS: Final = frozenset(
    ["x", "y", "z", "linear", "angular", "force", "torque", "data", "speed", "velocity", "velocities", "position",
     "positions", "points", "effort", "steering_angle", "acceleration", "throttle", "thrust", "yaw_rate", "body_rate",
     "channels", "controls", "displacements"]
)  # fmt: skip


def driven(
    machine: Linker, findings: Sequence[Finding], modules: Sequence[Module]
) -> frozenset[tuple[str, Pos]]:
    """Return the places (file and position) at which a program makes publishers that repeat commands.

    A publisher counts if a timer or a loop makes its publish call, and no flow ends there. The program must set some
    field of a message to a value other than zero: a node that only stops the robot does not count.
    """
    # numbers may be commands, too, depending on the launched topic name
    sent = [one for one in machine.sinks.values() if one.kind == "topic" and any(
        is_command(kind, ("command",)) for kind in one.types)]  # fmt: skip
    if not sent or not any(_moves(module.tree) for module in modules):
        return frozenset()
    ends = {(one.flow.sink.span.path, one.flow.sink.span.line) for one in findings if one.flow is not None}
    program = Program(modules, set())
    return frozenset(
        made
        for one in sent
        if (one.path, one.pos[0]) not in ends
        and program.repeats(one.qualname.rpartition(".")[2], one.path, one.pos[0])
        for made in one.publishers
    )


def _moves(tree: ast.Module) -> bool:
    """Return whether code sets a command's field to a nonzero value."""
    for node in ast.walk(tree):
        match node:
            case ast.Assign(targets=targets, value=value):
                fields = [one.attr for target in targets for one in _targets(target)]
            case ast.AugAssign(target=ast.Attribute(attr=attr), value=value):
                fields = [attr]
            case ast.Call(func=func, args=[value]) if last_name(func).startswith(("Float", "Int", "UInt")):
                fields = ["data"]
            case ast.keyword(arg=str(name), value=value):
                fields = [name]
            case _:
                continue
        if not _FIELDS.isdisjoint(fields) and not _zero(value):
            return True
    return False


def _targets(target: ast.expr) -> list[ast.Attribute]:
    parts = target.elts if isinstance(target, ast.Tuple | ast.List) else [target]
    return [one for one in parts if isinstance(one, ast.Attribute)]


def _zero(value: ast.expr) -> bool:
    """Return whether a value is zero, false or None, or a new object without arguments."""
    if isinstance(value, ast.Tuple | ast.List):
        return all(map(_zero, value.elts))
    if isinstance(value, ast.Call):
        return not value.args and not value.keywords
    return isinstance(value, ast.Constant) and not value.value
