"""The walrus, star unpacking, state rebuilt by comprehensions, chained comparisons, conditional expressions."""

import rospy
from geometry_msgs.msg import Point, PoseArray
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, Float64MultiArray, String


class Collector:
    def __init__(self):
        self.joints = {}
        self.targets = []
        self.limits = {"a": (-1.0, 1.0), "b": (-2.0, 2.0)}
        self.pub = rospy.Publisher("value", Float64, queue_size=1)
        self.many = rospy.Publisher("many", Float64MultiArray, queue_size=1)
        self.point = rospy.Publisher("point", Point, queue_size=1)
        self.text = rospy.Publisher("text", String, queue_size=1)
        rospy.Subscriber("joint_states", JointState, self.on_joints)  # source joints
        rospy.Subscriber("targets", PoseArray, self.on_targets)  # source targets
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_joints(self, msg):
        self.joints |= {n: (p, *rest) for n, p, *rest in zip(msg.name, msg.position, msg.velocity, msg.effort)}

    def on_targets(self, msg):
        first, *others = [p.position for p in msg.poses]
        self.targets = [first, *others]
        x, y, z = (getattr(first, axis) for axis in "xyz")
        self.point.publish(x, 0.0, z)  # sink targets
        self.point.publish(Point(*[0.0] * 3))  # clean

    def tick(self, _):
        if (entry := self.joints.get("a")) is not None and (speed := entry[1]):
            self.pub.publish(speed)  # sink joints
        while (n := len(self.limits)) > 2:
            self.limits.popitem()
        self.pub.publish(n)  # clean
        low, high = self.limits["a"]
        self.pub.publish(low + high)  # clean
        inside = {k: low <= v[0] <= high for k, v in self.joints.items()}
        self.text.publish("ok" if all(inside.values()) else "out of range")  # sink ~joints
        if near := [t for t in self.targets if t.x**2 + t.y**2 < 1.0]:
            self.many.publish(Float64MultiArray(data=[c for t in near for c in (t.x, t.y)]))  # sink targets
        names = sorted({*self.limits} | {"c"})
        self.text.publish(",".join(names))  # clean


if __name__ == "__main__":
    rospy.init_node("collector")
    Collector()
    rospy.spin()
