"""The world of the shuttle, as designed and in mud."""

from __future__ import annotations

from typing import Any

import pytest

from tests.examples.driving import drive, random, world_module

SHUTTLE = world_module("shuttle")
G1, G2 = SHUTTLE.G1, SHUTTLE.G2
MUD = 0.1
SEEDS = range(8)
VEL = "vel = 5 * delta"
IN_PATCH = {
    "pos = None": "pos = None\nterrain = False",
    "from std_msgs.msg import Float64": "from std_msgs.msg import Bool, Float64",
    'rospy.Subscriber("/odom", Odometry, callback)': (
        'rospy.Subscriber("/odom", Odometry, callback)\n'
        '    rospy.Subscriber("/terrain", Bool, lambda msg: globals().update(terrain=msg.data))'
    ),
    VEL: "vel = (12.0 if terrain else 5) * delta",
}
BY_POSITION = {VEL: "vel = (12.0 if 5.0 <= pos <= 7.0 else 5) * delta"}
EVERYWHERE = {VEL: "vel = 12.0 * delta"}


class Wires:
    """A bus without nodes, which stores the messages of the world and sends one command to the world."""

    def __init__(self, velocity: float) -> None:
        self.said: dict[str, Any] = {}
        self.command = SHUTTLE.message_type("std_msgs/Float64")(data=velocity)

    def publish(self, topic: str, message: Any) -> None:
        self.said[topic] = message

    def latest(self, topic: str) -> Any:
        return self.command


def mission(seed: int, mud: float = 1.0, patch: bool | None = None, **edits: Any) -> Any:
    world = SHUTTLE.World(random(seed), mud=mud)
    world.patch = world.patch if patch is None else patch
    world.total = sum(drive("shuttle/traveller.py", world, edits.get("edits")))
    return world


def push(mud: float, start: float, velocity: float, steps: int) -> tuple[Any, Wires]:
    world, wires = SHUTTLE.World(random(1), mud=mud), Wires(velocity)
    world.patch, world.body.position = True, (start, 0.0)
    for _ in range(steps):
        world.publish(wires)
        world.advance(wires)
    return world, wires


@pytest.mark.parametrize("node", ["shuttle/traveller.py", "shuttle/traveller_swapped.py"])
def test_every_mission_delivers_in_the_designed_world(node: str) -> None:
    for seed in SEEDS:
        world = SHUTTLE.World(random(seed))
        rewards = drive(node, world)
        assert world.delivered, (seed, world.failure)
        assert 9.0 < sum(rewards) < 10.0


def test_the_shuttle_delivers_there_and_back_in_the_designed_world() -> None:
    for seed in SEEDS:
        world = SHUTTLE.World(random(seed), goals=(G2, G1))
        rewards = drive("shuttle/traveller.py", world)
        assert world.delivered, (seed, world.failure)
        assert world.leg == 2
        assert 18.0 < sum(rewards) < 20.0


def test_some_missions_cross_the_patch_and_some_do_not() -> None:
    met = sum(SHUTTLE.World(random(seed)).patch for seed in range(200))
    assert 90 < met < 150


def test_muddy_ground_is_harmless_in_the_designed_world() -> None:
    for seed in SEEDS:
        assert mission(seed, patch=True).total == mission(seed, patch=False).total


def test_the_terrain_sensor_sees_the_patch_in_both_worlds() -> None:
    for mud in (1.0, MUD):
        seen = {start: push(mud, start, 0.0, 1)[1].said["/terrain"].data for start in (4.9, 5.1, 6.9, 7.1)}
        assert seen == {4.9: False, 5.1: True, 6.9: True, 7.1: False}


def test_mud_reduces_the_commanded_speed_to_the_stated_share() -> None:
    clean, _ = push(1.0, 2.0, 10.0, 30)
    muddy, _ = push(MUD, 6.0, 10.0, 30)
    commanded = 10.0 * SHUTTLE.WHEEL_RADIUS
    assert clean.body.velocity.x == pytest.approx(commanded, rel=0.03)
    assert muddy.body.velocity.x == pytest.approx(MUD * commanded, rel=0.03)


def test_only_missions_across_the_patch_are_late_in_mud() -> None:
    for seed in SEEDS:
        world = mission(seed, mud=MUD)
        assert world.delivered is not world.patch
        assert world.failure == ("late" if world.patch else "")


@pytest.mark.parametrize("edits", [IN_PATCH, BY_POSITION], ids=["terrain", "position"])
def test_higher_gain_fixes_mud_and_harms_nothing_else(
    edits: dict[str, str],
) -> None:
    designed = [mission(seed).total for seed in SEEDS]
    in_mud = [mission(seed, mud=MUD, edits=edits).total for seed in SEEDS]
    assert sum(in_mud) > 0.97 * sum(designed)
    for seed in SEEDS:
        assert mission(seed, edits=edits).total >= designed[seed]


def test_higher_gain_everywhere_fails_in_both_worlds() -> None:
    for mud in (1.0, MUD):
        assert not any(mission(seed, mud=mud, edits=EVERYWHERE).delivered for seed in SEEDS)


def test_equal_seeds_give_equal_missions() -> None:
    assert mission(5, mud=MUD).total == mission(5, mud=MUD).total
    assert mission(5).total != mission(6).total


def test_running_past_the_goal_ends_the_mission() -> None:
    world, _ = push(1.0, G2 + SHUTTLE.PRECISION + 0.01, 0.0, 1)
    assert world.monitor() < 0.0
    assert world.over
    assert world.failure == "ran past the goal"


def test_goal_counts_after_a_stop_for_the_handover() -> None:
    world, wires = push(1.0, G2, 0.0, 0)
    rewards = []
    for _ in range(SHUTTLE.HANDOVER):
        assert not world.delivered
        world.advance(wires)
        rewards.append(world.monitor())
    assert world.delivered
    assert rewards[-1] > 4.0 > max(rewards[1:-1])
