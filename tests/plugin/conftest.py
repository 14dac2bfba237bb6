"""Import both packages whole: pytester forgets what a run in this process imports, and half is worse than none."""

from __future__ import annotations

import importlib
import pkgutil
from contextlib import suppress

import pytest

import pytest_tarl
import tarl_lint
from tests.plugin.tank import NODE, TEST

for package in (tarl_lint, pytest_tarl):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if module.name.startswith(("pytest_tarl.formulas.", "pytest_tarl.editor.")):
            with suppress(ModuleNotFoundError):  # rtamt or pygls may be missing
                importlib.import_module(module.name)
        elif not module.name.endswith("__main__"):
            importlib.import_module(module.name)


@pytest.fixture
def tank(pytester: pytest.Pytester) -> pytest.Pytester:
    """A project of its own: a node, and a simulation test of it."""
    pytester.makefile(".py", keeper=NODE, test_tank=TEST)
    # What shuffles tests, warns that it is not set up, or leaves a thread with each run is asked for where it is the
    # subject.
    quiet = "-p no:randomly -p no:asyncio -p no:rerunfailures"
    pytester.makeini(f"[pytest]\nfilterwarnings = error\naddopts = {quiet}\n")
    return pytester
