#!/usr/bin/env python3
"""Fill a tank from which water is drawn; a relay switches the pump."""

import rospy
from std_msgs.msg import Bool, Float64

LEVEL = 0.6  # level below which the pump runs (m)
reading = None
relay = None


def on_level(msg):
    """Store the level and switch the pump."""
    global reading
    reading = msg.data
    switch()


def switch():
    """Switch the relay."""
    running = False
    if reading < LEVEL:
        running = True
    relay.publish(Bool(running))


def main():
    """Run the node."""
    global relay
    rospy.init_node("pump")
    relay = rospy.Publisher("relay", Bool, queue_size=1)
    rospy.Subscriber("level", Float64, on_level)
    rospy.spin()


if __name__ == "__main__":
    main()
