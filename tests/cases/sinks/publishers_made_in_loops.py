import rospy
from std_msgs.msg import Float64, Float64MultiArray, Bool
from sensor_msgs.msg import JointState

JOINTS = ["shoulder", "elbow", "wrist"]


class Arm:
    def __init__(self):
        self.pubs = []
        self.by_name = {}
        for j in JOINTS:
            pub = rospy.Publisher("/%s_controller/command" % j, Float64, queue_size=10)
            self.pubs.append(pub)
            self.by_name[j] = pub
        self.status = [rospy.Publisher("/status/" + j, Bool, queue_size=1) for j in JOINTS]
        self.targets = [0.0] * len(JOINTS)
        self.q = dict.fromkeys(JOINTS, 0.0)
        rospy.Subscriber("/command", Float64MultiArray, self.on_command)  # source cmd
        rospy.Subscriber("/joint_states", JointState, self.on_state)  # source js

    def on_command(self, msg):
        self.targets[:] = msg.data
        for i, value in enumerate(msg.data):
            self.pubs[i].publish(value)  # sink cmd
        self.pubs[0].publish(Float64(0.0))  # clean

    def on_state(self, msg):
        self.q.update(zip(msg.name, msg.position))
        for name, pub in self.by_name.items():
            pub.publish(Float64(data=self.q[name]))  # sink js
        for pub, target, name in zip(self.status, self.targets, JOINTS):
            pub.publish(abs(target - self.q[name]) < 0.01)  # sink cmd js

    def hold(self):
        for pub in self.pubs:
            pub.publish(0.0)  # clean


rospy.init_node("arm")
a = Arm()
rospy.on_shutdown(a.hold)
rospy.spin()
