import rospy
from std_msgs.msg import Float64


class Sensor:
    def __init__(self, scale):
        self.scale = scale
        self.value = 0.0

    def update(self, msg):
        self.value = self.scale * msg.data

    @staticmethod
    def relay(msg):
        out.publish(msg.data)  # sink static

    @classmethod
    def remember(cls, msg):
        cls.latest = msg.data

    latest = 0.0


class Robot:
    def __init__(self):
        self.front = Sensor(1.0)
        self.rear = Sensor(0.5)
        self.spare = Sensor(0.5)
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("front", Float64, self.front.update)  # source front
        rospy.Subscriber("rear", Float64, self.rear.update)  # source rear
        rospy.Subscriber("static", Float64, Sensor.relay)  # source static
        rospy.Subscriber("class", Float64, Sensor.remember)  # source class_
        rospy.Timer(rospy.Duration(0.1), self.step)

    def step(self, _event):
        self.pub.publish(self.front.value)  # sink front
        self.pub.publish(self.rear.value)  # sink rear
        self.pub.publish(self.spare.value)  # clean
        self.pub.publish(self.front.scale)  # clean
        self.pub.publish(Sensor.latest)  # sink class_
        self.pub.publish(self.spare.latest)  # sink class_


rospy.init_node("robot")
out = rospy.Publisher("relayed", Float64, queue_size=1)
Robot()
rospy.spin()
