#!/usr/bin/env python3
"""Solder the joints of a board one after the other; heat each for as long as its pad needs."""

import rospy
from solder_profile import IRON, MOTION, dwell
from std_msgs.msg import Bool, Float32, Float32MultiArray


class SolderingHead:
    """Sequential program of the head."""

    def __init__(self):
        self.pads = None
        self.tip = None
        self.touch_pub = rospy.Publisher("head/touch", Float32, queue_size=1)
        self.iron_pub = rospy.Publisher("iron/setpoint", Float32, queue_size=1)
        self.joint_pub = rospy.Publisher("head/joint", Float32, queue_size=1)
        self.done_pub = rospy.Publisher("board/done", Bool, queue_size=1)
        rospy.Subscriber("board/pads", Float32MultiArray, self.pads_cb)
        rospy.Subscriber("iron/tip", Float32, self.tip_cb)

    def pads_cb(self, msg):
        """Store the areas of the pads in mm²."""
        self.pads = list(msg.data)

    def tip_cb(self, msg):
        """Store the temperature of the tip."""
        self.tip = msg.data

    def wait_for_board(self):
        """Wait until a board is present and the iron is hot."""
        self.iron_pub.publish(IRON["temperature"])
        while not rospy.is_shutdown() and (self.pads is None or self.tip is None):
            rospy.sleep(0.05)
        while not rospy.is_shutdown() and self.tip < IRON["temperature"] - IRON["ready_within"]:
            rospy.sleep(0.05)

    def solder(self, index, area):
        """Make one joint."""
        self.joint_pub.publish(float(index))
        rospy.sleep(MOTION["approach"])
        seconds = dwell(area)
        self.touch_pub.publish(seconds)
        rospy.sleep(seconds + MOTION["retract"] + MOTION["cool"])

    def run(self):
        """Solder one board."""
        self.wait_for_board()
        for index, area in enumerate(self.pads or []):
            self.solder(index, area)
        self.iron_pub.publish(IRON["idle"])
        self.done_pub.publish(True)


if __name__ == "__main__":
    rospy.init_node("soldering")
    SolderingHead().run()
    rospy.spin()
