"""Coroutines that never end, and read what other coroutines of the same program store."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics, sections

HEAD = """\
import asyncio, json, rospy
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
class Buoy:
    def __init__(self):
        self.box = asyncio.Queue()
        self.waves, self.first, self.second, self.last = {}, 0.0, 0.0, 0.0
        rospy.Subscriber("scan", Float64, self.scan)
    def scan(self, msg):
        self.box.put_nowait(msg.data)
    async def listen(self):
        while True:
            text = await self.box.get()
            try:
                wave = json.loads(text)
            except ValueError:
                continue
            self.first = wave["height"]
            self.waves[wave["site"]] = wave["height"]
    async def relay(self):
        while True:
            await asyncio.sleep(1.0)
            self.second = self.first
            self.last = self.first
            self.last = 2.0
    async def report(self):
        while True:
            await asyncio.sleep(0.5)
            out.publish(max(self.waves.values()))  # scan:data
            out.publish(self.second)  # scan:data
            out.publish(self.last)  # clean
"""
WAYS = """\
### gathered
async def run():
    buoy = Buoy()
    await asyncio.gather(buoy.listen(), buoy.relay(), buoy.report())
asyncio.run(run())
### gathered in the reverse order
async def run():
    buoy = Buoy()
    await asyncio.gather(buoy.report(), buoy.relay(), buoy.listen())
asyncio.run(run())
### as tasks
async def run():
    buoy = Buoy()
    asyncio.create_task(buoy.listen())
    asyncio.ensure_future(buoy.relay())
    await buoy.report()
asyncio.run(run())
### in a group
async def run():
    buoy = Buoy()
    async with asyncio.TaskGroup() as group:
        group.create_task(buoy.listen())
        group.create_task(buoy.relay())
        group.create_task(buoy.report())
asyncio.run(run())
"""
CASES = sections(WAYS)
SINGLE = """\
class Winch:
    def __init__(self, topic):
        self.pull = 0.0
        rospy.Subscriber(topic, Float64, self.on_pull)
    def on_pull(self, msg):
        self.pull = msg.data
    async def run(self, limit):
        self.pull = 0.0
        out.publish(self.pull)  # clean
        await asyncio.sleep(1.0)
async def run():
    await asyncio.gather(Winch("left").run(1.0), Winch("right").run(2.0))
asyncio.run(run())
"""


@pytest.mark.parametrize("name", CASES)
def test_stores_of_endless_coroutines(name: str) -> None:
    assert differing_topics(HEAD + CASES[name]) == {}


def test_coroutines_of_new_objects_are_evaluated_once() -> None:
    head = HEAD.partition("class")[0]
    assert differing_topics(head + SINGLE) == {}
