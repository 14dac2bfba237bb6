"""A member of an enumeration that is looked up by its value follows the data of the value."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing

HEAD = """\
import enum, rospy
from std_msgs.msg import Float64, UInt8
class Phase(enum.Enum):
    STANCE = 0
    SWING = 1
    def speed(self):
        return 0.5 * self.value
class Plain:
    def __init__(self, number):
        self.number = number
out = rospy.Publisher("out", Float64, queue_size=1)
"""
BODIES = {
    "identity": """
    if Phase(msg.data) is Phase.STANCE:
        out.publish(1.0)  # control
    out.publish(2.0)  # clean
""",
    "equality": """
    if Phase(msg.data) != Phase.STANCE:
        out.publish(1.0)  # control
""",
    "the value": """
    out.publish(Phase(msg.data).value)  # data
""",
    "a method": """
    out.publish(Phase(msg.data).speed())  # data
""",
    "a value that is no member": """
    try:
        Phase(msg.data)
    except ValueError:
        return
    out.publish(1.0)  # control
""",
    "a known value": """
    if Phase(1) is Phase.STANCE:
        out.publish(1.0)  # clean
    out.publish(Phase(1).speed())  # clean
""",
    "the identity of another object": """
    if Plain(msg.data) is not None:
        out.publish(1.0)  # clean
""",
}
TAIL = """
rospy.Subscriber("in", UInt8, on)
rospy.spin()
"""


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_member_follows_the_data_of_its_value(body: str) -> None:
    assert differing(HEAD + "def on(msg):" + body + TAIL) == {}
