"""A loop over a literal with few elements: each iteration is analysed separately, like each call of a helper."""

import math

import rospy
from geometry_msgs.msg import PointStamped
from std_msgs.msg import Float64


def distance(a, b):
    return math.hypot(a.x - b.x, a.y - b.y)


class Ranger:
    def __init__(self):
        self.here = self.home = self.goal = None
        self.near = {}
        self.out = {
            "home": rospy.Publisher("to_home", Float64, queue_size=1),
            "goal": rospy.Publisher("to_goal", Float64, queue_size=1),
        }
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("here", PointStamped, self.on_here)  # source here
        rospy.Subscriber("home", PointStamped, self.on_home)  # source home
        rospy.Subscriber("goal", PointStamped, self.on_goal)  # source goal

    def on_here(self, msg):
        self.here = msg.point

    def on_home(self, msg):
        self.home = msg.point

    def on_goal(self, msg):
        self.goal = msg.point

    def tick(self):
        for name, place in (("home", self.home), ("goal", self.goal)):
            self.near[name] = distance(self.here, place)
        self.pub.publish(self.near["home"])  # sink here home
        self.pub.publish(self.near["goal"])  # sink here goal
        found = 0.0
        for place in [self.home, self.goal]:
            if place is None:
                continue
            found = place.x
        self.pub.publish(found)  # sink goal home
        last = 0.0
        for place in [self.home, self.goal]:
            last = place.x
        self.pub.publish(last)  # sink goal
        for place in (self.goal, self.home):
            first = place.y
            break
        self.pub.publish(first)  # sink goal
        total = 0.0
        for part in (self.here.x, self.here.y):
            total += part
        self.pub.publish(total)  # sink here
        for place in (self.home, self.goal):
            if place.x < 1.0:
                break
        else:
            self.pub.publish(0.0)  # sink ~home ~goal
        self.pub.publish(1.0)  # clean


def main():
    rospy.init_node("ranger")
    ranger = Ranger()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        ranger.tick()
        rate.sleep()


if __name__ == "__main__":
    main()
