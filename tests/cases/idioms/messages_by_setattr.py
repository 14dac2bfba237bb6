"""Messages filled by `setattr`, keywords from dicts, attribute paths, and generic copies over `__slots__`."""

from functools import reduce

import rospy
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Twist
from sensor_msgs.msg import Joy
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker

AXES = {"linear.x": 1, "angular.z": 0}
COLOR = dict(r=1.0, g=0.2, b=0.0, a=1.0)


def assign(message, path, value):
    *parents, last = path.split(".")
    setattr(reduce(getattr, parents, message), last, value)


def copy_fields(source, target, names):
    for name in names:
        setattr(target, name, getattr(source, name))
    return target


class Filler:
    def __init__(self):
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.pose = rospy.Publisher("pose", PoseStamped, queue_size=1)
        self.marker = rospy.Publisher("marker", Marker, queue_size=1)
        self.color = rospy.Publisher("color", ColorRGBA, queue_size=1)
        rospy.Subscriber("joy", Joy, self.on_joy)  # source joy
        rospy.Subscriber("goal", PoseStamped, self.on_goal)  # source goal

    def on_joy(self, joy):
        twist = Twist()
        for path, index in AXES.items():
            assign(twist, path, joy.axes[index])
        self.cmd.publish(twist)  # sink joy
        still = Twist()
        for path in AXES:
            assign(still, path, 0.0)
        self.cmd.publish(still)  # clean

    def on_goal(self, msg):
        fields = {"position": Point(msg.pose.position.x, 0.0, 0.0), "orientation": Quaternion(w=1.0)}
        header = Header(stamp=rospy.Time.now(), frame_id="map")
        self.pose.publish(PoseStamped(header=header, pose=Pose(**fields)))  # sink goal
        self.pose.publish(header=header, pose=Pose(orientation=fields["orientation"]))  # clean
        marker = Marker(type=Marker.SPHERE, ns="goal", color=ColorRGBA(**COLOR), header=header)
        marker.scale.x = marker.scale.y = marker.scale.z = 0.2
        self.marker.publish(marker)  # clean
        copy_fields(msg, marker, ["pose"])
        self.marker.publish(marker)  # sink goal
        options = {}
        options.update(COLOR)
        self.color.publish(**options)  # clean
        options["g"] = abs(msg.pose.position.y)
        self.color.publish(**options)  # sink goal


if __name__ == "__main__":
    rospy.init_node("filler")
    Filler()
    rospy.spin()
