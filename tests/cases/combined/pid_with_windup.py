import rospy
from dataclasses import dataclass, field
from std_msgs.msg import Float64, Header
from sensor_msgs.msg import JointState
from control_msgs.msg import JointControllerState


@dataclass
class Gains:
    p: float = 1.0
    i: float = 0.0
    d: float = 0.0
    windup: float = 5.0


class PID:
    def __init__(self, gains):
        self.g = gains
        self.reset()

    def reset(self):
        self.integral = 0.0
        self.prev = None

    def __call__(self, error, dt):
        self.integral += error * dt  # step joint sp
        self.integral = max(-self.g.windup, min(self.g.windup, self.integral))  # step joint sp
        derivative = 0.0 if self.prev is None else (error - self.prev) / dt  # step joint sp
        self.prev = error  # step joint sp
        return self.g.p * error + self.g.i * self.integral + self.g.d * derivative  # step joint sp


class Joint:
    def __init__(self, name):
        self.name = name
        self.pid = PID(Gains(p=2.0, i=0.1))
        self.setpoint = 0.0
        self.pub = rospy.Publisher("/%s/effort" % name, Float64, queue_size=1)
        self.state_pub = rospy.Publisher(name + "/state", JointControllerState, queue_size=1)
        rospy.Subscriber("/{}/setpoint".format(name), Float64, self.on_setpoint)  # source sp
        rospy.Subscriber("/joint_states", JointState, self.on_joints)  # source joint
        self.stamp = None

    def on_setpoint(self, msg):
        self.setpoint = msg.data  # step sp
        self.pid.reset()

    def on_joints(self, msg):
        i = msg.name.index(self.name)  # step joint
        now = rospy.get_time()
        if self.stamp is not None:
            effort = self.pid(self.setpoint - msg.position[i], now - self.stamp)  # step joint sp
            self.pub.publish(effort)  # sink joint sp
            state = JointControllerState(set_point=self.setpoint, process_value=msg.position[i])  # step joint sp
            state.header = Header(stamp=rospy.Time.now())
            self.state_pub.publish(state)  # sink joint sp
        self.stamp = now
        self.pub.publish(self.pid.g.windup)  # clean


rospy.init_node("pids")
joints = [Joint(n) for n in rospy.get_param("~joints", ["a", "b"])]
rospy.spin()
