"""Modules that a flow passes through but the marker does not name."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.repairing.unsearched_modules import unnamed_modules
from tarl_lint.model import Span


def sentences(root: Path, sources: dict[str, str], *steps: tuple[str, int, str]) -> list[str]:
    """Return the sentences for sources by path and steps of flows: path, line and statement."""
    sites = [SimpleNamespace(span=Span(path, line, 1, line, 9), code=code) for path, line, code in steps]
    order: Any = SimpleNamespace(root=root, analysis=SimpleNamespace(sources=sources, sites=sites))
    return list(unnamed_modules(order))


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for name in ("control.py", "filters.py", "pkg/inner.py", "pkg/deep/gains.py", "pkg/deep/node.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    return tmp_path


@pytest.mark.parametrize(
    ("imported", "code", "found"),
    [
        ("import control", "x = control.turn(y)", "control.py"),
        ("import control as c", "x = c.turn(y)", "control.py"),
        ("import control as c", "x = control.turn(y)", None),
        ("from control import turn", "x = turn(y)", "control.py"),
        ("from control import turn as t", "x = t(y)", "control.py"),
        ("from control import turn", "x = turned(y)", None),
        ("from pkg import inner", "x = inner.turn(y)", "pkg/inner.py"),
        ("from pkg.inner import turn", "x = turn(y)", "pkg/inner.py"),
        ("import pkg.inner", "x = pkg.inner.turn(y)", "pkg/inner.py"),
        ("import math", "x = math.sin(y)", None),
        ("from . import control", "x = control.turn(y)", "control.py"),
        ("from .control import turn", "x = turn(y)", "control.py"),
    ],
)
def test_imported_file_named_in_a_step_is_named(
    project: Path, imported: str, code: str, found: str | None
) -> None:
    told = sentences(project, {"node.py": f"{imported}\n"}, ("node.py", 7, code))
    start = f"a flow passes through {found} at node.py:7, but the marker does not name that file"
    assert [one.startswith(start) for one in told] == ([True] if found else [])


def test_each_module_is_named_once_with_its_first_step(project: Path) -> None:
    sources = {
        "node.py": "import control\nfrom control import turn\nimport filters\n",
        "other.py": "import control\n",
    }
    told = sentences(
        project, sources, ("node.py", 9, "a = b"), ("node.py", 5, "x = turn(control.y)"),
        ("other.py", 3, "control.z()"), ("other.py", 4, "filters.z()"), ("node.py", 6, "filters.low(x)"),
    )  # fmt: skip
    assert [one.split(", but")[0] for one in told] == [
        "a flow passes through control.py at node.py:5",
        "a flow passes through filters.py at node.py:6",
    ]


def test_modules_that_the_marker_names_are_searched_anyway(project: Path) -> None:
    sources = {"node.py": "import control\n", "control.py": ""}
    assert sentences(project, sources, ("node.py", 5, "control.turn()")) == []


def test_files_are_sought_beside_the_module_and_in_its_parents(project: Path) -> None:
    code = "import control\nfrom gains import kp\nfrom ..inner import ki\nfrom ... import filters\n"
    steps = [
        ("pkg/deep/node.py", line, f"{name}()")
        for line, name in enumerate(("control", "kp", "ki", "filters"), 1)
    ]
    told = sentences(project, {"pkg/deep/node.py": code}, *steps)
    assert [one.split()[4] for one in told] == [
        "control.py",
        "pkg/deep/gains.py",
        "pkg/inner.py",
        "filters.py",
    ]
    assert (
        sentences(project / "pkg", {"deep/node.py": "import control\n"}, ("deep/node.py", 1, "control()"))
        == []
    )
