#!/usr/bin/env python
import rospy
from geometry_msgs.msg import TwistStamped
from std_msgs.msg import Float32

# Cleans a ship's hull strip by strip. Steers by the echo of the last weld seam.

KP = 0.5  # 1/s
TRACK = 0.15  # m/s
DEPTH_MAX = 9.0

seam = 0.0
depth = 1.0


def on_seam(m):
    """Return the offset from the middle of the strip, m (positive: too far aft)."""
    global seam
    seam = m.data


def on_depth(m):
    global depth
    depth = m.data


def steer():
    return -KP * seam


def loop():
    pub = rospy.Publisher("crawler/cmd", TwistStamped, queue_size=2)
    rospy.Subscriber("sonar/seam", Float32, on_seam)
    rospy.Subscriber("depth", Float32, on_depth)
    r = rospy.Rate(4)
    while not rospy.is_shutdown():
        out = TwistStamped()
        out.twist.linear.x = TRACK if depth < DEPTH_MAX else 0.0
        out.twist.linear.y = steer()
        pub.publish(out)
        r.sleep()


if __name__ == "__main__":
    rospy.init_node("hull_crawler")
    loop()
