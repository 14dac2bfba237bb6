"""Names mean the same constant in a file, a class or a function."""

from __future__ import annotations

from pathlib import Path

from pytest_tarl.repairing.name_scopes import name_scope
from pytest_tarl.searching.units import units, whole_constants
from tarl_lint.api import analyse

NODE = """\
import math
import rospy
import gains
from std_msgs.msg import Float64

YAW, dt = 0.785, 0.1


class Filter:
    def __init__(self, share):
        self.share = share

    def update(self, value, dt):
        return self.share * value * dt + dt + self.share


class Turner:
    def __init__(self):
        self.share = 0.25
        self.filter = Filter(self.share)
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_in)

    def on_in(self, msg):
        turned = math.cos(YAW) * msg.data + gains.KP
        turned += YAW * self.share * gains.KP
        self.out.publish(self.filter.update(turned, dt))


if __name__ == "__main__":
    rospy.init_node("turner")
    Turner()
    rospy.spin()
"""


def test_uses_are_united_only_where_a_name_means_the_same(tmp_path: Path) -> None:
    (tmp_path / "turner.py").write_text(NODE)
    (tmp_path / "gains.py").write_text("KP = 1.5\n")
    analysis = analyse([tmp_path / "turner.py", tmp_path / "gains.py"], root=tmp_path)
    used = [one for step in analysis.sites for one in analysis.operands(step.site)]
    found = {
        (unit.operands[0].code, tuple(one.span.line for one in unit.operands))
        for unit in whole_constants(units(used), name_scope(analysis))
    }
    assert ("YAW", (25, 26)) in found
    assert ("gains.KP", (25, 26)) in found
    assert ("dt", (14, 14)) in found  # the argument in line 27 is another name for the same number
    assert ("dt", (27,)) in found
    assert ("self.share", (14, 14)) in found
    assert ("self.share", (26,)) in found
