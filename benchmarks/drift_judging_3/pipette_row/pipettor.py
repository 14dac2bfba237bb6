#!/usr/bin/env python3
# -*- coding: utf-8 -*-
"""Transfer a volume from a trough into each well of a row."""

import rospy
from liquid_classes import LiquidClass
from std_msgs.msg import Float64, Float64MultiArray, Int16, String

SAFE_Z = 20.0  # height above the deck (mm)
TROUGH_Z = 2.0
WELL_Z = 5.0
TROUGH = -1  # position of the trough; wells are counted from 0


class Pipettor(object):
    def __init__(self):
        self.liquid = LiquidClass(rospy.get_param("~liquid_class", "aqueous"))
        self.travel = rospy.get_param("~travel_time", 0.5)
        self.volumes = None
        self.z = None
        self.x_pub = rospy.Publisher("head/x", Int16, queue_size=1, latch=True)
        self.z_pub = rospy.Publisher("head/z", Float64, queue_size=1, latch=True)
        self.piston_pub = rospy.Publisher("head/piston", Float64, queue_size=1, latch=True)
        self.speed_pub = rospy.Publisher("head/piston_speed", Float64, queue_size=1, latch=True)
        self.status_pub = rospy.Publisher("row/status", String, queue_size=1, latch=True)
        rospy.Subscriber("row/volumes", Float64MultiArray, self.volumes_cb)
        rospy.Subscriber("head/z_state", Float64, self.z_cb)

    def volumes_cb(self, msg):
        self.volumes = msg.data

    def z_cb(self, msg):
        self.z = msg.data

    def go_z(self, height):
        """Move the head up or down and wait until it has arrived."""
        self.z_pub.publish(height)
        poll = rospy.Rate(20)
        while not rospy.is_shutdown():
            if abs(self.z - height) < 0.5:
                return
            poll.sleep()

    def go_x(self, place):
        """Move over a well or the trough, with the head up."""
        self.go_z(SAFE_Z)
        self.x_pub.publish(place)
        rospy.sleep(self.travel)

    def move_piston(self, to, speed):
        """Start the piston; at 0 the tip is empty, below 0 is the blow-out."""
        self.speed_pub.publish(speed)
        self.piston_pub.publish(to)

    def aspirate(self, volume):
        """Draw liquid; keep the tip in it, since the liquid follows the piston with a delay."""
        self.go_x(TROUGH)
        self.go_z(TROUGH_Z)
        self.move_piston(volume, self.liquid.aspirate)
        rospy.sleep(self.liquid.stroke_time(volume))
        rospy.sleep(self.liquid.settle)

    def dispense(self, well, volume):
        """Empty the tip into a well."""
        self.go_x(well)
        self.go_z(WELL_Z)
        self.move_piston(-self.liquid.blow_out, self.liquid.dispense)
        rospy.sleep(self.liquid.eject_time(volume))

    def run(self):
        while not rospy.is_shutdown() and (self.volumes is None or self.z is None):
            rospy.sleep(0.05)
        for well, volume in enumerate(self.volumes):
            self.status_pub.publish("well %d" % well)
            self.aspirate(volume)
            self.dispense(well, volume)
        self.go_z(SAFE_Z)
        self.status_pub.publish("done")
        rospy.spin()


if __name__ == "__main__":
    rospy.init_node("pipettor")
    try:
        Pipettor().run()
    except rospy.ROSInterruptException:
        pass
