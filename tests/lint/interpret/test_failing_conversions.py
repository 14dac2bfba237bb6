"""Library calls in a `try` that raise for some arguments: whether they do is a condition."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.lint.analysing import analysed

NODE = """
import ros_numpy
import rospy
from cv_bridge import CvBridge
bridge = CvBridge()
def on(msg):
    ok = False
    try:
        {call}
        ok = True
    except Exception:
        pass
    out.publish(ok)
out = rospy.Publisher("out", Bool)
rospy.Subscriber("in", Image, on)
"""


@pytest.mark.parametrize(
    ("call", "decides"),
    [
        ("CvBridge().imgmsg_to_cv2(msg, 'bgr8')", True),
        ("bridge.compressed_imgmsg_to_cv2(msg)", True),
        ("bridge.cv2_to_imgmsg(msg.data)", True),
        ("ros_numpy.point_cloud2.pointcloud2_to_array(msg)", True),
        ("float(msg.data)", True),
        ("bridge.show(msg)", False),
        ("bridge.go_to_place(msg)", False),
        ("rospy.loginfo(msg.data)", False),
    ],
)
def test_a_conversion_decides_by_its_argument(tmp_path: Path, call: str, decides: bool) -> None:
    kinds = [flow.kind for flow in analysed(tmp_path, node=NODE.format(call=call)).flows]
    assert kinds == ["implicit"] * decides
