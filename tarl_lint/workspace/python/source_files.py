"""Read Python files of a workspace without executing them."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Final

from tarl_lint.workspace.bounded_files import UnreadableError, read_bytes
from tarl_lint.workspace.model import Problem, unreadable

LARGEST: Final = 1_000_000  # maximum size of a file (bytes)


def parsed(file: Path, problems: list[Problem]) -> ast.Module | None:
    """Return the syntax tree of a file; if it cannot be read or parsed, record a problem and return None."""
    try:
        return ast.parse(read_bytes(file, LARGEST))
    except UnreadableError as reason:
        problems.append(unreadable(file, 0, str(reason)))
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line = getattr(error, "lineno", 0) or 0
        problems.append(unreadable(file, line, f"it is not Python 3: {getattr(error, 'msg', error)}"))
    return None
