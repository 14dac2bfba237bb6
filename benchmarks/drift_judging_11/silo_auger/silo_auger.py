#!/usr/bin/env python
"""Discharge auger of a feed silo: run until the wagon is full, stop when the auger is jammed."""

import rospy
from std_msgs.msg import Bool, Float32, String

JAM_TORQUE = 55.0  # Nm
JAM_SAMPLES = 3
FULL = 300.0  # kg
TOP_SPEED = 1.0
FINE = 0.35  # speed for the last kilograms, as a share of full speed
FINE_FROM = 270.0


class SiloAuger(object):
    def __init__(self):
        self.load = 0.0
        self.high = 0
        self.state = "run"
        self.drive = rospy.Publisher("auger/drive", Float32, queue_size=1)
        self.status = rospy.Publisher("auger/status", String, queue_size=1)
        rospy.Subscriber("auger/torque", Float32, self.torque_cb)
        rospy.Subscriber("wagon/weight", Float32, self.weight_cb)
        rospy.Subscriber("stop_button", Bool, self.stop_cb)

    def torque_cb(self, msg):
        if msg.data > JAM_TORQUE:
            self.high += 1
        else:
            self.high = 0
        if self.high >= JAM_SAMPLES and self.state == "run":
            rospy.logerr("auger jammed at %.0f Nm", msg.data)
            self.state = "jammed"

    def weight_cb(self, msg):
        self.load = 0.7 * self.load + 0.3 * msg.data
        if self.load > FULL and self.state == "run":
            self.state = "full"

    def stop_cb(self, msg):
        if msg.data:
            self.state = "stopped"

    def spin_once(self):
        speed = 0.0
        if self.state == "run":
            speed = TOP_SPEED if self.load < FINE_FROM else FINE * TOP_SPEED
        self.drive.publish(speed)
        self.status.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("silo_auger")
    auger = SiloAuger()
    rate = rospy.Rate(5)
    while not rospy.is_shutdown():
        auger.spin_once()
        rate.sleep()
