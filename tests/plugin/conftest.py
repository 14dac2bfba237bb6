"""Import both packages completely, since pytester unloads modules that an in-process run imports for the first time."""

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
    """A temporary project with a node and its simulation test."""
    pytester.makefile(".py", keeper=NODE, test_tank=TEST)
    # These plugins shuffle tests, warn that they are not set up, or leave a thread after each run. The tests of these
    # plugins enable them.
    quiet = "-p no:randomly -p no:asyncio -p no:rerunfailures"
    pytester.makeini(f"[pytest]\nfilterwarnings = error\naddopts = {quiet}\n")
    return pytester
