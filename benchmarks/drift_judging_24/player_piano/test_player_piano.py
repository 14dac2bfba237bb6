"""A piano plays along with a singer. In a humid hall its felt swells, and its hammers are slower."""

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Vector3 = message_type("geometry_msgs/msg/Vector3")

DT = 0.02
DRY = {"humidity": 42.0, "swing": 0.055}
HUMID = {"humidity": 76.0, "swing": 0.108}  # %, s


class Hall:
    """A hall of some `humidity`, where hammers of full force need `swing` to the string."""

    def __init__(self, rng, humidity, swing):
        self.rng = rng
        self.humidity = humidity + rng.normal(0.0, 2.5)
        self.swing = swing * rng.normal(1.0, 0.03)
        self.notes = []  # key, time, force, whether announced, whether struck
        at = 0.6
        while len(self.notes) < 26:
            key = int(rng.integers(32, 84))
            self.notes.append([key, at, float(rng.uniform(0.3, 1.0)), False, False])
            at += float(rng.choice([0.15, 0.2, 0.3]))
        self.origin = None
        self.time, self.gained, self.failure, self.off, self.struck = 0.0, 0.0, "", 0, []

    @property
    def done(self):
        """Return whether the piece is over."""
        return bool(self.failure) or self.time > self.notes[-1][1] + 0.6

    def publish(self, bus):
        """Publish each note half a second ahead, and the humidity once a second."""
        if round(self.time / DT) % 50 == 0:
            bus.publish("hall/humidity", Float32(data=self.humidity + self.rng.normal(0.0, 1.0)))
        for note in self.notes:
            if not note[3] and note[1] - 0.55 <= self.time:
                note[3] = True
                if self.origin is None:
                    self.origin = self.time
                bus.publish("score/note", Vector3(x=float(note[0]), y=note[1] - self.origin, z=note[2]))

    def strike(self, key, force):
        """Let a hammer go."""
        heavy = 1.15 if key < 40 else 1.0
        sounds = self.time + 0.03 + heavy * self.swing / force**0.6 + self.rng.normal(0.0, 0.004)
        waiting = [note for note in self.notes if note[0] == key and not note[4]]
        if not waiting:
            self.gained -= 0.2
            return
        waiting[0][4] = True
        off = abs(sounds - waiting[0][1])
        self.gained += max(-0.3, 0.3 - 6.0 * max(0.0, off - 0.015))
        self.off += off > 0.05

    def advance(self):
        """Listen for one step."""
        self.time += DT
        self.gained = 0.0
        for key, force in self.struck:
            self.strike(key, force)
        self.struck.clear()
        missed = sum(self.time > note[1] + 0.25 and not note[4] for note in self.notes)
        if self.off + missed > 5:
            self.failure = "piano does not keep the beat"
            self.gained -= 4.0


@pytest.mark.tarl(
    nodes=["player_piano.py", "action.py"],
    sensors=[
        Sensor("humidity", topic="hall/humidity", field="data", low=20.0, high=100.0, bins=8, unit="%"),
        Sensor("force", topic="score/note", field="z", low=0.0, high=1.0, bins=5),
    ],
    drifts={"humid": HUMID},
    episodes=200,
    min_success=0.97,
)
def test_plays(tarl, tarl_drift):
    """Play one piece."""
    hall = Hall(tarl.rng("hall"), **(tarl_drift or DRY))
    tarl.start("player_piano.py")
    tarl.bus.subscribe("piano/solenoid", lambda message: hall.struck.append((int(message.x), message.y)))
    while not hall.done:
        hall.publish(tarl.bus)
        tarl.step(DT)
        hall.advance()
        tarl.reward(hall.gained)
    assert not hall.failure, hall.failure
