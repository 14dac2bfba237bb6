import math
import functools
import operator
import rospy
from geometry_msgs.msg import PoseStamped, Point, PoseArray
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64, Int32

WAYPOINTS = [(0.0, 1.0), (2.0, 3.0), (4.0, 1.0)]


class Planner:
    def __init__(self):
        self.x = self.y = 0.0
        self.people = []
        self.pub = rospy.Publisher("goal", Point, queue_size=1)
        self.n = rospy.Publisher("n", Int32, queue_size=1)
        self.d = rospy.Publisher("d", Float64, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.on_odom)  # source odom
        rospy.Subscriber("people", PoseArray, self.on_people)  # source people

    def on_odom(self, m):
        self.x, self.y = m.pose.pose.position.x, m.pose.pose.position.y
        near = min(WAYPOINTS, key=self.distance)
        self.pub.publish(Point(x=near[0], y=near[1]))  # sink ~odom
        ordered = sorted(WAYPOINTS, key=lambda w: math.hypot(w[0] - self.x, w[1] - self.y))
        self.pub.publish(Point(ordered[0][0], ordered[0][1], 0.0))  # sink ~odom
        self.pub.publish(Point(*WAYPOINTS[0], 0.0))  # clean
        close = [w for w in WAYPOINTS if self.distance(w) < 1.0]
        self.n.publish(len(close))  # sink ~odom
        close2 = list(filter(lambda w: self.distance(w) < 1.0, WAYPOINTS))
        self.n.publish(len(close2))  # sink ~odom
        self.n.publish(sum(1 for w in WAYPOINTS if self.distance(w) < 1))  # sink ~odom
        self.n.publish(len(WAYPOINTS))  # clean
        self.n.publish(any(self.distance(w) < 1.0 for w in WAYPOINTS))  # sink odom

    def on_people(self, m):
        self.people = [p.position for p in m.poses]
        total = functools.reduce(lambda acc, p: acc + p.x, self.people, 0.0)
        self.d.publish(total)  # sink people
        best = max(self.people, key=operator.attrgetter("x"), default=None)
        if best is not None:
            self.pub.publish(best)  # sink people
        dists = list(map(self.distance2, self.people))
        self.d.publish(min(dists))  # sink people odom
        for i, p in enumerate(self.people):
            self.n.publish(i)  # sink ~people
            self.d.publish(p.y)  # sink people

    def distance(self, w):
        return math.hypot(w[0] - self.x, w[1] - self.y)

    def distance2(self, p):
        return math.hypot(p.x - self.x, p.y - self.y)


rospy.init_node("planner")
Planner()
rospy.spin()
