"""Diagnostic tasks: objects that fill a status when an updater runs them."""

# ruff: noqa: N802 (names are those of diagnostic_updater)

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Fill = Callable[[Any], Any]


class DiagnosticTask:
    """A named task; subclasses fill the status in `run`."""

    def __init__(self, name: str) -> None:
        self.name = name

    def getName(self) -> str:
        """Return the name."""
        return self.name

    def run(self, stat: Any) -> Any:
        """Fill a status, and return it."""
        return stat


class FunctionDiagnosticTask(DiagnosticTask):
    """A task that calls a function."""

    def __init__(self, name: str, fn: Fill) -> None:
        super().__init__(name)
        self.fn = fn

    def run(self, stat: Any) -> Any:
        """Return what the function returns for the status."""
        return self.fn(stat)


class CompositeDiagnosticTask(DiagnosticTask):
    """Several tasks with a common status: the highest level, and the messages of tasks that are not OK."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.tasks: list[DiagnosticTask] = []

    def addTask(self, t: DiagnosticTask) -> None:
        """Add a task."""
        self.tasks.append(t)

    def run(self, stat: Any) -> Any:
        """Run all tasks, each starting from the status's summary, and merge their summaries."""
        given, merged = type(stat)(), type(stat)()
        given.summary(stat)
        for task in self.tasks:
            stat.summary(given)
            stat = task.run(stat)
            merged.mergeSummary(stat)
        stat.summary(merged)
        return stat


@dataclass
class _Added:
    """A task in a list, with its name."""

    name: str
    fn: Fill

    def run(self, stat: Any) -> Any:
        stat.name = self.name
        return self.fn(stat)


class DiagnosticTaskVector:
    """A list of tasks."""

    DiagnosticTaskInternal = _Added

    def __init__(self) -> None:
        self.tasks: list[_Added] = []
        self.lock = threading.Lock()

    def addedTaskCallback(self, task: Any) -> None:
        """Do nothing; subclasses react to new tasks."""

    def add(self, *args: Any) -> None:
        """Add a task, or a name and a function."""
        name, fill = (args[0].getName(), args[0].run) if len(args) == 1 else args
        with self.lock:
            self.tasks.append(_Added(name, fill))
            self.addedTaskCallback(self.tasks[-1])

    def removeByName(self, name: str) -> bool:
        """Remove the first task with this name; return whether there was one."""
        with self.lock:
            found = next((one for one in self.tasks if one.name == name), None)
            if found is not None:
                self.tasks.remove(found)
        return found is not None
