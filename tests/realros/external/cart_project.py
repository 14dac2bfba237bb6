"""A project with the node of examples/cart_mujoco and a test, whose world is in its process or the simulator.

The environment variable WORLD is `Inside` or `Outside`. `python -m tests.realros.external.cart_project FOLDER` writes
the project, for measuring.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

EXAMPLE = Path(__file__).parents[3] / "examples" / "cart_mujoco"
TEST = """\
import os
import sys
from pathlib import Path

import pytest

from pytest_tarl import Sensor

STEPS, DOCK = 70, 2.0  # of 0.05 s; m
# The faults of the first episodes, if the environment asks for them; each happens in one run of its episode
FAULTS = os.environ.get("FAULTS", "").split(",")


class Inside:
    def __init__(self, tarl, y, x, drift):
        from world import World

        class Drawn:
            numbers = iter((y, x))

            def uniform(self, *_):
                return next(self.numbers)

        self.tarl, self.world = tarl, World(Drawn(), **drift)
        self.x = x

    def step(self):
        self.world.publish(self.tarl.bus)
        self.tarl.step(0.05)
        self.world.advance(self.tarl.bus)
        self.x = float(self.world.data.joint("cart").qpos[0])


class Outside:
    def __init__(self, tarl, y, x, drift):
        self.tarl, self.x = tarl, x
        environment = {{"X": repr(x), "Y": repr(y), **{{name.upper(): repr(value) for name, value in drift.items()}}}}
        self.simulator = tarl.external(
            [sys.executable, {program!r}],
            ready=("/odom", "/cmd_vel"),
            step="/step",
            every_step=["/odom"],
            environment={{**environment, **fault(tarl.seed)}},
            timeout=600,
            patience=float(os.environ.get("PATIENCE", "300")),
        )

    def step(self):
        self.tarl.step(0.05)
        self.x = self.simulator.latest("/odom").pose.pose.position.x


def fault(seed):
    order = Path(__file__).with_name("seeds")
    seeds = order.read_text().split() if order.exists() else []
    if str(seed) not in seeds:
        seeds.append(str(seed))
        order.write_text(" ".join(seeds))
    number = seeds.index(str(seed))
    mark = Path(__file__).with_name(f"mark-{{number}}")
    return {{"FAULT": FAULTS[number], "MARK": str(mark)}} if number < len(FAULTS) else {{}}


@pytest.mark.tarl(
    nodes=["docking.py"],
    sensors=[Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=2, bins=16, unit="m")],
    drifts={{"loaded": {{"payload": 30.0}}}},
    tolerance=0.1,
)
def test_docks(tarl, tarl_drift):
    draws = tarl.rng("world")
    y, x = (float(draws.uniform(-most, most)) for most in (0.1, 0.2))
    world = globals()[os.environ["WORLD"]](tarl, y, x, tarl_drift or {{}})
    tarl.start("docking.py")
    for _ in range(STEPS):
        before = abs(DOCK - world.x)
        world.step()
        tarl.reward(progress=before - abs(DOCK - world.x), overrun=-max(0.0, world.x - DOCK))
    assert abs(DOCK - world.x) < 0.05, "not at the dock"
"""


def write(folder: Path) -> Path:
    """Write the project into a new folder."""
    folder.mkdir(parents=True)
    for name in ("docking.py", "world.py", "cart.xml", "pytest.ini"):
        shutil.copy(EXAMPLE / name, folder / name)
    program = str(Path(__file__).with_name("cart_simulator.py"))
    (folder / "test_cart.py").write_text(TEST.format(program=program))
    return folder


if __name__ == "__main__":
    write(Path(sys.argv[1]))
