import math
import rospy
from geometry_msgs.msg import Twist, Point
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64, String, Int32


class Vec:
    __slots__ = ("x", "y")

    def __init__(self, x=0.0, y=0.0):
        self.x = x
        self.y = y

    def __add__(self, other):
        return Vec(self.x + other.x, self.y + other.y)

    def __sub__(self, other):
        return Vec(self.x - other.x, self.y - other.y)

    def __mul__(self, k):
        return Vec(self.x * k, self.y * k)

    __rmul__ = __mul__

    def __neg__(self):
        return Vec(-self.x, -self.y)

    def __abs__(self):
        return math.hypot(self.x, self.y)

    def __eq__(self, other):
        return self.x == other.x

    def __iter__(self):
        yield self.x
        yield self.y

    def __iadd__(self, other):
        self.x += other.x
        return self

    def __str__(self):
        return "vector"


class Ring:
    def __init__(self, n):
        self.items = [0.0] * n
        self.at = 0

    def __len__(self):
        return len(self.items)

    def __getitem__(self, i):
        return self.items[(self.at + i) % len(self.items)]

    def __setitem__(self, i, value):
        self.items[(self.at + i) % len(self.items)] = value

    def __contains__(self, item):
        return item in self.items


class Scale:
    """Descriptor."""

    def __init__(self, k):
        self.k = k

    def __set_name__(self, owner, name):
        self.name = "_" + name

    def __get__(self, obj, owner=None):
        return getattr(obj, self.name, 0.0) * self.k

    def __set__(self, obj, value):
        setattr(obj, self.name, value)


class Session:
    def __init__(self, out):
        self.out = out
        self.value = 0.0

    def __enter__(self):
        self.value = 1.0
        return self

    def __exit__(self, kind, value, trace):
        self.out.publish(self.value)  # sink odom
        return False


class Node:
    speed = Scale(2.0)

    def __init__(self):
        self.goal = Vec(1.0, 2.0)
        self.ring = Ring(4)
        self.pub = rospy.Publisher("p", Float64, queue_size=1)
        self.n = rospy.Publisher("n", Int32, queue_size=1)
        self.s = rospy.Publisher("s", String, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.cb)  # source odom

    def cb(self, msg):
        here = Vec(msg.pose.pose.position.x, 0.0)
        diff = self.goal - here
        self.pub.publish(diff.x)  # sink odom
        self.pub.publish(diff.y)  # clean
        half = 0.5 * -diff
        self.pub.publish(half.y)  # clean
        self.pub.publish(abs(half))  # sink odom
        self.n.publish(here == self.goal)  # sink odom
        x, y = diff
        self.pub.publish(x)  # sink odom
        self.goal += here
        self.pub.publish(self.goal.x)  # sink odom
        self.pub.publish(self.goal.y)  # clean
        self.s.publish(str(here))  # clean
        self.ring[0] = msg.pose.pose.position.x
        self.n.publish(len(self.ring))  # clean
        self.pub.publish(self.ring[2])  # sink odom
        self.n.publish(3.0 in self.ring)  # sink odom
        self.speed = msg.twist.twist.linear.x
        self.pub.publish(self.speed)  # sink odom
        with Session(self.pub) as s:
            s.value = here.x
        with Session(self.pub) as s:
            self.pub.publish(s.value)  # clean


rospy.init_node("n")
Node()
rospy.spin()
