"""Find the thread of a function.

Each rospy callback has a thread of its own; rclpy callbacks share one thread, if the executor and the groups do not
allow more.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Final

from tarl_lint.evidence import Evidence
from tarl_lint.ir.nodes import Pos
from tarl_lint.memory.frames import Frame
from tarl_lint.memory.shared import Root
from tarl_lint.trees import walk

MAIN: Final = "main"
EXECUTOR: Final = "executor"
MAIN_KINDS: Final = frozenset(["module", "main", "node"])
CALLED_BY_ROS: Final = frozenset(["callback", "timer", "service", "filter"])
SPUN_ASIDE: Final = re.compile(r"target\s*=\s*[\w.]*spin|target\s*=\s*lambda[^,)]*spin")


class Threads:
    """Identifies the thread of each frame; None if unknown."""

    def __init__(self, evidence: Evidence) -> None:
        self.evidence = evidence
        self.machine = evidence.machine
        modules = self.machine.modules.values()
        self.several = any(m.contains("MultiThreadedExecutor") for m in modules)
        self.aside = any(m.matches(SPUN_ASIDE) for m in modules)

    def of(self, frame: Frame) -> object:
        """Return an identifier of the frame's thread."""
        top = frame
        while top.caller is not None:
            top = top.caller
        key = top.key
        if not isinstance(key, tuple) or len(key) < 2:
            return None
        if key[0] == "module":
            return self._main(frame.program.path)
        known = self.machine.roots.get(key[1]) if key[0] == "root" else None
        return self._root(known[0], frame.program.path) if known is not None else None

    def _main(self, path: str) -> object:
        return EXECUTOR if self._rclpy(path) and not self.aside else MAIN

    def _root(self, root: Root, path: str) -> object:
        if root.kind in MAIN_KINDS:
            return self._main(path)
        what, *target = root.key if isinstance(root.key, tuple) else (None,)
        if not isinstance(what, tuple) or len(what) < 3:
            return None
        kind, where, pos, *_ = what  # the remaining entries of `what` are topics
        if kind == "thread":
            return root.key
        if kind not in CALLED_BY_ROS:
            return None
        key = ((kind, where, pos), *target)
        return self._group(where, pos, key) if self._rclpy(where) else key

    def _rclpy(self, path: str) -> bool:
        return self.machine.modules[path].contains("rclpy")

    def _group(self, path: str, pos: Pos, key: object) -> object:
        """Return the thread of an rclpy callback: callbacks of a mutually exclusive group never overlap."""
        if not self.several:
            return EXECUTOR
        call = self.evidence.outline(path).call(pos)
        given = next((k.value for k in call.keywords if k.arg == "callback_group"), None) if call else None
        if given is None:
            return "default group"
        text = ast.unparse(given)
        if isinstance(given, ast.Call) or "ReentrantCallbackGroup" in set(self._made(path, text)):
            return key
        return f"group {text}"

    def _made(self, path: str, target: str) -> Iterator[str]:
        """Yield the names of the classes whose instances are assigned to a target."""
        for node in walk(self.machine.modules[path].tree):
            if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Call):
                continue
            if any(ast.unparse(t) == target for t in node.targets):
                yield ast.unparse(node.value.func).rpartition(".")[2]
