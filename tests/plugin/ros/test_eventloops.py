"""Nodes with event loops, thread pools and servers run on the virtual clock."""

from __future__ import annotations

import asyncio
import concurrent.futures.thread as pools
import sys
from typing import Any

import pytest

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import Ros, message_type
from tests.plugin.ros.conftest import Start, heard

HEAD = """
import asyncio, threading, time
from concurrent.futures import ThreadPoolExecutor, as_completed
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("{name}")
publisher = node.create_publisher(String, "out", 10)
def say(text):
    publisher.publish(String(data=f"{{text}} at {{time.monotonic() - began:.2f}}"))
began = time.monotonic()
"""
LOOP = """
async def tick():
    while rclpy.ok():
        say("tick")
        await asyncio.sleep(1.0)
async def spin():
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0)
        await asyncio.sleep(0.05)
node.create_subscription(String, "in", lambda message: say(message.data), 10)
ended = []
async def main():
    try:
        await asyncio.gather(tick(), spin())
    finally:
        ended.append(True)
asyncio.run(main())
"""


def texts(messages: list[Any]) -> list[str]:
    return [message.data for message in messages]


def test_asyncio_sleeps_in_virtual_time(start: Start) -> None:
    ros = start("")
    out = heard(ros, "/out")
    start(HEAD.format(name="talker") + LOOP, ros=ros)
    ros.step(1.5)
    ros.bus.publish("/in", message_type("std_msgs/msg/String")(data="hello"))
    ros.step(1.0)
    assert texts(out)[:2] == ["tick at 0.00", "tick at 1.00"]
    assert texts(out)[2].startswith("hello at 1.5")
    assert texts(out)[3] == "tick at 2.00"
    namespace: dict[str, Any] = ros.namespace  # type: ignore[attr-defined]
    ros.close()
    assert namespace["ended"] == [True]  # as after Ctrl-C
    assert asyncio._get_running_loop() is None


def test_two_nodes_have_their_own_loops(start: Start) -> None:
    ros = start("")
    out = heard(ros, "/out")
    body = """
async def main():
    time.sleep(0.5)
    await asyncio.wait_for(asyncio.sleep(0.25), 5)
    say(node.get_name())
asyncio.run(main())
"""
    for name in ("one", "two"):
        start(HEAD.format(name=name) + body, ros=ros)
    ros.step(1.0)
    assert texts(out) == ["one at 0.75", "two at 0.75"]


def test_ended_event_loops_leave_no_generator_hooks(
    start: Start,
) -> None:
    ros = start("")
    out = heard(ros, "/out")
    body = """
async def numbers():
    for number in range(3):
        yield number
async def main():
    found = [number async for number in numbers()]
    await asyncio.sleep({seconds})
    say(f"{{found}}")
asyncio.run(main())
"""
    for name, seconds in (("one", 0.25), ("two", 0.5), ("three", 5.0)):
        start(HEAD.format(name=name) + body.format(seconds=seconds), ros=ros)
    ros.step(1.0)
    assert texts(out) == ["[0, 1, 2] at 0.25", "[0, 1, 2] at 0.50"]
    assert tuple(sys.get_asyncgen_hooks()) == (None, None)


def test_threads_pools_and_loops_work_together(start: Start) -> None:
    ros = start("")
    out = heard(ros, "/out")
    start(HEAD.format(name="pool") + """
def work(seconds):
    time.sleep(seconds)
    return seconds
async def main():
    loop = asyncio.get_running_loop()
    say(f"thread {await asyncio.to_thread(work, 0.5)}")
    future = loop.create_future()
    threading.Timer(0.25, lambda: loop.call_soon_threadsafe(future.set_result, "timer")).start()
    say(await future)
asyncio.run(main())
with ThreadPoolExecutor(max_workers=2) as pool:
    say([one.result() for one in as_completed([pool.submit(work, seconds) for seconds in (0.5, 0.25, 0.5)])])
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
loop = asyncio.new_event_loop()
runner = threading.Thread(target=loop.run_forever, daemon=True)
runner.start()
say(asyncio.run_coroutine_threadsafe(asyncio.sleep(0.25, "done"), loop).result())
loop.call_soon_threadsafe(loop.stop)
runner.join()
loop.close()
""", ros=ros)  # fmt: skip
    ros.step(3.0)
    said = texts(out)
    assert said[0] == "thread 0.5 at 0.50"
    assert said[1].startswith("timer at 0.7")
    assert said[2].startswith("[0.25, 0.5, 0.5] at 1.5")
    assert said[3].startswith("done at 1.")


def test_python_does_not_wait_for_pools_of_an_episode() -> None:
    ros = Ros()
    with ros.installed():
        code = compile(
            "from concurrent.futures import ThreadPoolExecutor\nThreadPoolExecutor().submit(int)",
            "node.py",
            "exec",
        )
        ros.start(lambda: exec(code, {}), name="node.py")
        assert pools._threads_queues
        ros.close()
    assert not [thread for thread in pools._threads_queues if "_tarl_task" in vars(thread)]


def test_threaded_server_does_not_stop_the_clock(start: Start) -> None:
    ros = start("")
    out = heard(ros, "/out")
    start(HEAD.format(name="server") + """
import http.server, urllib.request
class Hello(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        self.send_response(200)
        self.end_headers()
    def log_message(self, *args):
        pass
server = http.server.HTTPServer(("127.0.0.1", 0), Hello)
threading.Thread(target=server.serve_forever, daemon=True).start()
time.sleep(1.0)
say("alive")
server.server_close()
""", ros=ros)  # fmt: skip
    ros.step(2.0)
    assert texts(out) == ["alive at 1.00"]


def test_coroutine_error_is_a_node_error(start: Start) -> None:
    with pytest.raises(NodeError, match=r"Node '/talker' raised KeyError: 'gone' \(.*line 14, in main\)"):
        start(
            HEAD.format(name="talker")
            + "\nasync def main():\n    raise KeyError('gone')\nasyncio.run(main())"
        )
