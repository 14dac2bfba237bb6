#!/usr/bin/env python
"""Runs the belt between a blower and a filler: its speed follows the fill of the buffer in front of the filler."""

from bisect import bisect_right

import rospy
from std_msgs.msg import Bool, Float32, Int32, String


class SpeedTable(object):
    """A look-up table from the fill of the buffer to the speed of the belt, with hysteresis."""

    def __init__(self, rows, hysteresis):
        self.edges = [edge for edge, _ in rows[1:]]
        self.speeds = [speed for _, speed in rows]
        self.hysteresis = hysteresis
        self.row = len(rows) - 1

    def speed(self, fill):
        up = bisect_right(self.edges, fill - self.hysteresis)
        down = bisect_right(self.edges, fill + self.hysteresis)
        if self.row < up:
            self.row = up
        elif self.row > down:
            self.row = down
        return self.speeds[self.row]


class Conveyor(object):
    # fill of the buffer in bottles, speed in m/s
    TABLE = ((0, 0.6), (14, 0.38), (22, 0.16), (30, 0.0))

    def __init__(self):
        self.table = SpeedTable(self.TABLE, rospy.get_param("~hysteresis", 2))
        self.jam_after = rospy.get_param("~jam_after", 8.0)  # s without a bottle
        self.max_speed = rospy.get_param("~max_speed", 0.65)
        self.fill = None
        self.height = None
        self.running = False
        self.bottles = 0
        self.bottle_at = rospy.get_time()
        self.speed_pub = rospy.Publisher("belt/speed", Float32, queue_size=1)
        self.alarm_pub = rospy.Publisher("belt/alarm", String, queue_size=1)
        self.count_pub = rospy.Publisher("belt/bottles", Int32, queue_size=1)
        rospy.Subscriber("buffer/fill", Int32, self.on_fill)
        rospy.Subscriber("gate/bottle", Float32, self.on_bottle)
        rospy.Subscriber("panel/run", Bool, self.on_run)
        rospy.Timer(rospy.Duration(0.1), self.tick)
        rospy.Timer(rospy.Duration(5.0), self.show)

    def on_fill(self, msg):
        if msg.data >= 0:
            self.fill = msg.data

    def on_bottle(self, msg):
        """Count a bottle that passes the light gate, with its height in m."""
        self.bottles += 1
        self.bottle_at = rospy.get_time()
        self.height = msg.data

    def on_run(self, msg):
        if msg.data != self.running:
            rospy.loginfo("belt %s", "starts" if msg.data else "stops")
            self.bottle_at = rospy.get_time()
        self.running = msg.data

    def jammed(self, speed):
        if speed < 0.05:
            self.bottle_at = rospy.get_time()
        return rospy.get_time() - self.bottle_at > self.jam_after

    def tick(self, event):
        speed = 0.0
        if self.running and self.fill is not None:
            speed = min(self.max_speed, self.table.speed(self.fill))
            if self.jammed(speed):
                self.alarm_pub.publish("no bottle for %.0f s" % self.jam_after)
                speed = 0.0
        self.speed_pub.publish(speed)

    def show(self, event):
        self.count_pub.publish(self.bottles)
        if self.height is not None:
            rospy.loginfo("%d bottles, last %.2f m high", self.bottles, self.height)


if __name__ == "__main__":
    rospy.init_node("bottle_conveyor")
    Conveyor()
    rospy.spin()
