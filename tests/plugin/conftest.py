"""Import both packages completely, since pytester unloads modules that an in-process run imports for the first time."""

from __future__ import annotations

import importlib
import os
import pkgutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

import pytest_tarl
import tarl_lint
from pytest_tarl.ros.messages import node_workspaces
from tests.plugin.tank import NODE, TEST

REPOSITORY = Path(__file__).resolve().parents[2]

for package in (tarl_lint, pytest_tarl):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if module.name.startswith(("pytest_tarl.formulas.", "pytest_tarl.editor.")):
            with suppress(ModuleNotFoundError):  # rtamt or pygls may be missing
                importlib.import_module(module.name)
        elif not module.name.endswith("__main__"):
            importlib.import_module(module.name)


@pytest.fixture(autouse=True)
def _forget_workspaces_of_the_test() -> Iterator[None]:
    """Forget the workspaces of a test, which are gone after it."""
    yield
    kept = [root for root in node_workspaces._SEARCHED if root.is_relative_to(REPOSITORY)]
    hidden = {folder for folder in node_workspaces._KEPT if folder.is_relative_to(REPOSITORY)}
    if (kept, hidden) != (node_workspaces._SEARCHED, node_workspaces._KEPT):
        node_workspaces._SEARCHED[:] = kept
        node_workspaces._KEPT &= hidden
        node_workspaces.forget()


@pytest.fixture(autouse=True, scope="session")
def _files_are_not_flushed_to_the_disk() -> Iterator[None]:
    """Leave out `fsync`, which takes milliseconds and shows only when the machine loses power."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(os, "fsync", lambda handle: None)
        yield


@pytest.fixture
def quick_acceptance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Accept a repair after 8 paired episodes, for tests of its contents and not of its certainty."""
    for module in ("searching.accept", "repairing.accepting"):
        monkeypatch.setattr(f"pytest_tarl.{module}.SEEDS", 16)
    monkeypatch.setattr("pytest_tarl.searching.accept.EARLY", ())
    monkeypatch.setattr("pytest_tarl.searching.accept.LOOKS", (8,))
    monkeypatch.setattr("pytest_tarl.repairing.accepting.risk_of", lambda alpha, before: 0.9)


@pytest.fixture
def tank(pytester: pytest.Pytester) -> pytest.Pytester:
    """A temporary project with a node and its simulation test."""
    pytester.makefile(".py", keeper=NODE, test_tank=TEST)
    # These plugins shuffle tests, warn that they are not set up, or leave a thread after each run. The tests of these
    # plugins enable them.
    quiet = "-p no:randomly -p no:asyncio -p no:rerunfailures"
    pytester.makeini(f"[pytest]\nfilterwarnings = error\naddopts = {quiet}\n")
    return pytester
