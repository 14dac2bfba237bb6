"""Gymnasium's CartPole as the world of a node; a drift makes the pole longer."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl
from pytest_tarl.ros import message_type
from pytest_tarl.worlds import GymnasiumWorld

gymnasium = pytest.importorskip(
    "gymnasium", reason='Gymnasium is not installed: run pip install "tarl[gymnasium]"'
)

State = message_type("std_msgs/msg/Float64MultiArray")
STEPS = 150  # of 0.02 s


@pytest.mark.tarl(
    nodes=["balance.py"],
    sensors=[
        Sensor("angle", topic="/state", field="data.2", low=-0.2, high=0.2, bins=8, unit="rad"),
        Sensor("swing", topic="/state", field="data.3", low=-2, high=2, bins=8, unit="rad/s"),
    ],
    drifts={"long": 2.0},
    episodes=60,
)
def test_balances(tarl: Tarl, tarl_drift: float | None) -> None:
    """Keep the pole upright for three seconds."""
    environment = gymnasium.make("CartPole-v1")
    pole = environment.unwrapped
    pole.length = tarl_drift or pole.length
    pole.polemass_length = pole.masspole * pole.length
    world = GymnasiumWorld(
        tarl,
        environment,
        observations="/state",
        observe=lambda observation: State(data=[float(value) for value in observation]),
        actions="/push",
        act=lambda message: int(message.data > 0),
        idle=0,
    )
    tarl.start("balance.py")
    for _ in range(STEPS):
        world.step()
        tarl.reward(upright=1.0 - abs(float(world.observation[2])) / 0.2, fall=-50.0 if world.over else 0.0)
        assert not world.over, "the pole fell"
