"""A script as beginners write it: globals, a main guard, message reused, modes by text."""

import sys

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Joy
from std_msgs.msg import Float32, String

global_vel = Twist()
scale = 1.0
mode = "manual"
last_axes = (0.0, 0.0)
speeds = dict(slow=0.1, fast=1.0)


def joy_cb(data):
    global last_axes, mode
    if data.buttons[0] == 1:
        mode = "auto"
    last_axes = data.axes[0], data.axes[1]
    global_vel.linear.x = scale * data.axes[1]
    global_vel.angular.z = data.axes[0]


def scale_cb(data):
    global scale
    scale = max(0.1, min(data.data, 2.0))


def status(pub):
    if mode == "manual":
        pub.publish("manual at %.1f" % scale)  # sink ~joy scale
    else:
        pub.publish("auto")  # sink ~joy


def main(argv):
    rospy.init_node("teleop")
    pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
    text = rospy.Publisher("mode", String, queue_size=1)
    fixed = rospy.Publisher("fixed", Float32, queue_size=1)
    rospy.Subscriber("joy", Joy, joy_cb)  # source joy
    rospy.Subscriber("scale", Float32, scale_cb)  # source scale
    rate = rospy.Rate(20)
    try:
        while not rospy.is_shutdown():
            if mode == "manual":
                pub.publish(global_vel)  # sink joy scale
            else:
                auto = Twist()
                auto.linear.x = speeds["slow"]
                pub.publish(auto)  # sink ~joy
            status(text)
            fixed.publish(speeds["fast"])  # clean
            fixed.publish(float(len(argv)))  # clean
            rate.sleep()
    except rospy.ROSInterruptException:
        pass
    finally:
        pub.publish(Twist())  # clean


if __name__ == "__main__":
    main(sys.argv)
