"""Each operation of the abstract memory is used by a unit test."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from functools import cache, cached_property
from pathlib import Path
from types import FunctionType, ModuleType

import pytest

from tarl_lint import memory

HERE = Path(__file__).parent
TESTS = [*HERE.glob("test_*.py"), HERE.parent / "test_memory.py"]


def operations(module: ModuleType) -> Iterator[str]:
    """Yield the public functions and methods that a module defines."""
    for name, member in vars(module).items():
        if name.startswith("_") or getattr(member, "__module__", "") != module.__name__:
            continue
        if isinstance(member, FunctionType):
            yield name
        elif inspect.isclass(member):
            yield from (
                f"{name}.{method}"
                for method, value in vars(member).items()
                if isinstance(value, (FunctionType, property, cached_property)) and not method.startswith("_")
            )


@cache
def used() -> frozenset[str]:
    """Return the names of functions, methods and properties that the unit tests of the memory use."""
    found: set[str] = set()
    for file in TESTS:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute):
                found.add(node.attr)
            elif isinstance(node, ast.Name):
                found.add(node.id)
    return frozenset(found)


@pytest.mark.parametrize("name", [module.name for module in pkgutil.iter_modules(memory.__path__)])
def test_every_operation_of_the_graph_has_a_unit_test(name):
    module = importlib.import_module(f"{memory.__name__}.{name}")
    names = list(operations(module))
    missing = [one for one in names if one.rpartition(".")[2] not in used()]
    assert missing == [], "test each of them in this folder"
