"""A stand trues wheels. A light rim of a racing bicycle gives way more, so the same turn of a nipple moves it further.

A true wheel earns, each correction costs a little, and a wheel that is rejected or loses a spoke is a loss.
"""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/Bool")
Float32 = message_type("std_msgs/Float32")
Float32MultiArray = message_type("std_msgs/Float32MultiArray")
Int32 = message_type("std_msgs/Int32")

DT = 0.5
SPOKES = 28
TOURING = {"weight": 590.0, "give": 0.95}
RACING = {"weight": 370.0, "give": 2.5}  # g, mm per turn


class Stand:
    """A stand with a wheel whose rim moves by some `give` in mm per turn of a nipple."""

    def __init__(self, rng, weight, give):
        self.rng = rng
        self.weight = weight + rng.normal(0.0, 12.0)
        self.give = give * rng.normal(1.0, 0.03)
        waves = [(k, rng.normal(0.0, 0.5), rng.uniform(0.0, 6.28)) for k in (2, 3, 5)]
        self.rim = [
            sum(size * math.sin(2.0 * math.pi * k * spoke / SPOKES + phase) for k, size, phase in waves)
            for spoke in range(SPOKES)
        ]
        largest = max(abs(place) for place in self.rim)
        size = float(rng.uniform(1.2, 1.6))
        self.rim = [place * size / largest for place in self.rim]
        self.tension = [0.0] * SPOKES
        self.spun, self.turns = 0.0, []
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the wheel leaves the stand."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish what the loader knows, the clamp, and the profile of a wheel that has turned once."""
        step = round(self.time / DT)
        if step % 10 == 0:
            bus.publish("wheel/weight", Float32(data=self.weight + self.rng.normal(0.0, 2.0)))
            bus.publish("wheel/hub", Int32(data=SPOKES))
        bus.publish("stand/clamped", Bool(data=step >= 2))
        if self.spun >= 1.0:
            self.spun = 0.0
            noise = self.rng.normal(0.0, 0.02, SPOKES)
            profile = [float(place + off) for place, off in zip(self.rim, noise, strict=True)]
            bus.publish("gauge/profile", Float32MultiArray(data=profile))

    def turn(self, spoke, turns):
        """Turn a nipple: the rim moves to the side of its spoke, and its neighbours with it."""
        side = 1.0 if spoke % 2 == 0 else -1.0
        self.tension[spoke] += turns
        for place in range(SPOKES):
            apart = min((place - spoke) % SPOKES, (spoke - place) % SPOKES)
            if apart < 6:
                self.rim[place] += side * self.give * turns * math.exp(-0.5 * (apart / 1.8) ** 2)
        if self.tension[spoke] > 6.5:
            self.failure = "spoke breaks"

    def advance(self, spin, state):
        """Work for one step."""
        self.time += DT
        self.gained = -0.002
        for spoke, turns in self.turns:
            self.turn(spoke, turns)
        self.turns.clear()
        self.spun = self.spun + DT if spin and spin.data else 0.0
        if state == "pass":
            self.over = True
            runout = max(abs(place) for place in self.rim)
            self.gained += 7.0 - 3.0 * max(0.0, runout - 0.3)
            if runout > 0.5:
                self.failure = "wheel is not true"
        elif state == "reject":
            self.failure = "wheel is rejected"
        elif self.time > 130.0:
            self.failure = "shift ends"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["wheel_truer.py", "spokes.py"],
    sensors=[
        Sensor("weight", topic="wheel/weight", field="data", low=200.0, high=800.0, bins=6, unit="g"),
        Sensor(
            "runout",
            topic="gauge/profile",
            field=lambda message: max(abs(place) for place in message.data),
            low=0.0,
            high=3.0,
            bins=6,
            unit="mm",
        ),
    ],
    drifts={"racing": RACING},
    episodes=200,
    min_success=0.97,
)
def test_trues(tarl, tarl_drift):
    """True one wheel: 7 if it is true, a small cost per second, -4 for a failure."""
    stand = Stand(tarl.rng("stand"), **(tarl_drift or TOURING))
    tarl.start("wheel_truer.py")
    tarl.bus.subscribe("stand/nipple", lambda message: stand.turns.append((round(message.x), message.y)))
    while not stand.done:
        stand.publish(tarl.bus)
        tarl.step(DT)
        state = tarl.bus.latest("truer/state")
        stand.advance(tarl.bus.latest("stand/spin"), state.data if state else "")
        tarl.reward(stand.gained)
    assert not stand.failure, stand.failure
