#!/usr/bin/env python3
"""A script with globals, flags, a loop in the main part, and a lock around them."""

import math
import threading

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float32

lock = threading.Lock()
pose = {"x": 0.0, "y": 0.0}
regions = {"front": 10.0, "left": 10.0}
state, turn_sign = 0, 1
paused = False
started = None
STATES = {0: "find", 1: "turn", 2: "follow"}


def on_odom(msg):
    with lock:
        pose["x"], pose["y"] = msg.pose.pose.position.x, msg.pose.pose.position.y


def on_scan(msg):
    global regions
    regions = {"front": min(min(msg.ranges[0:30]), 10), "left": min(min(msg.ranges[60:120]), 10)}
    decide()


def on_pause(msg):
    global paused
    paused = bool(msg.data)


def change(new):
    global state
    if new != state:
        rospy.loginfo("state %s", STATES[new])
        state = new


def decide():
    if regions["front"] > 1 and regions["left"] > 1:
        change(0)
    elif regions["front"] < 1:
        change(1)
    else:
        change(2)


def command():
    twist = Twist()
    if state == 0:
        twist.linear.x = 0.2
    elif state == 1:
        twist.angular.z = 0.3 * turn_sign
    elif state == 2:
        twist.linear.x = 0.5 * regions["left"]
    return twist


def main():
    global started
    rospy.init_node("wall")
    started = rospy.Time.now()
    cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
    far = rospy.Publisher("distance", Float32, queue_size=1)
    age = rospy.Publisher("age", Float32, queue_size=1)
    rospy.Subscriber("odom", Odometry, on_odom)  # source odom
    rospy.Subscriber("scan", LaserScan, on_scan)  # source scan
    rospy.Subscriber("pause", Bool, on_pause)  # source pause
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        if not paused:
            cmd.publish(command())  # sink scan ~pause
        else:
            cmd.publish(Twist())  # sink ~pause
        with lock:
            far.publish(math.hypot(pose["x"], pose["y"]))  # sink odom
        age.publish((rospy.Time.now() - started).to_sec())  # clean
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
