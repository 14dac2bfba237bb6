import copy
import weakref
import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64


class Shared(object):
    __slots__ = ("x", "y", "other")

    def __init__(self):
        self.x = self.y = self.other = 0.0


class Loose(object):
    def __init__(self, **kw):
        self.__dict__.update(kw)


class Owner:
    def __init__(self):
        self.shared = Shared()
        self.loose = Loose(gain=2.0, x=0.0)
        self.child = Child(self)
        self.child2 = Child2(weakref.ref(self))
        self.a = rospy.Publisher("a", Float64, queue_size=1)
        self.b = rospy.Publisher("b", Float64, queue_size=1)
        self.c = rospy.Publisher("c", Float64, queue_size=1)
        self.d = rospy.Publisher("d", Float64, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.cb)  # source odom

    def cb(self, msg):
        for name in ("x", "y"):
            setattr(self.shared, name, getattr(msg.pose.pose.position, name))
        vars(self.loose).update(x=msg.pose.pose.position.x)
        self.a.publish(self.shared.x)  # sink odom
        self.b.publish(self.shared.other)  # clean
        self.c.publish(self.loose.x)  # sink odom
        self.d.publish(self.loose.gain)  # clean
        self.child.go()
        self.child2.go()


class Child:
    def __init__(self, owner):
        self.owner = owner

    def go(self):
        self.owner.a.publish(self.owner.shared.y)  # sink odom
        dup = copy.copy(self.owner.shared)
        dup.x = 0.0
        self.owner.a.publish(dup.x)  # clean
        self.owner.b.publish(self.owner.shared.x)  # sink odom


class Child2:
    def __init__(self, ref):
        self.ref = ref

    def go(self):
        owner = self.ref()
        if owner is not None:
            owner.c.publish(owner.shared.y)  # sink odom


rospy.init_node("o")
o = Owner()
rospy.spin()
