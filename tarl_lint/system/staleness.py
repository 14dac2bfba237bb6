"""Find publish calls that continue after the messages stop."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint.model import Finding, Flow
from tarl_lint.read.source import Module
from tarl_lint.system.command_topics import is_command
from tarl_lint.trees import children, last_name

_TIMES: Final = re.compile(
    r"\bnow\(|\b(get_time|get_rostime|Time|time|monotonic|stamp|clock|timeout|wait_for_message|Duration)\b|watchdog|stale|"
    r"last_|_time\b|elapsed|_age\b|\bage\b|fresh|alive|heartbeat|deadman|counter|countdown|received|_new\b|\bnew_|updated"
)
# words that show that a program has a watchdog, wherever they occur
_WATCHDOGS: Final = re.compile(
    r"watchdog|deadline|liveliness|SubscriptionEventCallbacks|heartbeat|deadman|wait_for_message|threading\.Timer\(|"
    r"oneshot\s*=\s*True"
)
# uses of time that compare no times: pauses, timers, stamps
_SLEEPS: Final = re.compile(
    r"\bheader\.stamp\s*=(?!=)[^,\n]*|\bstamp=[^=,\n][^,\n]*\(\)|"
    r"\btime\.sleep\(|\bimport time\b|\bDuration\([^)]*\)|create_(wall_)?timer\([^)]*\)|rospy\.Timer\([^)]*\)"
)
_TIMERS: Final = frozenset(["Timer", "create_timer", "create_wall_timer"])
# functions whose callbacks run for a message, a request, or once
_REGISTERS: Final = frozenset(
    ["Subscriber", "create_subscription", "registerCallback", "Service", "create_service", "SimpleActionServer",
     "ActionServer", "on_shutdown", "add_done_callback", "Server", "add_on_set_parameters_callback", "send_goal"]
)  # fmt: skip
_SETUP: Final = frozenset(["__init__", "on_configure", "on_activate", "setup"])
_Function = ast.FunctionDef | ast.AsyncFunctionDef


def stale(findings: Sequence[Finding], modules: Sequence[Module]) -> tuple[Finding, ...]:
    """Return the flows into commands that a timer or loop publishes repeatedly from the last message.

    One function receives the message and stores it, and another function publishes the command. No function that
    runs repeatedly clears the stored value, or seems to check the age of the message.
    """
    flows = [one.flow for one in findings if one.flow is not None]
    if not any(is_command(one.sink.type, one.sink.topics) for one in flows):
        return ()
    if any(_WATCHDOGS.search(_SLEEPS.sub("", module.text)) for module in modules):
        return ()
    program = Program(modules, {name for one in flows for name in _callbacks(one)})
    return tuple(one for one in findings if one.flow is not None and program.goes_on(one.flow))


def _callbacks(flow: Flow) -> set[str]:
    return {name.strip() for name in flow.source.callback.split(",")} - {""}


class Program:
    """The functions of a program by their names, and the calls between them. `callbacks` receive messages."""

    def __init__(self, modules: Sequence[Module], callbacks: set[str]) -> None:
        self._callbacks = callbacks
        self._handlers = {_last(name) for name in callbacks}
        self._timed: set[str] = set()  # functions that timers call
        self._ticks: list[ast.expr] = []  # callbacks of timers that are lambdas
        # function → names in its code, which may be properties and methods
        self._named: dict[str, set[str]] = {}
        self._texts = {module.path: module.text for module in modules}
        self._trees = {module.path: module.tree for module in modules}
        self._functions: dict[str, list[tuple[str, _Function | ast.Module]]] = {}
        # function → its callers, and whether each calls it in a loop
        self._callers: dict[str, list[tuple[str, bool]]] = {}
        for module in modules:
            self._functions.setdefault("", []).append((module.path, module.tree))
            self._read(module.path, module.tree, "", looped=False)

    def _read(self, path: str, node: ast.AST, inside: str, *, looped: bool) -> None:
        for child in children(node):
            if isinstance(child, _Function):
                self._functions.setdefault(child.name, []).append((path, child))
                self._read(path, child, child.name, looped=False)
                continue
            if isinstance(child, ast.Call):
                self._callers.setdefault(last_name(child.func), []).append((inside, looped))
                self._registered(child)
            elif isinstance(child, ast.Attribute | ast.Name):
                self._named.setdefault(inside, set()).add(last_name(child))
            again = looped or (isinstance(child, ast.While) and not isinstance(node, ast.expr))
            self._read(path, child, inside, looped=again)

    def _registered(self, call: ast.Call) -> None:
        given = [*call.args, *(one.value for one in call.keywords)]
        name = last_name(call.func)
        if name in _TIMERS and len(given) > 1:
            for one in given[1:]:
                called = (
                    one.args[0]
                    if isinstance(one, ast.Call) and last_name(one.func) == "partial" and one.args
                    else one
                )
                self._timed |= {last_name(called)} - {""}
                self._ticks += [one] if isinstance(one, ast.Lambda) else []
                self._timed |= {last_name(each.func) for each in ast.walk(one) if isinstance(each, ast.Call)}
        elif name in _REGISTERS:
            self._handlers |= {last_name(one) for one in given} - {""}

    def goes_on(self, flow: Flow) -> bool:
        """Return whether a command is published repeatedly from a stored message."""
        explicit = flow.kind == "explicit" and "ubscri" in flow.source.api
        if not explicit or not is_command(flow.sink.type, flow.sink.topics):
            return False
        sink = flow.sink
        if sink.qualname in self._callbacks or not self.repeats(
            _last(sink.qualname), sink.span.path, sink.span.line
        ):
            return False
        # functions that callbacks call may store the message
        storing = self._reached({_last(one) for one in _callbacks(flow)}) - self._running()
        after = [step for step in flow.steps if _last(step.site.qualname) not in storing]
        used = [
            one
            for one in self._stored(flow, storing)
            if any(re.search(_word(one), step.code) for step in after)
        ]
        publishing = {_last(step.site.qualname) for step in after if step.role != "register"}
        running = self._running() | {_last(flow.sink.qualname)} | (publishing - _SETUP - self._handlers)
        return (
            bool(used)
            and not self._checks_time(running)
            and not any(self._cleared(one, running) for one in used)
        )

    def _stored(self, flow: Flow, storing: set[str]) -> set[str]:
        """Return the attributes, globals and table elements that store the message."""
        found: set[str] = set()
        for step in flow.steps:
            name = re.match(r"(self\.\w+|\w+)\s*(\[[^\]]*\])*(\.\w+)*\s*=(?!=)", step.code)
            if name is None or _last(step.site.qualname) not in storing or step.role != "assign":
                continue
            if name[1].startswith("self.") or name[2] or self._shared(name[1], step.span.path):
                found.add(name[1])
        return found

    def _shared(self, name: str, path: str) -> bool:
        nodes = ast.walk(self._trees[path]) if path in self._trees else iter(())
        return any(isinstance(one, ast.Global | ast.Nonlocal) and name in one.names for one in nodes)

    def repeats(self, name: str, path: str, line: int) -> bool:
        """Return whether a timer or loop runs a line of a function."""
        if any(one.lineno <= line <= (one.end_lineno or 0) for one in self._ticks) or self._looped(
            name, path, line
        ):
            return True
        unknown = name in self._functions and name not in self._callers
        if unknown and name not in self._handlers | _SETUP | {"", "execute"}:
            return True  # no caller is known, so any code may call the function
        pending, seen = [name], {name}
        while pending:
            one = pending.pop()
            if one in self._timed and one not in self._handlers:
                return True
            for caller, looped in self._callers.get(one, ()):
                if caller in self._handlers:
                    continue
                if looped:
                    return True
                pending += [caller] if caller not in seen else []
                seen.add(caller)
        return False

    def _looped(self, name: str, path: str, line: int) -> bool:
        """Return whether a line of a function is in a `while` loop of this function."""
        return any(
            isinstance(node, ast.While) and node.lineno <= line <= (node.end_lineno or 0)
            for where, function in self._functions.get(name, ())
            if where == path
            for node in _own(function)
        )

    def _running(self) -> set[str]:
        """Return the functions that timers and loops call, directly or through other functions."""
        found = {name for name in self._timed if name in self._functions}
        found |= {name for name, callers in self._callers.items() if name in self._functions and any(
            looped and caller not in self._handlers for caller, looped in callers)}  # fmt: skip
        return self._reached(found)

    def _reached(self, found: set[str]) -> set[str]:
        """Return functions and all functions that they may call."""
        pending = [*found]
        while pending:
            fresh = (self._named.get(pending.pop(), set()) & self._functions.keys()) - found
            found |= fresh
            pending += fresh
        return found

    def _checks_time(self, running: set[str]) -> bool:
        for name in self._reached({*running}):
            for path, function in self._functions.get(name, ()):
                if _TIMES.search(_SLEEPS.sub("", self._text(path, function))):
                    return True
        return False

    def _text(self, path: str, function: _Function | ast.Module) -> str:
        """Return the text of a function, or of a module's loops."""
        lines = self._texts[path].split("\n")
        if isinstance(function, _Function):
            return "\n".join(lines[function.lineno - 1 : function.end_lineno])
        loops = (one for one in _own(function) if isinstance(one, ast.While))
        return "\n".join("\n".join(lines[one.lineno - 1 : one.end_lineno]) for one in loops)

    def _cleared(self, name: str, running: set[str]) -> bool:
        """Return whether code resets a stored value without a message."""
        for where, functions in self._functions.items():
            if where in _SETUP or where == "":
                continue
            for _, function in functions:
                for target, value in _changes(function):
                    if ast.unparse(target).partition("[")[0] == name and (
                        (isinstance(value, ast.Constant) and value.value is None)
                        or (
                            where not in self._handlers
                            and (where in running or value is None)
                            and _reset(value)
                        )
                    ):
                        return True
        return False


def _last(qualname: str) -> str:
    return qualname.rpartition(".")[2]


def _word(name: str) -> str:
    return rf"(?<![\w.]){re.escape(name)}\b"


def _own(function: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of a function, except those of inner functions."""
    for child in ast.iter_child_nodes(function):
        if not isinstance(child, _Function):
            yield child
            yield from _own(child)


def _changes(function: ast.AST) -> Iterator[tuple[ast.expr, ast.expr | None]]:
    """Yield the changed targets with their new values; None for a change in place."""
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=targets, value=value):
                for target in targets:
                    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
                        yield from zip(target.elts, value.elts, strict=False)
                    else:
                        yield target, value
            case ast.AugAssign(target=target):
                yield target, None
            case ast.Delete(targets=targets):
                yield from ((one, None) for one in targets)
            case ast.Call(func=ast.Attribute(value=owner, attr="pop" | "popleft" | "clear" | "get_nowait")):
                yield owner, None


def _reset(value: ast.expr | None) -> bool:
    """Return whether a value is constant, a new object without arguments, or a change in place."""
    if isinstance(value, ast.Call):
        return not value.args and not value.keywords and isinstance(value.func, ast.Name)
    return value is None or isinstance(value, ast.Constant)
