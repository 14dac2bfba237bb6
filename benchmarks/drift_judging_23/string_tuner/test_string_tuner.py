"""A bench tunes guitars. The maker of the guitars changed to machine heads with more play, for good."""

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Empty = message_type("std_msgs/Empty")
Float32 = message_type("std_msgs/Float32")

DT = 0.2
PITCH = (82.41, 110.0, 146.83, 196.0)  # Hz
STRETCH = (2.7, 2.5, 2.2, 2.0)  # cents per degree
TIGHT = {"play": 5.0}
LOOSE = {"play": 24.0}  # degrees


class Guitar:
    """A guitar whose machine heads have some `play`, in degrees."""

    def __init__(self, rng, play):
        self.rng = rng
        self.play = play * rng.normal(1.0, 0.02, 4)
        self.stretch = [one * rng.normal(1.0, 0.03) for one in STRETCH]
        self.off = [float(rng.uniform(-15.0, 50.0)) for _ in PITCH]  # cents
        self.head = [0.0] * 4  # degrees of the head, of which the play does not reach the string
        self.post = [-play * float(rng.uniform(0.9, 1.0)) for play in self.play]
        self.string, self.ring, self.plucks, self.wear, self.up = 0, 0, 0, 0.0, [True] * 4
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    @property
    def done(self):
        """Return whether the guitar leaves the bench."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish that the guitar is clamped, and what the microphone hears two steps after a pluck."""
        if round(self.time / DT) == 2:
            bus.publish("bench/clamped", Empty())
        self.ring -= 1
        if self.ring == 0:
            off = self.off[self.string] + self.rng.normal(0.0, 0.5)
            bus.publish("mic/frequency", Float32(data=PITCH[self.string] * 2.0 ** (off / 1200.0)))

    def turn(self, degrees):
        """Turn the head of the present string."""
        at = self.string
        self.head[at] += degrees
        post = max(self.head[at] - self.play[at], min(self.head[at], self.post[at]))
        self.off[at] += (post - self.post[at]) * self.stretch[at]
        self.post[at] = post
        self.up[at] = degrees > 0.0
        self.wear += abs(degrees)

    def pluck(self):
        """Pluck the present string."""
        self.plucks += 1
        self.ring = 2
        self.gained -= 0.15

    def advance(self, report):
        """Wait for one step."""
        self.time += DT
        if max(self.off) > 120.0:
            self.failure = "string breaks"
        elif self.time > 60.0:
            self.failure = "tuning takes too long"
        elif report:
            self.over = True
            self.gained += sum(max(0.0, 2.5 - 0.25 * max(0.0, abs(off) - 2.0)) for off in self.off)
            if not all(self.up) or max(map(abs, self.off)) > 5.0:
                self.failure = "guitar is out of tune"
        if self.failure:
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["string_tuner.py"],
    sensors=[
        Sensor("frequency", topic="mic/frequency", field="data", low=70.0, high=210.0, bins=14, unit="Hz"),
    ],
    drifts={"loose": Drift(LOOSE, permanent=True)},
    episodes=200,
    min_success=0.97,
)
def test_tunes(tarl, tarl_drift):
    """Tune one guitar."""
    guitar = Guitar(tarl.rng("guitar"), **(tarl_drift or TIGHT))
    tarl.start("string_tuner.py", launch="bench.launch")
    calls = []
    tarl.bus.subscribe("bench/string", lambda message: calls.append(("string", message.data)))
    tarl.bus.subscribe("head/turn", lambda message: calls.append(("turn", message.data)))
    tarl.bus.subscribe("bench/pluck", lambda _: calls.append(("pluck", None)))
    while not guitar.done:
        guitar.gained = 0.0
        guitar.publish(tarl.bus)
        tarl.step(DT)
        for what, value in calls:
            if what == "string":
                guitar.string = value
            elif what == "turn":
                guitar.turn(value)
            else:
                guitar.pluck()
        calls.clear()
        guitar.advance(tarl.bus.latest("bench/report"))
        tarl.reward(guitar.gained)
    assert not guitar.failure, guitar.failure
