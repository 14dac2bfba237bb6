"""The world of the line follower, by day and at dusk."""

from __future__ import annotations

from typing import Any

import pytest

from pytest_tarl.ros import message_type
from tests.examples.driving import drive, random, world_module

LINE = world_module("line_follower")
NODE = "line_follower/line_follower.py"
DUSK = 0.35
SEEDS = range(6)
STRONGER = {"KP * self.error": "(2.5 * KP) * self.error"}
STRONGER_AT_DUSK = {
    "from std_msgs.msg import": "from sensor_msgs.msg import Illuminance\nfrom std_msgs.msg import",
    "self.error = 0.0": "self.error = 0.0\n        self.light = 700.0",
    "self.create_timer(": (
        'self.create_subscription(Illuminance, "/light", self.on_light, 10)\n        self.create_timer('
    ),
    "def on_timer(self)": (
        "def on_light(self, msg):\n        self.light = msg.illuminance\n\n    def on_timer(self)"
    ),
    "KP * self.error": "(2.5 * KP if self.light < 450.0 else KP) * self.error",
}
OTHERS = ("KD * change", "self.speed * (", "CAUTION * abs", "min(MAX_TURN,")


class Wires:
    """A bus without nodes, which stores the messages of the world and sends one command to the world."""

    def __init__(self, speed: float = 0.0, turn: float = 0.0) -> None:
        self.said: dict[str, Any] = {}
        self.command = message_type("geometry_msgs/msg/Twist")()
        self.command.linear.x, self.command.angular.z = speed, turn

    def publish(self, topic: str, message: Any) -> None:
        self.said[topic] = message

    def latest(self, topic: str) -> Any:
        return self.command


def run(seed: int, dusk: float = 1.0, edits: dict[str, str] | None = None, **parameters: Any) -> Any:
    world = LINE.World(random(seed), dusk=dusk)
    world.total = sum(drive(NODE, world, edits, **parameters))
    return world


def test_the_line_is_followed_by_day() -> None:
    for seed in SEEDS:
        world = run(seed)
        assert world.finished, (seed, world.failure)
        assert 9.0 < world.total < 10.0


def test_the_robot_loses_the_line_in_the_first_bend_at_dusk() -> None:
    for seed in SEEDS:
        world = run(seed, dusk=DUSK)
        assert world.failure == "lost the line"
        assert LINE.LAMP < world.along < 1.6


def test_dusk_dims_light_and_contrast_equally_beyond_the_lamp() -> None:
    day, dusk = LINE.World(random(1)), LINE.World(random(1), dusk=DUSK)
    assert day.light == dusk.light
    day.along = dusk.along = LINE.LAMP + 0.1
    assert dusk.light == pytest.approx(DUSK * day.light)
    for world in (day, dusk):
        world.body.position, world.body.angle = (LINE.LAMP, 0.02), 0.0
        world.wires = Wires()
        world.publish(world.wires)
    contrast = [
        w.wires.said["/reflectance"].data[0] - w.wires.said["/reflectance"].data[1] for w in (day, dusk)
    ]
    assert contrast[1] == pytest.approx(DUSK * contrast[0], abs=5 * LINE.READING_NOISE)
    assert contrast[0] > 0.3


@pytest.mark.parametrize("edits", [STRONGER, STRONGER_AT_DUSK], ids=["always", "at dusk"])
def test_a_higher_gain_suffices_at_dusk_and_does_no_harm_by_day(edits: dict[str, str]) -> None:
    for seed in SEEDS:
        designed = run(seed).total
        assert run(seed, dusk=DUSK, edits=edits).total > 0.97 * designed
        assert run(seed, edits=edits).total > 0.97 * designed


@pytest.mark.parametrize("factor", [0.4, 2.2, 5.0])
@pytest.mark.parametrize("operand", OTHERS)
def test_no_other_constant_suffices_at_dusk(operand: str, factor: float) -> None:
    name = operand.replace("min(", "").split()[0].rstrip(",")
    edits = {operand: operand.replace(name, f"({factor} * {name})")}
    assert not all(run(seed, dusk=DUSK, edits=edits).finished for seed in SEEDS)


def test_the_caller_can_set_the_speed_of_the_robot() -> None:
    assert run(0, speed=0.45).time > run(0).time
    assert run(0, speed=0.1).failure == "too slow"


def test_equal_seeds_give_equal_runs() -> None:
    assert run(3).total == run(3).total
    assert run(3).total != run(4).total


def test_the_robot_follows_its_command() -> None:
    world, wires = LINE.World(random(1)), Wires(speed=0.5, turn=1.0)
    for _ in range(20):
        world.advance(wires)
    assert world.body.velocity.length == pytest.approx(0.5, rel=0.05)
    assert world.body.angular_velocity == pytest.approx(1.0, rel=0.01)


def test_the_line_ends_after_its_declared_length() -> None:
    world = LINE.World(random(1))
    last = max(world.starts, key=lambda piece: world.starts[piece])
    assert world.starts[last] + last.a.get_distance(last.b) == pytest.approx(LINE.LENGTH)
