"""A robot turns the pages of books for a scanner. In one book of ten, which was damp, pages cling together."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
Float32 = message_type("std_msgs/msg/Float32")
Int32 = message_type("std_msgs/msg/Int32")

DT = 0.05
PAGES = 3
TIME_BOUND = 25.0
DAMP = 0.10  # share of damp books


class Book:
    """A book whose pages part when air has blown between them for long enough; a damp one needs more."""

    def __init__(self, rng, damp):
        self.rng = rng
        low, high = (0.95, 1.20) if rng.random() < damp else (0.15, 0.45)
        self.needs = [rng.uniform(low, high) for _ in range(PAGES)]  # air with the head 2 cm up (s)
        self.leak = rng.uniform(0.9, 1.1)
        self.height, self.angle, self.pressure = 0.05, 0.0, 0.0
        self.held, self.swept = False, False
        self.air, self.exposed, self.scanned = 0.0, 0.0, 0
        self.time, self.gained = 0.0, 0.0
        self.failure = ""

    @property
    def done(self):
        """Return whether all pages are scanned, or one was missed."""
        return bool(self.failure) or self.scanned == PAGES

    def publish(self, bus):
        """Publish pressure and switch of the head, and how many pages there are and are scanned."""
        bus.publish("head/pressure", Float32(data=self.pressure + self.rng.normal(0.0, 0.4)))
        bus.publish("head/contact", Bool(data=self.height < 0.004))
        bus.publish("scanner/scanned", Int32(data=self.scanned))
        bus.publish("book/pages", Int32(data=PAGES))

    def advance(self, height, angle, vacuum, blower, trigger):
        """Move head and arm for one step, and the pages with them."""
        share = 1.0 - math.exp(-DT / 0.06)
        self.height += ((height.data if height else 0.05) - self.height) * share
        self.angle += ((angle.data if angle else 0.0) - self.angle) * share
        sucks = bool(vacuum and vacuum.data)
        closed = self.held or self.height < 0.004
        wanted = (-32.0 / self.leak if closed else -6.0) if sucks else 0.0
        self.pressure += (wanted - self.pressure) * (1.0 - math.exp(-DT / 0.15))
        self.time += DT
        self.gained = -0.006
        if not self.held and not self.swept and self.height < 0.004 and self.pressure < -18.0:
            self.held, self.air = True, 0.0
        if self.held and blower and blower.data:
            self.air += DT * max(0.0, min(1.0, self.height / 0.02) + self.rng.normal(0.0, 0.05))
        if self.held and self.pressure > -8.0:
            self._let_go()
        if self.held and self.height > 0.06:
            self.failure = "a page tears"
        self._expose(bool(trigger and trigger.data))

    def _let_go(self):
        self.held = False
        self.swept = self.angle > 120.0
        if self.swept and self.air < self.needs[self.scanned]:
            self.failure = f"page {self.scanned + 1} comes with the one below it"

    def _expose(self, triggered):
        self.exposed = self.exposed + DT if triggered and self.swept else 0.0
        if self.exposed > 0.4:
            self.scanned += 1
            self.swept, self.exposed = False, 0.0
            self.gained += 10.5 / PAGES

    def judge(self):
        """Return the reward of the step: pages that are scanned."""
        if self.time > TIME_BOUND:
            self.failure = "the book takes too long"
        return self.gained - (4.0 if self.failure else 0.0)


@pytest.mark.tarl(
    nodes=["page_turner.py"],
    sensors=[
        Sensor("pressure", topic="head/pressure", field="data", low=-40.0, high=0.0, bins=4, unit="kPa"),
        Sensor("height", topic="head/height", field="data", low=0.0, high=0.06, bins=4, unit="m"),
        Sensor("scanned", topic="scanner/scanned", field="data"),
    ],
    drifts={"damp books": Drift(DAMP)},
    episodes=200,
    min_success=0.97,
)
def test_turns_pages(tarl, tarl_drift):
    """Scan one book."""
    book = Book(tarl.rng("book"), tarl_drift or 0.0)
    tarl.start("page_turner.py")
    topics = ("head/height", "arm/angle", "head/vacuum", "blower", "scanner/trigger")
    while not book.done:
        book.publish(tarl.bus)
        tarl.step(DT)
        book.advance(*(tarl.bus.latest(topic) for topic in topics))
        tarl.reward(book.judge())
    assert not book.failure, book.failure
