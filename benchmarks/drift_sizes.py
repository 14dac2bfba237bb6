"""Vary the size of a task's drift, from the nominal value to the value that the test declares."""

from __future__ import annotations

import ast
import inspect
import re
import sys
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "drift"), str(HERE)]

from stage import Stage  # noqa: E402
from stress_examples import EXAMPLES  # noqa: E402

from pytest_tarl.drifts import Drift  # noqa: E402
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending  # noqa: E402

SIZE = "size"  # name of the only direction


@dataclass(frozen=True)
class Sized:
    """Runs episodes of a task; the only coordinate of a point is the size of the task's drift."""

    stage: Stage
    name: str  # name of the drift
    whole: bool = False  # whether the task's drift must be a whole number
    # the nominal and the declared value of each entry of the drift's dictionary; empty if the drift is a number
    ends: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    workers = 1

    def value(self, size: float) -> Any:
        """Return the drift with this size.

        If the drift is a number, the size is its value. If it has several numbers, the size is the share of the way
        from the nominal values to the declared values.
        """
        if not self.ends:
            return round(size) if self.whole else size
        if len(self.ends) == 1:
            return dict.fromkeys(self.ends, size)
        return {key: near + (far - near) * size for key, (near, far) in self.ends.items()}

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode."""
        if plan.point is None:
            return self.stage.rollout(plan)
        drift = Drift(self.value(plan.point[SIZE]))
        marked = replace(self.stage.marked, drifts={self.name: drift})
        rollout = replace(self.stage.rollout, designation=marked)
        return rollout(replace(plan, drift=self.name, point=None))

    def begin(self, plan: EpisodePlan) -> Pending:
        """Return an episode that runs when its result is requested."""
        return Deferred(self, plan)


def world_arguments(stage: Stage) -> dict[str, Any]:
    """Return the defaults of the world that the test creates with `**(…tarl_drift…)`; empty if there is none."""
    item = stage.rollout.item
    for call in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(item.function)))):
        if isinstance(call, ast.Call) and any(
            keyword.arg is None and "tarl_drift" in ast.unparse(keyword.value) for keyword in call.keywords
        ):
            world = getattr(item.module, ast.unparse(call.func))
            parameters = inspect.signature(world).parameters.values()
            return {one.name: one.default for one in parameters if one.default is not one.empty}
    return {}


def nominal_of(stage: Stage) -> str:
    """Return the nominal value of a drift that is a number: the value in the test, or else the world's only default.

    Raise SystemExit if there is neither.
    """
    texts = [path.read_text() for path in stage.folder.glob("test_*.py")]
    found = [
        stated[1].rstrip(".") for text in texts if (stated := re.search(r"tarl_drift or ([-\d.]+)", text))
    ]
    found = found or [repr(value) for value in world_arguments(stage).values()]
    if len(found) != 1:
        raise SystemExit(f"{stage.task}: its test states no nominal value of the drift")
    return found[0]


def sized(stage: Stage, name: str) -> tuple[Sized, float, float]:
    """Return a rollout that takes the size of a drift, the nominal size, and the size that the test declares.

    The size of a drift with several numbers is the share of the way to their declared values, from 0 to 1.
    """
    value = stage.marked.drifts[name].value
    if stage.task in EXAMPLES:
        usual: Any = EXAMPLES[stage.task].nominal
        if not isinstance(value, dict):
            return Sized(stage, name), usual, float(value)
        return _of_entries(stage, name, value, dict.fromkeys(value, usual))
    if isinstance(value, dict):
        return _of_entries(stage, name, value, world_arguments(stage))
    text = nominal_of(stage)
    return Sized(stage, name, isinstance(value, int) and "." not in text), float(text), float(value)


def _of_entries(
    stage: Stage, name: str, value: Mapping[str, float], usual: Mapping[str, float]
) -> tuple[Sized, float, float]:
    """Return the same as `sized` for a drift that is a dictionary."""
    ends = {key: (float(usual[key]), float(far)) for key, far in value.items()}
    near, far = next(iter(ends.values())) if len(ends) == 1 else (0.0, 1.0)
    return Sized(stage, name, ends=ends), near, far
