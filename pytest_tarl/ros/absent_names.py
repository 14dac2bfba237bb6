"""Advice on names that a library has removed, and on undefined names whose import failed inside a `try`."""

from __future__ import annotations

import ast
import linecache
import re
import sys

from pytest_tarl.ros import blame
from pytest_tarl.ros.missing_modules import interface_advice, module_advice
from pytest_tarl.ros.standins import STANDINS

_CAUGHT = {"ImportError", "ModuleNotFoundError", "Exception", "BaseException"}
_PARTIAL = re.compile("partially initialized module")


def removed_name(module: str, text: str) -> str:
    """Return advice on a name that the library `module` lacks; empty for a module of the user.

    `text` is the message from Python.
    """
    top = sys.modules.get(module.partition(".")[0])
    file = getattr(top, "__file__", None)
    if top is None or module in STANDINS or top.__name__ in STANDINS or _PARTIAL.search(text):
        return ""
    if top.__name__ in sys.stdlib_module_names:
        return (
            f"Python {sys.version_info.major}.{sys.version_info.minor} has no such name in {module}: use its "
            "replacement in the node."
        )
    if file is None or not blame.is_library(file):
        return ""
    version = getattr(top, "__version__", "")
    installed = f"The installed {top.__name__}{f' {version}' if isinstance(version, str) and version else ''}"
    return (
        f"{installed} has no such name: install a version that has it into the environment of the tests, or change "
        "the code that uses it."
    )


def caught_import(error: NameError, file: str) -> str:
    """Return advice if `file` imports the undefined name in a `try` that catches failed imports."""
    try:
        tree = ast.parse("".join(linecache.getlines(file)))
    except (SyntaxError, ValueError):
        return ""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Try) or not any(map(_catches, node.handlers)):
            continue
        for one in (inner for statement in node.body for inner in ast.walk(statement)):
            if not isinstance(one, ast.Import | ast.ImportFrom):
                continue
            names = [(alias.asname or alias.name).partition(".")[0] for alias in one.names]
            if error.name not in names or (isinstance(one, ast.ImportFrom) and one.level):
                continue
            module = (
                one.module if isinstance(one, ast.ImportFrom) else one.names[names.index(error.name)].name
            )
            return _of_caught(error.name, module or "", one.lineno)
    return ""


def _of_caught(name: str, module: str, line: int) -> str:
    """Return advice on a module whose import failed on this line."""
    if sys.modules.get(module) is not None:
        return ""  # the name exists, so its import did not fail
    why = interface_advice(module) or module_advice(ModuleNotFoundError(name=module.partition(".")[0]))
    return (
        f"The import of {name} in line {line} failed, and the node continued without it. {why}" if why else ""
    )


def _catches(handler: ast.ExceptHandler) -> bool:
    """Return whether a handler catches a failed import."""
    if handler.type is None:
        return True
    kinds = handler.type.elts if isinstance(handler.type, ast.Tuple) else [handler.type]
    return any(isinstance(one, ast.Name) and one.id in _CAUGHT for one in kinds)
