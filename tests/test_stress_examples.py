"""The tables of the stress benchmarks name tests, drifts and nominal values that exist."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

BENCHMARKS = Path(__file__).parent.parent / "benchmarks"
MODULES = ("drift_sizes", "stress_examples", "stage")


@pytest.fixture
def sizes(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """Import the module of sizes, and forget it afterwards."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import drift_sizes

    yield drift_sizes
    for name in MODULES:
        sys.modules.pop(name, None)


class World:
    """A world with two numbers that may drift."""

    def __init__(self, rng: object, low: float = 0.5, high: float = 1.5) -> None: ...


class Lever:
    """A world with one number that may drift."""

    def __init__(self, rng: object, give: float = 0.25) -> None: ...


def _test_of_a_world(tarl_drift: Any) -> None:
    World(None, **(tarl_drift or {}))


def _test_of_a_lever(tarl_drift: Any) -> None:
    Lever(None, **({"give": tarl_drift} if tarl_drift else {}))


def staged(tmp_path: Path, function: Any, value: Any) -> Any:
    """Return a stage of a test with one drift."""
    item = SimpleNamespace(function=function, module=sys.modules[__name__])
    marked = SimpleNamespace(drifts={"drift": SimpleNamespace(value=value)})
    rollout = SimpleNamespace(item=item)
    return SimpleNamespace(task="task", folder=tmp_path, rollout=rollout, marked=marked)


def test_every_example_names_a_test_and_a_drift(sizes: ModuleType) -> None:
    for example in sizes.EXAMPLES.values():
        file, _, name = example.test.partition("::")
        tree = ast.parse((example.place / file).read_text())
        tests = [
            node.name for node in tree.body if isinstance(node, ast.FunctionDef) and "test_" in node.name
        ]
        assert name in tests or (not name and len(tests) == 1)
        keys = [
            ast.literal_eval(key)
            for node in ast.walk(tree)
            if isinstance(node, ast.Dict)
            for key in node.keys
        ]
        assert example.drift in keys


def test_an_entry_of_a_dictionary_has_its_own_unit(sizes: ModuleType, tmp_path: Path) -> None:
    rollout, near, far = sizes.sized(staged(tmp_path, _test_of_a_world, {"high": 3.0}), "drift")
    assert (near, far) == (1.5, 3.0)
    assert rollout.value(2.0) == {"high": 2.0}


def test_several_entries_move_together_from_nominal_to_the_drift(sizes: ModuleType, tmp_path: Path) -> None:
    rollout, near, far = sizes.sized(staged(tmp_path, _test_of_a_world, {"low": 1.5, "high": 2.5}), "drift")
    assert (near, far) == (0.0, 1.0)
    assert rollout.value(0.0) == {"low": 0.5, "high": 1.5}
    assert rollout.value(0.25) == {"low": 0.75, "high": 1.75}


def test_nominal_value_is_the_only_default_of_a_world(sizes: ModuleType, tmp_path: Path) -> None:
    rollout, near, far = sizes.sized(staged(tmp_path, _test_of_a_lever, 0.75), "drift")
    assert (near, far) == (0.25, 0.75)
    assert rollout.value(0.5) == 0.5


def test_stated_nominal_value_comes_first(sizes: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "test_steps.py").write_text("delay = int(tarl_drift or 0)\n")
    rollout, near, far = sizes.sized(staged(tmp_path, _test_of_a_lever, 2), "drift")
    assert (near, far, rollout.value(1.4)) == (0.0, 2.0, 1)


def test_a_drift_without_a_nominal_value_is_refused(sizes: ModuleType, tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="task: its test states no nominal value of the drift"):
        sizes.sized(staged(tmp_path, _test_of_a_world, 2.0), "drift")
