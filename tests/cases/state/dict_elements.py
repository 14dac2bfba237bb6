import rospy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

NAMES = ("shoulder", "elbow")


class Joints:
    def __init__(self):
        self.position = {}
        self.target = {"shoulder": 0.0, "elbow": 0.0, "gain": 2.0}
        self.nested = {"arm": {"left": 0.0, "right": 0.0}}
        self.seen = dict(speed=0.0, limit=3.0)
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("joint_states", JointState, self.on_joints)  # source joints
        rospy.Subscriber("elbow", Float64, self.on_elbow)  # source elbow
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_joints(self, msg):
        for name, position in zip(msg.name, msg.position):
            self.position[name] = position

    def on_elbow(self, msg):
        self.target["elbow"] = msg.data
        self.nested["arm"]["left"] = msg.data
        self.seen["speed"] = msg.data

    def tick(self, event):
        self.pub.publish(self.position["shoulder"])  # sink joints
        self.pub.publish(self.position.get("elbow", 0.0))  # sink joints
        self.pub.publish(self.target["elbow"])  # sink elbow
        self.pub.publish(self.target["shoulder"])  # clean
        self.pub.publish(self.target["gain"])  # clean
        error = self.target["elbow"] - self.position["elbow"]
        self.pub.publish(error * self.target["gain"])  # sink elbow joints
        self.pub.publish(self.nested["arm"]["left"])  # sink elbow
        self.pub.publish(self.nested["arm"]["right"])  # clean
        self.pub.publish(self.seen["speed"])  # sink elbow
        self.pub.publish(self.seen["limit"])  # clean
        for name in NAMES:
            self.pub.publish(self.position[name])  # sink joints
        for name, value in self.position.items():
            self.pub.publish(value)  # sink joints
        for value in self.target.values():
            self.pub.publish(value)  # sink elbow


rospy.init_node("joints")
Joints()
rospy.spin()
