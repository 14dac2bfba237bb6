#!/usr/bin/env python
"""Engrave rows into a wooden board with a laser on a gantry."""

import rospy
from geometry_msgs.msg import PointStamped, Twist
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool, Float32, String


class Engraver(object):
    def __init__(self):
        self.power = rospy.get_param("~power", 30.0)  # W
        self.feed = rospy.get_param("~feed", 60.0)  # mm/s
        self.travel = rospy.get_param("~travel", 150.0)  # speed with the laser off (mm/s)
        self.rows = rospy.get_param("~rows", 5)
        self.pitch = rospy.get_param("~pitch", 4.0)  # mm
        self.width = rospy.get_param("~width", 90.0)  # mm
        self.row = 0
        self.phase = "travel"
        self.x = self.y = 0.0
        self.speed = 0.0
        self.wanted = 0.0
        self.lid_open = True
        self.volts = 48.0
        self.density = 0.0
        self.laser = rospy.Publisher("laser/power", Float32, queue_size=1)
        self.gantry = rospy.Publisher("gantry/cmd", Twist, queue_size=1)
        self.panel = rospy.Publisher("panel/text", String, queue_size=1)
        rospy.Subscriber("gantry/place", PointStamped, self.on_place)
        rospy.Subscriber("gantry/speed", Float32, self.on_speed)
        rospy.Subscriber("lid/open", Bool, self.on_lid)
        rospy.Subscriber("supply", BatteryState, self.on_supply)
        rospy.Subscriber("board/density", Float32, self.on_density)

    def on_place(self, msg):
        self.x, self.y = msg.point.x, msg.point.y

    def on_speed(self, msg):
        self.speed = abs(msg.data)

    def on_lid(self, msg):
        self.lid_open = msg.data

    def on_supply(self, msg):
        self.volts = msg.voltage

    def on_density(self, msg):
        """Weight over volume of the board, for the protocol."""
        self.density = msg.data

    def beam(self):
        """Return the power that burns evenly while the gantry speeds up or slows down."""
        if self.phase != "burn" or self.wanted <= 0.0:
            return 0.0
        even = min(1.0, self.speed / self.wanted)
        sag = 48.0 / max(40.0, self.volts)
        return self.power * even * sag

    def along(self):
        """Return the speed along a row; slow down at its end."""
        left = self.width - self.x
        self.wanted = self.feed
        return self.wanted if left > 0.05 * self.wanted else 0.5 * self.wanted

    def step(self):
        cmd = Twist()
        if self.lid_open or self.row >= self.rows:
            self.phase = "travel"
        elif self.phase == "travel":
            cmd = self.to_row()
        elif self.x >= self.width:
            self.row += 1
            self.phase = "travel"
        else:
            cmd.linear.x = self.along()
        self.gantry.publish(cmd)
        self.laser.publish(self.beam())
        self.panel.publish("row %d of %d, %.0f kg/m3" % (self.row, self.rows, self.density))

    def to_row(self):
        cmd = Twist()
        aside = self.row * self.pitch - self.y
        if self.x <= 0.5 and abs(aside) < 0.2:
            self.phase = "burn"
            return cmd
        cmd.linear.x = max(-self.travel, -5.0 * self.x)
        cmd.linear.y = max(-20.0, min(20.0, 5.0 * aside))
        return cmd


if __name__ == "__main__":
    rospy.init_node("wood_engraver")
    engraver = Engraver()
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        engraver.step()
        rate.sleep()
