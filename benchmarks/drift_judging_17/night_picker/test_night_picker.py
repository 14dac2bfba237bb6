"""Biscuits are picked from a belt. At night the hall is dark, the camera exposes longer, and pictures come later."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")

DT = 0.04
DAY = {"exposure": 7.0, "latency": 0.09}  # ms, s
NIGHT = {"exposure": 34.0, "latency": 0.24}
BISCUITS = 8
VALVE = 0.045  # s


class Belt:
    """A belt with biscuits, a camera upstream and a suction cup."""

    def __init__(self, rng, exposure, latency):
        self.rng = rng
        self.exposure = exposure
        self.latency = latency
        self.speed = float(rng.uniform(0.25, 0.40))
        spacing = rng.uniform(0.30, 0.40, BISCUITS)
        self.starts = [0.55 + float(spacing[: i + 1].sum()) for i in range(BISCUITS)]
        self.time, self.picked, self.passed, self.tried = 0.0, 0, 0, set()
        self.gained = 0.0

    @property
    def done(self):
        """Return whether the last biscuit is past the cup."""
        return self.place(BISCUITS - 1, self.time) < -0.15

    def place(self, i, when):
        """Return how far biscuit i is before the cup at a time, in m."""
        return self.starts[i] - self.speed * when

    def publish(self, bus):
        """Publish the speed, the exposure, and the biscuit in the picture that the shutter took a while ago."""
        bus.publish("belt/encoder_speed", Float32(data=self.speed * self.rng.normal(1.0, 0.005)))
        if round(self.time / DT) % 25 == 0:
            bus.publish("camera/exposure_ms", Float32(data=self.exposure + self.rng.normal(0.0, 0.8)))
        for i in range(BISCUITS):
            seen = self.place(i, self.time - self.latency)
            if 0.03 < seen < 0.32:
                bus.publish("camera/biscuit", Float32(data=seen + self.rng.normal(0.0, 0.001)))

    def advance(self, fired):
        """Move the belt for one step; `fired` are the waits that the node has asked for since the last step."""
        self.gained = 0.0
        for wait in fired:
            at = self.time + wait + VALVE
            nearest = min(range(BISCUITS), key=lambda i: abs(self.place(i, at)))
            off = abs(self.place(nearest, at))
            good = off < 0.0125 and nearest not in self.tried
            self.tried.add(nearest)
            self.picked += good
            self.gained += 1.0 if good else -0.5
        self.time += DT
        past = sum(self.place(i, self.time) < -0.1 for i in range(BISCUITS))
        self.gained -= 0.2 * (past - self.passed)
        self.passed = past


@pytest.mark.tarl(
    nodes=["night_picker.py"],
    sensors=[
        Sensor("biscuit", topic="camera/biscuit", field="data", low=0.05, high=0.4, bins=4, unit="m"),
        Sensor("exposure", topic="camera/exposure_ms", field="data", low=0.0, high=50.0, bins=4, unit="ms"),
        Sensor("speed", topic="belt/encoder_speed", field="data", low=0.2, high=0.45, bins=2, unit="m/s"),
    ],
    drifts={"night shift": NIGHT},
    episodes=200,
    min_success=0.97,
)
def test_picks(tarl, tarl_drift):
    """Pick eight biscuits."""
    belt = Belt(tarl.rng("belt"), **(tarl_drift or DAY))
    tarl.start("night_picker.py")
    fired = []
    while not belt.done:
        belt.publish(tarl.bus)
        tarl.step(DT)
        shots = tarl.bus.latest("picker/count")
        new = shots is not None and shots.data > len(fired)
        wait = tarl.bus.latest("cup/fire_in")
        if new:
            fired.append(wait.data)
        belt.advance(fired[-1:] if new else [])
        tarl.reward(belt.gained)
    assert belt.picked >= BISCUITS - 1, f"{belt.picked} of {BISCUITS} biscuits picked"
