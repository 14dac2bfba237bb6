"""Dispatch by state: the choice of the state decides which method runs, even if at first only one was possible."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing_topics

NODE = """\
import rospy
from std_msgs.msg import Bool, Float64, String
out = rospy.Publisher("out", Float64, queue_size=1)
class Tender:
    def __init__(self):
        self.state, self.batch, self.reached = "waiting", "", False
        self.handlers = {"waiting": self.waiting, "gripping": self.gripping}
        rospy.Subscriber("done", String, self.on_done)
        rospy.Subscriber("reached", Bool, self.on_reached)
    def on_done(self, msg):
        self.batch = msg.data
    def on_reached(self, msg):
        self.reached = msg.data
    def waiting(self):
        if self.batch:
            out.publish(1.0)  # done:control reached:control
            return "gripping"
        return "waiting"
    def gripping(self):
        if not self.reached:
            return "gripping"
        out.publish(2.0)  # done:control reached:control
        return "waiting"
    def run(self):
        while not rospy.is_shutdown():
            self.state = CALL
Tender().run()
"""


@pytest.mark.parametrize(
    "call",
    [
        "getattr(self, self.state)()",
        "self.handlers[self.state]()",
        "self.handlers.get(self.state)()",
        "self.waiting() if self.state == 'waiting' else self.gripping()",
    ],
)
def test_the_state_decides_which_method_runs(call: str) -> None:
    assert not differing_topics(NODE.replace("CALL", call))


def test_a_method_that_is_always_called_has_no_decision() -> None:
    node = NODE.replace("CALL", "getattr(self, 'waiting')()").replace(
        "# done:control reached:control", "# done:control", 1
    )
    assert not differing_topics(node.replace("out.publish(2.0)  # done:control reached:control", "pass"))
