"""Find publish calls that go on when no message arrives, in loops and timers that never read the time."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence, Set
from typing import Final

from tarl_lint.model import Finding, Flow, Sink
from tarl_lint.read.source import Module

COMMANDS: Final = frozenset(
    [
        "Twist",
        "TwistStamped",
        "AckermannDrive",
        "AckermannDriveStamped",
        "Wrench",
        "WrenchStamped",
        "AttitudeTarget",
    ]
)
_NUMBERS: Final = frozenset(["Float32", "Float64", "Float32MultiArray", "Float64MultiArray"])
_MOTION: Final = re.compile(
    r"(?=.*(vel|speed|effort|torque|throttle|thrust|power|force|current|voltage|pwm|duty)).*(cmd|command|setpoint)"
)
_TIMES: Final = re.compile(
    r"\b(now|get_time|get_rostime|Time|time|monotonic|stamp|clock|timeout|wait_for_message|Duration)\b|watchdog|stale|"
    r"last_|_time\b|elapsed|_age\b|\bage\b|fresh|alive|heartbeat|deadman|counter|countdown|received|_new\b|\bnew_|updated"
)
# uses of the time that do not compare it: pauses, timers, and the stamps of messages
_SLEEPS: Final = re.compile(
    r"\bheader\.stamp\s*=(?!=)[^,\n]*|\bstamp=[^=,\n][^,\n]*\(\)|"
    r"\btime\.sleep\(|\bimport time\b|\bDuration\([^)]*\)|create_(wall_)?timer\([^)]*\)|rospy\.Timer\([^)]*\)"
)


def stale(findings: Sequence[Finding], modules: Sequence[Module]) -> tuple[Finding, ...]:
    """Return the flows into commands that a timer or loop publishes again and again from the last message.

    One function receives the message; another one publishes it and clears nothing that the first one stored. No word in
    the program suggests that it checks the age of the message.
    """
    texts = {module.path: _SLEEPS.sub("", module.text) for module in modules}
    trees = {module.path: module.tree for module in modules}
    if any(_TIMES.search(text) for text in texts.values()):
        return ()
    callbacks = {
        name.strip()
        for one in findings
        if one.flow is not None
        for name in one.flow.source.callback.split(",")
    }
    return tuple(
        one
        for one in findings
        if one.flow is not None
        and _repeated(one.flow, texts, callbacks)
        and not _consumed(one.flow, trees.get(one.flow.sink.span.path))
    )


def commands(sink: Sink) -> bool:
    """Return whether a publish call sends a command to move: by its type, or numbers on a topic with such a name."""
    if sink.type in _NUMBERS:
        return any(_MOTION.match(topic.lower()) for topic in sink.topics)
    return sink.type in COMMANDS


def _consumed(flow: Flow, tree: ast.Module | None) -> bool:
    """Return whether the function that publishes an attribute also resets this attribute to a constant."""
    name = flow.sink.qualname.rpartition(".")[2]
    used = " ".join(step.code for step in flow.steps if step.site.qualname == flow.sink.qualname)
    return any(
        re.search(rf"{re.escape(ast.unparse(target))}\b", used)
        for function in (ast.walk(tree) if tree is not None else ())
        if isinstance(function, ast.FunctionDef) and function.name == name
        for node in ast.walk(function)
        if isinstance(node, ast.Assign) and _reset(node.value)
        for target in node.targets
        if isinstance(target, ast.Attribute) and ast.unparse(target.value) == "self"
    )


def _reset(value: ast.expr) -> bool:
    """Return whether a value is a constant, or a new object without arguments."""
    if isinstance(value, ast.Call):
        return not value.args and not value.keywords and isinstance(value.func, ast.Name)
    return isinstance(value, ast.Constant)


def _repeated(flow: Flow, texts: Mapping[str, str], every: Set[str]) -> bool:
    """Return whether the publish call of a flow runs outside all callbacks of messages."""
    if flow.kind != "explicit" or not commands(flow.sink) or "ubscri" not in flow.source.api:
        return False
    callbacks = {name.strip() for name in flow.source.callback.split(",")}
    if flow.sink.qualname in every or not callbacks - {""}:
        return False
    stored = [step for step in flow.steps if step.site.qualname in callbacks and step.role == "assign"]
    attributes = {found[1] for step in stored if (found := re.match(r"self\.(\w+)\b[^=]*=", step.code))}
    if not attributes:
        return False
    cleared = "|".join(map(re.escape, sorted(attributes)))
    text = texts.get(flow.sink.span.path, "")
    used = rf"self\.({cleared})\b"
    publishing = [step for step in flow.steps if step.site.qualname == flow.sink.qualname]
    called = re.search(rf"self\.{re.escape(flow.sink.qualname.rpartition('.')[2])}\(", text)
    return (
        called is None
        and not re.search(rf"{used}\s*=\s*None", _without_init(text))
        and any(re.search(used, step.code) for step in publishing)
    )


def _without_init(text: str) -> str:
    """Return a text without its `__init__` methods, in which attributes start as None."""
    return re.sub(r"def __init__\(.*?(?=\n    def |\n\S|\Z)", "", text, flags=re.DOTALL)
