"""A camera aircraft banks smoothly.

The aircraft was designed for 14 m/s; now it also flies slowly over fields and fast between them.
"""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Vector3Stamped = message_type("geometry_msgs/msg/Vector3Stamped")

DT = 0.04
LENGTH = 16.0  # s
SERVO = 0.07  # s
SHARP = 0.2  # excess over the rate of a smooth turn (rad/s)
UPSET = 1.3  # rad


class Wing:
    """The roll axis of an aircraft whose ailerons act in proportion to the square of the airspeed."""

    def __init__(self, rng, swing):
        self.rng = rng
        self.swing = swing
        self.cruise = rng.uniform(13.5, 14.5)
        self.first = rng.choice([-1.0, 1.0])
        self.bank = rng.normal(0.0, 0.02)
        self.rate = self.deflection = self.gust = self.model = self.model_rate = self.time = 0.0
        self.turns = rng.uniform(0.25, 0.55, 4) * rng.choice([-1.0, 1.0]) * [1, -1, 1, -1]
        self.blurred = 0
        self.failure = ""

    @property
    def airspeed(self):
        """Return the airspeed, m/s."""
        away = self.first if self.time < LENGTH / 2 else -self.first
        blend = min(1.0, (self.time % (LENGTH / 2)) / 2.0)
        factor = self.swing if away > 0 else 1.0 / (1.0 + 0.55 * (self.swing - 1.0))
        return self.cruise * factor**blend

    @property
    def wanted(self):
        """Return the bank angle that the navigator requests, rad."""
        return float(self.turns[min(3, int(self.time / (LENGTH / 4)))])

    @property
    def done(self):
        """Return whether the flight is over."""
        return self.time >= LENGTH or bool(self.failure)

    def publish(self, bus):
        """Publish the requested bank, the airspeed, and the IMU's bank and roll rate."""
        bus.publish("nav/bank", Float32(data=self.wanted))
        bus.publish("pitot/airspeed", Float32(data=self.airspeed + self.rng.normal(0.0, 0.2)))
        roll = Vector3Stamped()
        roll.vector.x = self.bank + self.rng.normal(0.0, 0.003)
        roll.vector.y = self.rate + self.rng.normal(0.0, 0.02)
        bus.publish("imu/roll", roll)

    def advance(self, aileron):
        """Fly for one step."""
        self.time += DT
        aim = aileron.data if aileron else 0.0
        self.gust += DT / 0.5 * -self.gust + self.rng.normal(0.0, 0.6)
        for _ in range(4):
            step = DT / 4
            self.deflection += step / SERVO * (aim - self.deflection)
            ratio = self.airspeed / 14.0
            self.rate += step * (75.0 * ratio**2 * self.deflection - 4.0 * ratio * self.rate + self.gust)
            self.bank += step * self.rate
        self.model_rate = max(-1.2, min(1.2, 1.6 * (self.wanted - self.model)))
        self.model += DT * self.model_rate

    def judge(self):
        """Return the reward of the step: at most 10 in total for sharp pictures during turns as requested."""
        error = abs(self.rate - self.model_rate)
        self.blurred += error > SHARP
        if abs(self.bank) > UPSET:
            self.failure = "upset"
        elif self.done and self.blurred * DT > 0.15 * LENGTH:
            self.failure = f"{100 * self.blurred * DT / LENGTH:.0f} % of the pictures are blurred"
        if self.failure:
            return -5.0
        return 10.0 * DT / LENGTH * max(0.0, 1.0 - (error / 0.25) ** 2)


@pytest.mark.tarl(
    nodes=["roll_control.py"],
    sensors=[
        Sensor(
            "airspeed", topic="pitot/airspeed", field="data", edges=(10.0, 13.0, 16.0, 22.0, 28.0), unit="m/s"
        ),
        Sensor("roll", topic="imu/roll", field="vector.x", edges=(-0.3, 0.3), unit="rad"),
    ],
    drifts={"loiter and dash": 2.3},
    episodes=80,
    min_success=0.95,
)
def test_banks(tarl, tarl_drift):
    """Fly four turns."""
    wing = Wing(tarl.rng("wing"), tarl_drift or 1.0)
    tarl.start("roll_control.py")
    while not wing.done:
        wing.publish(tarl.bus)
        tarl.step(DT)
        wing.advance(tarl.bus.latest("actuators/aileron"))
        tarl.reward(wing.judge())
    assert not wing.failure, wing.failure
