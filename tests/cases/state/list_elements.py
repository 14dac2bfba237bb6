import rospy
from std_msgs.msg import Float64


class Wheels:
    def __init__(self):
        self.speeds = [0.0, 0.0, 0.0]
        self.offsets = [0.1, 0.2]
        self.rows = [[0.0, 0.0], [0.0, 0.0]]
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("left", Float64, self.on_left)  # source left
        rospy.Subscriber("right", Float64, self.on_right)  # source right
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_left(self, msg):
        self.speeds[0] = msg.data
        self.rows[0][1] = msg.data

    def on_right(self, msg):
        self.speeds[1] = msg.data

    def tick(self, _):
        left, right, rear = self.speeds
        self.pub.publish(left)  # sink left
        self.pub.publish(right)  # sink right
        self.pub.publish(rear)  # clean
        self.pub.publish(sum(self.speeds) / 2)  # sink left right
        self.pub.publish(self.offsets[1])  # clean
        for speed in self.speeds:
            self.pub.publish(speed)  # sink left right
        self.pub.publish(self.rows[0][1])  # sink left
        self.pub.publish(self.rows[1][0])  # clean


rospy.init_node("wheels")
wheels = Wheels()
rospy.spin()
