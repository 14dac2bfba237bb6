#!/usr/bin/env python
"""Shutter of a small observatory: without end switches, its motor runs for a time; a clutch slips at the stops."""

import rospy
from std_msgs.msg import Bool, Int8, String

shutter = {"moving": 0, "since": 0.0, "status": "closed"}
motor_pub = None
status_pub = None


def on_rain(msg):
    if msg.data and shutter["status"] in ("open", "opening"):
        rospy.logwarn("rain: closing")
        move(-1)


def on_command(msg):
    if msg.data == "open" and shutter["status"] == "closed":
        move(1)
    elif msg.data == "close" and shutter["status"] == "open":
        move(-1)


def move(direction):
    shutter["moving"] = direction
    shutter["since"] = rospy.get_time()
    shutter["status"] = "opening" if direction > 0 else "closing"


def tick(event):
    if shutter["moving"] and rospy.get_time() - shutter["since"] > 24.0:
        shutter["status"] = "open" if shutter["moving"] > 0 else "closed"
        shutter["moving"] = 0
    motor_pub.publish(shutter["moving"])
    status_pub.publish(shutter["status"])


def main():
    global motor_pub, status_pub
    rospy.init_node("dome_shutter")
    motor_pub = rospy.Publisher("shutter/motor", Int8, queue_size=1)
    status_pub = rospy.Publisher("shutter/status", String, queue_size=1)
    rospy.Subscriber("shutter/command", String, on_command)
    rospy.Subscriber("weather/rain", Bool, on_rain)
    rospy.Timer(rospy.Duration(0.5), tick)
    rospy.spin()


if __name__ == "__main__":
    main()
