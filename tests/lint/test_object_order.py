"""Results do not depend on memory addresses, which determine the order of sets of objects."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import tarl_lint
from tarl_lint.memory.values import Obj
from tests.lint.analysing import analysed

ROOMS = ("interpret", "models", "memory", "queries")
CASES = Path(__file__).parent.parent / "cases"
NODES = sorted((CASES / "combined").glob("*.py"))


def loops_over_sets(path: Path) -> list[str]:
    """Return the loops of a file that go over `value.pts`; `value.objects` is in order."""
    loops = (node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.For))
    alike = [loop for loop in loops if isinstance(loop.iter, ast.Attribute) and loop.iter.attr == "pts"]
    return [f"{path.name}:{loop.lineno}" for loop in alike]


def test_loops_visit_objects_in_order_of_creation() -> None:
    home = Path(tarl_lint.__file__).parent
    found = [loop for room in ROOMS for path in (home / room).rglob("*.py") for loop in loops_over_sets(path)]
    assert found == []


@pytest.mark.parametrize("node", NODES[:6], ids=lambda path: path.stem)
def test_flows_do_not_depend_on_set_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, node: Path
) -> None:
    results = []
    for factor in (1, 7919, -1):
        monkeypatch.setattr(Obj, "__hash__", lambda self, factor=factor: self.number * factor, raising=False)
        results.append(analysed(tmp_path, node=node.read_text("utf-8")).flows)
    assert results[0]
    assert results.count(results[0]) == len(results)
