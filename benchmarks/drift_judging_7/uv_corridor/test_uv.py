"""A handrail gets a dose of ultraviolet light between two limits. Aged lamps are weaker, each to a different degree."""

from pathlib import Path

import pytest
import yaml

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Float64 = message_type("std_msgs/msg/Float64")

DT = 0.25
CELL = 0.1
LENGTH = 4.0
STRIP = 0.9
LEAST, MOST = 45.0, 100.0  # J/m2
TIME_BOUND = 75.0


class Corridor:
    """A corridor with a handrail and sometimes a person."""

    def __init__(self, rng, output):
        self.rng = rng
        self.output = output * rng.uniform(0.98, 1.02)  # relative to the data sheet's value
        self.dose = [0.0] * round(LENGTH / CELL)
        self.x = -STRIP
        self.time = 0.0
        self.visit = rng.uniform(3.0, 12.0)
        self.stays = rng.uniform(1.0, 4.0)

    @property
    def person(self):
        """Return the distance of the nearest person, in m."""
        return 1.2 if self.visit < self.time < self.visit + self.stays else 6.0

    @property
    def done(self):
        """Return whether the end of the rail is passed or the time is over."""
        return self.x >= LENGTH or self.time > TIME_BOUND

    def publish(self, bus):
        """Publish the nearest person, the remaining distance and the photodiode at the lamp."""
        bus.publish("/person_distance", Float64(data=self.person))
        bus.publish("/corridor_left", Float64(data=LENGTH - self.x))
        bus.publish("/lamp_diode", Float64(data=self.output + self.rng.normal(0.0, 0.01)))

    def advance(self, cmd, lamp):
        """Drive, light the strip ahead, and return the reward of the cells that leave it."""
        self.time += DT
        if cmd is None:
            return 0.0
        before = self.x
        if lamp and lamp.data:
            first = max(0, round(self.x / CELL))
            last = min(len(self.dose), round((self.x + STRIP) / CELL))
            for cell in range(first, last):
                self.dose[cell] += 17.0 * self.output * DT
        self.x += max(0.0, cmd.linear.x) * DT
        left = range(max(0, round(before / CELL)), min(len(self.dose), max(0, round(self.x / CELL))))
        return sum(self.value(self.dose[cell]) for cell in left) * 10.0 / len(self.dose) - 0.002

    @staticmethod
    def value(dose):
        """Return 1 for a dose within the limits, and less outside."""
        if dose < LEAST:
            return dose / LEAST - 1.0 - 0.5
        return 1.0 if dose < MOST else -0.5

    def judge(self):
        """Return the reason for a failed round, else an empty text."""
        if self.x < LENGTH:
            return "late"
        bad = sum(not LEAST <= dose <= MOST for dose in self.dose)
        return f"{bad} cells of the rail got a wrong dose" if bad > 2 else ""


@pytest.mark.tarl(
    nodes=["uv_robot.py"],
    sensors=[
        Sensor("diode", topic="/lamp_diode", field="data", edges=(0.8,)),
        Sensor("left", topic="/corridor_left", field="data", low=0, high=5, bins=3, unit="m"),
        Sensor("person", topic="/person_distance", field="data", edges=(1.6,), unit="m"),
    ],
    drifts={"aged lamp": Drift.range(0.42, 0.68)},
    episodes=100,
    min_success=0.95,
)
def test_disinfects(tarl, tarl_drift):
    """Disinfect one corridor."""
    world = Corridor(tarl.rng("corridor"), tarl_drift or 1.0)
    config = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text())
    tarl.start("uv_robot.py", parameters=config["uv_robot"]["ros__parameters"])
    while not world.done:
        world.publish(tarl.bus)
        tarl.step(DT)
        tarl.reward(world.advance(tarl.bus.latest("/cmd_vel"), tarl.bus.latest("/lamp")))
    assert not world.judge(), world.judge()
