import rospy
from geometry_msgs.msg import Twist, Pose2D
from std_msgs.msg import Float64


def wrap(angle):
    while angle > 3.14:  # step ~pose ~target
        angle -= 6.28  # step pose target
    return angle  # step pose target


def error(a, b):
    return wrap(a - b)  # step pose target


class Heading:
    def __init__(self):
        self.pose = Pose2D()
        self.target = 0.0
        self.ki = 0.1
        self.sum = 0.0
        self.unused = 0.0
        self.cmd = Twist()
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("pose", Pose2D, self.on_pose)  # source pose
        rospy.Subscriber("target", Float64, self.on_target)  # source target
        rospy.Timer(rospy.Duration(0.1), self.step)

    def on_pose(self, msg):
        self.pose = msg  # step pose
        self.unused = msg.x

    def on_target(self, msg):
        wanted = msg.data  # step target
        rospy.loginfo("target %f", wanted)
        self.target = wanted  # step target

    def step(self, _event):
        e = error(self.target, self.pose.theta)  # step pose target
        scale = 2.0
        self.sum += self.ki * e  # step pose target
        turn = scale * e + self.sum  # step pose target
        self.cmd.linear.x = 0.2
        self.cmd.angular.z = turn  # step pose target
        self.pub.publish(self.cmd)  # sink pose target
        self.pub.publish(Twist())  # clean
        rospy.logdebug("%f", self.unused)


rospy.init_node("heading")
Heading()
rospy.spin()
