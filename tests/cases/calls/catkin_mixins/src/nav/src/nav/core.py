__all__ = ["OdomMixin", "Limiter", "settings"]
try:
    import rospy
except ImportError:
    rospy = None
from typing import TYPE_CHECKING
from nav_msgs.msg import Odometry

if TYPE_CHECKING:
    from geometry_msgs.msg import Twist

settings = {"odom": "odom", "limits": {"v": 0.5}}


class OdomMixin(object):
    def init_odom(self):
        self.pose = None
        self.twist = None
        self._odom_sub = rospy.Subscriber(settings["odom"], Odometry, self._on_odom)  # source odom

    def _on_odom(self, msg):
        self.pose = msg.pose.pose
        self.twist = msg.twist.twist
        self.on_pose(self.pose)

    def on_pose(self, pose):
        """Hook."""


class Limiter:
    def __init__(self, v=settings["limits"]["v"]):
        self.v = v

    def __call__(self, cmd):
        # type: (Twist) -> Twist
        cmd.linear.x = max(-self.v, min(self.v, cmd.linear.x))
        return cmd
