"""Subscriptions whose arguments are unpacked from tuples."""

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu
from std_msgs.msg import Bool, Float32


class State:
    def __init__(self):
        self.x = 0.0
        self.turn = 0.0
        self.pub = rospy.Publisher("state", Float32, queue_size=1)
        wanted = [("odom", Odometry, self.on_odom), ("imu", Imu, self.on_imu)]
        self.subs = [rospy.Subscriber(*each) for each in wanted]  # source both
        rospy.Timer(rospy.Duration(0.1), self.tell)

    def on_odom(self, msg):
        self.x = msg.pose.pose.position.x

    def on_imu(self, msg):
        self.turn = msg.angular_velocity.z

    def tell(self, _):
        self.pub.publish(self.x)  # sink both
        self.pub.publish(self.turn)  # sink both
        self.pub.publish(1.0)  # clean


rospy.init_node("state")
state = State()
rospy.spin()
