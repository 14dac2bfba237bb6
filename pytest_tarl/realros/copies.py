"""Import private copies of a package that has module-level state, to run several ROS nodes in one process."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType

from pytest_tarl.ros.argv import command_line

Modules = dict[str, ModuleType]


def load_copy(package: str, parts: Sequence[str], argv: Sequence[str]) -> Modules:
    """Import a new copy of a package and some of its modules; earlier copies remain usable.

    `argv` is the command line that the package reads when it is imported.
    """
    with _hidden(package), command_line(argv):
        for name in (package, *(f"{package}.{part}" for part in parts)):
            import_module(name)
        return present(package)


def present(package: str) -> Modules:
    """Return a package's modules in `sys.modules`."""
    inner = f"{package}."
    return {name: module for name, module in sys.modules.items() if name == package or name.startswith(inner)}


def show(package: str, modules: Modules) -> None:
    """Replace a package's modules in `sys.modules` with `modules`."""
    for name in present(package):
        del sys.modules[name]
    sys.modules.update(modules)


@contextmanager
def _hidden(package: str) -> Iterator[None]:
    before = present(package)
    show(package, {})
    try:
        yield
    finally:
        show(package, before)
