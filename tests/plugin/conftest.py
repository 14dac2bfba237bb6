"""Import both packages whole: pytester forgets what a run in this process imports, and half is worse than none."""

from __future__ import annotations

import importlib
import pkgutil

import pytest_tarl
import tarl_lint

for package in (tarl_lint, pytest_tarl):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
