#!/usr/bin/env python3
"""Ice resurfacer: lay a film of water of even thickness, whatever the speed of the driver."""

import nozzles
import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64


class Resurfacer(object):
    WIDTH = 2.13  # width of the towel (m)
    MIN_SPEED = 0.4  # the water is shut at lower speeds (m/s)

    def __init__(self):
        self.film = rospy.get_param("~film_mm", 0.16)
        self.alpha = rospy.get_param("~speed_filter", 0.7)
        self.limit = rospy.get_param("~max_opening", 1.0)
        self.bend_share = rospy.get_param("~bend_share", 0.93)
        self.bend_rate = rospy.get_param("~bend_rate", 0.25)
        self.speed = 0.0
        self.turning = 0.0
        self.tank = 100.0
        self.valve = rospy.Publisher("water/valve", Float64, queue_size=1)
        rospy.Subscriber("water/tank_percent", Float64, self.on_tank)
        rospy.Subscriber("odom", Odometry, self.on_odom)

    def on_tank(self, msg):
        self.tank = msg.data

    def on_odom(self, msg):
        self.speed += self.alpha * (msg.twist.twist.linear.x - self.speed)
        self.turning = abs(msg.twist.twist.angular.z)
        self.update()

    def litres_per_minute(self):
        """Return the water for the film: 1 mm on 1 m² is one litre."""
        return self.film * self.WIDTH * self.speed * 60.0

    def opening(self):
        if self.speed < self.MIN_SPEED or self.tank < 2.0:
            return 0.0
        flow = self.litres_per_minute()
        if self.turning > self.bend_rate:
            flow *= self.bend_share  # laps overlap in the bends
        return min(self.limit, nozzles.opening_for(flow))

    def update(self):
        self.valve.publish(Float64(self.opening()))


if __name__ == "__main__":
    rospy.init_node("resurfacer")
    Resurfacer()
    rospy.spin()
