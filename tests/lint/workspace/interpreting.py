"""Interpret a Python text without executing it."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent
from typing import Any

from tarl_lint.workspace.python.interpreter import Interpreter


def interpreted(folder: Path, text: str, **models: Any) -> dict[str, Any]:
    path = folder / "read.py"
    path.write_text(dedent(text), encoding="utf-8")
    return Interpreter(path, models).run()
