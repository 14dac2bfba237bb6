import rospy
from std_msgs.msg import Float64


class Median:
    def __init__(self):
        self.buffer = [0.0] * 5
        self.fixed = [1.0, 2.0, 3.0]
        self.ring = [0.0] * 8
        self.index = 0
        self.previous, self.current = 0.0, 0.0
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.on_in)  # source value
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_in(self, msg):
        self.buffer = self.buffer[1:] + [msg.data]
        self.fixed = self.fixed[1:] + self.fixed[:1]
        self.ring[self.index] = msg.data
        self.index = (self.index + 1) % len(self.ring)
        self.previous, self.current = self.current, msg.data

    def tick(self, event):
        self.pub.publish(sorted(self.buffer)[2])  # sink value
        self.pub.publish(self.fixed[0])  # clean
        self.pub.publish(sum(self.ring) / len(self.ring))  # sink value
        self.pub.publish(float(self.index))  # clean
        self.pub.publish(self.current - self.previous)  # sink value
        self.pub.publish(self.previous)  # sink value


rospy.init_node("median")
Median()
rospy.spin()
