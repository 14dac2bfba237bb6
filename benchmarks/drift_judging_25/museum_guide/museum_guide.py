#!/usr/bin/env python
"""Guides a group through a museum: drives from exhibit to exhibit, talks there, and waits for those who linger."""

import math
import os

import rospy
import yaml
from geometry_msgs.msg import Pose2D, Twist
from std_msgs.msg import Float32, Int32, String


def wrap(angle):
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def load_config():
    """Return the settings of the tour, from the file beside this script unless a parameter names another."""
    default = os.path.join(os.path.dirname(os.path.abspath(__file__)), "tour.yaml")
    with open(rospy.get_param("~tour", default)) as stream:
        return yaml.safe_load(stream)


class MuseumGuide(object):
    def __init__(self):
        self.config = load_config()
        self.stops = list(self.config["stops"])
        self.visited = 0
        self.pose = None
        self.farthest = None
        self.count = 0
        self.expected = self.config["group"]["size"]
        self.talk_until = None
        self.waits = 0
        self.waiting = False
        self.cmd_pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.say_pub = rospy.Publisher("guide/say", String, queue_size=2)
        self.visited_pub = rospy.Publisher("guide/visited", Int32, queue_size=1, latch=True)
        rospy.Subscriber("odom/pose", Pose2D, self.pose_cb)
        rospy.Subscriber("group/farthest", Float32, self.farthest_cb)
        rospy.Subscriber("group/count", Int32, self.count_cb)
        rospy.Timer(rospy.Duration(0.2), self.drive)
        rospy.Timer(rospy.Duration(10.0), self.note)

    def pose_cb(self, msg):
        self.pose = (msg.x, msg.y, msg.theta)

    def farthest_cb(self, msg):
        if msg.data >= 0.0:
            self.farthest = msg.data

    def count_cb(self, msg):
        self.count = msg.data
        if msg.data > self.expected:
            rospy.logwarn_throttle(30.0, "%d people follow a group of %d", msg.data, self.expected)

    def group_factor(self):
        """Return the part of the speed at which the group keeps up."""
        if self.farthest is None:
            return 0.0
        group = self.config["group"]
        return max(0.0, min(1.0, (group["leash"] - self.farthest) / group["slow_band"]))

    def talk(self):
        """Talk at an exhibit; return whether the guide still does."""
        now = rospy.get_time()
        if self.talk_until is None:
            self.talk_until = now + self.config["talk_time"]
            self.say_pub.publish("exhibit %d" % self.stops[0]["exhibit"])
        if now < self.talk_until:
            return True
        self.talk_until = None
        self.stops.pop(0)
        self.visited += 1
        self.visited_pub.publish(self.visited)
        return False

    def drive(self, event):
        command = Twist()
        if self.pose is not None and self.stops:
            x, y, heading = self.pose
            dx, dy = self.stops[0]["x"] - x, self.stops[0]["y"] - y
            away = math.hypot(dx, dy)
            if away < self.config["drive"]["arrived"] or self.talk_until is not None:
                self.talk()
            else:
                drive = self.config["drive"]
                turn = wrap(math.atan2(dy, dx) - heading)
                factor = self.group_factor()
                if factor == 0.0 and not self.waiting:
                    self.waits += 1
                self.waiting = factor == 0.0
                speed = min(drive["speed"], drive["slow_down"] * away) * factor
                command.linear.x = speed * max(0.0, math.cos(turn))
                command.angular.z = max(-drive["turn"], min(drive["turn"], drive["turn_gain"] * turn))
        self.cmd_pub.publish(command)

    def note(self, event):
        rospy.loginfo("%d exhibits, %d people, waited %d times", self.visited, self.count, self.waits)


if __name__ == "__main__":
    rospy.init_node("museum_guide")
    MuseumGuide()
    rospy.spin()
