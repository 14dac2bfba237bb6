import rospy
from geometry_msgs.msg import PointStamped
from sensor_msgs.msg import Range
from std_msgs.msg import Float64


class Stamps:
    def __init__(self):
        self.seq = 0
        self.arrived = rospy.Time(0)
        self.pub = rospy.Publisher("point", PointStamped, queue_size=1)
        self.age = rospy.Publisher("age", Float64, queue_size=1)
        rospy.Subscriber("range", Range, self.on_range)  # source range
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_range(self, msg):
        self.arrived = rospy.Time.now()
        self.seq += 1
        out = PointStamped()
        out.header.stamp = msg.header.stamp
        self.pub.publish(out)  # sink range
        out = PointStamped()
        out.header.stamp = rospy.Time.now()
        out.header.seq = self.seq
        self.pub.publish(out)  # clean
        delay = rospy.Time.now() - msg.header.stamp
        self.age.publish(delay.to_sec())  # sink range

    def tick(self, event):
        age = (rospy.Time.now() - self.arrived).to_sec()
        self.age.publish(age)  # clean
        if age > 1.0:
            self.age.publish(-1.0)  # clean


rospy.init_node("stamps")
Stamps()
rospy.spin()
