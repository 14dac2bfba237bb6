"""`a += b` on containers and arrays."""

from __future__ import annotations

import pytest

from tests.lint.analysing import analysed

NODE = """
import rospy
import numpy as np
from std_msgs.msg import Float32
pub = rospy.Publisher("out", Float32)
total = {made}
def on(msg):
    {grows}
    pub.publish({sent})
rospy.Subscriber("in", Float32, on)
rospy.spin()
"""


@pytest.mark.parametrize(
    ("made", "grows", "sent", "kind"),
    [
        ("[]", "total.extend([msg.data])", "total[-1]", "explicit"),
        ("[[]]", "part = total[0]; part += [msg.data]", "total[0][0]", "explicit"),
        ("[[]]", "part = total[0]; part += [msg.data]", "len(total[0])", None),
        ("[[]]", "part = total[0]; part += msg.items", "len(total[0])", "explicit"),
        ("np.zeros((3, 3))", "part = total[0]; part += msg.data", "total[0][1]", "explicit"),
        ("{}", "part = total; part |= {'a': msg.data}", "total['a']", "explicit"),
    ],
)
def test_elements_added_in_place_are_in_the_container(tmp_path, made, grows, sent, kind):
    found = analysed(tmp_path, node=NODE.format(made=made, grows=grows, sent=sent)).flows
    assert [f.kind for f in found] == ([kind] if kind else [])
