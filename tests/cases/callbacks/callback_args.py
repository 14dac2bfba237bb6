import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64


class Fleet:
    def __init__(self, names):
        self.x = {}
        self.weights = {"a": 0.5}
        self.pub = rospy.Publisher("mean", Float64, queue_size=1)
        for name in names:
            rospy.Subscriber("/%s/odom" % name, Odometry, self.on_odom, name)  # source odom
        rospy.Subscriber("gain", Float64, self.on_gain, callback_args=(self.pub, 3.0))  # source gain

    def on_odom(self, msg, name):
        self.x[name] = msg.pose.pose.position.x

    def on_gain(self, msg, args):
        pub, factor = args
        pub.publish(factor * msg.data)  # sink gain
        args[0].publish(args[1])  # clean

    def run(self):
        rate = rospy.Rate(1)
        while not rospy.is_shutdown():
            self.pub.publish(sum(self.x.values()) / len(self.x))  # sink odom
            self.pub.publish(self.weights["a"])  # clean
            rate.sleep()


rospy.init_node("fleet")
Fleet(["a", "b"]).run()
