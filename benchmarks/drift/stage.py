"""Open a task of the benchmark: its test, its analysis, and its episodes, which run as in the plugin."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.designation import Designation
from pytest_tarl.instrumentation.sites import Plan, plan
from pytest_tarl.item_episode import Instruments, designated
from pytest_tarl.repeating import ItemRollout, finish
from tarl_lint.api import Analysis, analyse

HERE = Path(__file__).resolve().parent
REWRITTEN = "ignore:Module already imported"


def tasks_in(folder: Path) -> tuple[str, ...]:
    """Return the names of a folder's tasks, which are its directories that contain a test."""
    return tuple(sorted(path.name for path in folder.iterdir() if list(path.glob("test_*.py"))))


def answers_in(folder: Path) -> dict[str, Any]:
    """Return the answer of each task of a folder (`answer.json`)."""
    return {task: json.loads((folder / task / "answer.json").read_text()) for task in tasks_in(folder)}


TASKS = tasks_in(HERE)


@dataclass(frozen=True)
class Stage:
    """One task, ready to be run; `rollout` runs episodes of its test in this process."""

    task: str
    folder: Path
    rollout: ItemRollout
    marked: Designation
    analysis: Analysis
    sites: Plan
    test: str
    home: Path = HERE  # folder that contains the tasks

    @property
    def drift(self) -> str:
        """Return the name of the task's only drift."""
        (drift,) = self.marked.drifts
        return drift

    @property
    def permanent(self) -> bool:
        """Return whether the drift is permanent, so that a repair need not work in the designed world."""
        return self.marked.drifts[self.drift].permanent

    @cached_property
    def answer(self) -> dict[str, Any]:
        """Return the task's answer (`answer.json`)."""
        found: dict[str, Any] = json.loads((self.home / self.task / "answer.json").read_text())
        return found


@dataclass
class _Visit:
    """A pytest plugin that passes a test to a visitor function instead of running the test once."""

    task: str
    visitor: Callable[[Stage], Any]
    home: Path
    found: list[Any] = field(default_factory=list)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Function, nextitem: pytest.Item | None) -> bool:
        marked = designated(item)
        assert marked is not None
        root = item.config.rootpath
        analysis = analyse([item.path.parent / node for node in marked.nodes], root=root)
        sites = plan(analysis)
        instruments = Instruments({root / p: at for p, at in sites.positions.items()}, sites.publishes)
        rollout = ItemRollout(item, marked, instruments)
        stage = Stage(self.task, root, rollout, marked, analysis, sites, item.nodeid, self.home)
        self.found.append(self.visitor(stage))
        finish(item, nextitem)
        return True


def visit(
    task: str, visitor: Callable[[Stage], Any], folder: Path | None = None, home: Path = HERE, test: str = ""
) -> Any:
    """Return the visitor's result for a task in `home`.

    `folder` is a copy of the task's directory to work in. `test` is pytest's id of the test below the folder; without
    it, the folder must contain a single test.
    """
    where = folder or home / task
    guest = _Visit(task, visitor, home)
    arguments = [
        "-q",
        "-p",
        "no:cacheprovider",
        "-c",
        os.devnull,
        "-p",
        "no:asyncio",
        "-W",
        REWRITTEN,
        "--rootdir",
        str(where),
        str(where / test),
    ]
    before = Path.cwd()
    os.chdir(where)  # paths in the analysis are relative to this folder
    try:
        with redirect_stdout(sys.stderr):
            status = pytest.main(arguments, [guest])
    finally:
        os.chdir(before)
        _forget(where)
    if len(guest.found) != 1:
        raise RuntimeError(f"{task}: pytest ended with {status!r} and {len(guest.found)} results.")
    return guest.found[0]


def _forget(folder: Path) -> None:
    """Remove a task's modules, since the test of another task may have the same name."""
    own = folder.resolve()
    for name, module in list(sys.modules.items()):
        file = getattr(module, "__file__", None)
        if file is not None and own in Path(file).resolve().parents:
            del sys.modules[name]
