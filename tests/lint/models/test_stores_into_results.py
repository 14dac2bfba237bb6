"""What is stored into a part of a future's result is in the result."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing

NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64
from shop_msgs.msg import Found
from shop_msgs.srv import Find

class Asking(Node):
    def __init__(self):
        super().__init__("asking")
        self.found = self.create_publisher(Found, "found", 1)
        self.finder = self.create_client(Find, "find")
        self.depth = 0.0
        self.create_subscription(Float64, "depth", self.on_depth, 1)
        self.create_timer(1.0, self.ask)

    def on_depth(self, msg):
        self.depth = msg.data

    def ask(self):
        self.finder.call_async(Find.Request()).add_done_callback(self.done)

    def done(self, future):
        answer = future.result()
        {store}
        self.found.publish({read})  # {mark}

rclpy.init()
rclpy.spin(Asking())
"""


@pytest.mark.parametrize(
    ("store", "read", "mark"),
    [
        ("for one in answer.items: one.score = self.depth", "answer.items", "data"),
        ("for one in answer.items: one.score = self.depth", "Found(items=answer.items)", "data"),
        ("for n, one in enumerate(answer.items): answer.items[n].score = self.depth", "answer.items", "data"),
        ("answer.items[0].score = self.depth", "answer.items", "data"),
        ("answer.items.append(self.depth)", "answer", "data"),
        ("first = answer.first; first.score = self.depth", "answer", "data"),
        ("answer.total", "answer", "clean"),
    ],
)
def test_stores_into_parts_of_a_result(store: str, read: str, mark: str) -> None:
    assert differing(NODE.format(store=store, read=read, mark=mark)) == {}
