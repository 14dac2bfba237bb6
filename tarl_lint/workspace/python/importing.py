"""What the `import` statements of an interpreted file bind."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from tarl_lint.workspace.python.evaluation import Evaluation
from tarl_lint.workspace.python.values import Library, Scope


class Modules:
    """Finds the files of imported modules. Modules that have a modelled name are not interpreted."""

    def __init__(self, models: Mapping[str, Any], found: Callable[[str], Path | None]) -> None:
        self._found = found
        names = (one.split(".") for one in models)
        self._modelled = {".".join(parts[:n]) for parts in names for n in range(len(parts))}

    def file(self, module: str) -> Path | None:
        """Return the file of a module to interpret; None if there is none."""
        return None if module in self._modelled else self._found(module)


def bind_modules(run: Evaluation, statement: ast.Import, names: Scope) -> None:
    """Bind the names of an `import` statement."""
    for alias in statement.names:
        bound = alias.asname or alias.name.partition(".")[0]
        whole = alias.name if alias.asname else bound
        names.store(bound, run.imported(whole) or Library(whole))


def bind_names(run: Evaluation, statement: ast.ImportFrom, names: Scope) -> None:
    """Bind the names of a `from … import` statement."""
    module = statement.module or ""
    read = run.imported(module)
    for alias in statement.names:
        name = f"{module}.{alias.name}"
        if alias.name == "*":
            known = read.names if read is not None else _below(module, run.models)
            for key, one in known.items():
                names.store(key, one)
        elif name in run.models:
            names.store(alias.asname or alias.name, run.models[name])
        elif read is not None and alias.name in read.names:
            names.store(alias.asname or alias.name, read.names[alias.name])
        else:
            names.store(alias.asname or alias.name, run.imported(name) or Library(name))


def bind_outside(statement: ast.Nonlocal, names: Scope) -> None:
    """Bind the names of a `nonlocal` statement to the enclosing scope that has them."""
    for name in statement.names:
        scope = names.around
        while scope is not None and name not in scope.names:
            scope = scope.around
        if scope is not None:
            names.elsewhere[name] = scope


def _below(module: str, models: Mapping[str, Any]) -> dict[str, Any]:
    """Return the names that `from module import *` binds."""
    prefix = f"{module}."
    inside = {key.removeprefix(prefix): one for key, one in models.items() if key.startswith(prefix)}
    return {key: one for key, one in inside.items() if "." not in key}
