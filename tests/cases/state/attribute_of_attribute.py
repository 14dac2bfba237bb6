import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64


class Pose2D:
    def __init__(self):
        self.x = 0.0
        self.y = 0.0


class State:
    def __init__(self):
        self.pose = Pose2D()
        self.home = Pose2D()


class Robot:
    def __init__(self):
        self.state = State()
        self.previous = State()
        self.pub = rospy.Publisher("x", Float64, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.on_odom)  # source odom

    def on_odom(self, msg):
        self.state.pose.x = msg.pose.pose.position.x
        self.previous.home.y = 2.0

    def run(self):
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            self.pub.publish(self.state.pose.x)  # sink odom
            self.pub.publish(self.state.pose.y)  # clean
            self.pub.publish(self.state.home.x)  # clean
            self.pub.publish(self.previous.pose.x)  # clean
            pose = self.state.pose
            self.pub.publish(pose.x - self.previous.home.y)  # sink odom
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("robot")
    Robot().run()
