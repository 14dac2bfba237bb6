"""Drive an example's node through its world, optionally with a changed source of the node."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from pytest_tarl.ros import Ros

EXAMPLES = Path(__file__).parents[2] / "examples"


@cache
def world_module(example: str) -> ModuleType:
    """Load an example's world under a unique module name, since every example names it `world`."""
    spec = importlib.util.spec_from_file_location(f"{example}_world", EXAMPLES / example / "world.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def random(seed: int) -> np.random.Generator:
    """Return a random generator like that of `tarl.rng`."""
    return np.random.Generator(np.random.Philox(key=seed))


def drive(node: str, world: Any, edits: Mapping[str, str] | None = None, **parameters: Any) -> list[float]:
    """Run a node (`shuttle/traveller.py`) until the mission ends; return the reward of every step."""
    path = EXAMPLES / node
    text = path.read_text()
    for old, new in (edits or {}).items():
        assert old in text, f"{node} has no {old!r}"
        text = text.replace(old, new)
    program = compile(text, str(path), "exec")
    ros = Ros(parameters=parameters)
    rewards = []
    with ros.installed():
        ros.start(lambda: exec(program, {"__name__": "__main__"}), name=path.stem)
        while not world.over:
            world.publish(ros.bus)
            ros.step(world.dt)
            world.advance(ros.bus)
            judged = world.monitor()
            rewards.append(judged if isinstance(judged, float) else sum(judged.values()))
        ros.close()
    return rewards
