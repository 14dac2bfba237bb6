import rospy
from std_msgs.msg import Float32, Bool
from geometry_msgs.msg import Twist


class Deadman:
    def __init__(self):
        self.timer = None
        self.latched = 0.0
        self.pub = rospy.Publisher("cmd", Twist, queue_size=1)
        self.st = rospy.Publisher("st", Bool, queue_size=1)
        self.sub = rospy.Subscriber("joy", Float32, self.on_joy)  # source joy
        self.sub2 = rospy.Subscriber("arm", Bool, callback=self.on_arm, queue_size=1)  # source arm
        self.armed = False

    def on_arm(self, msg):
        self.armed |= msg.data

    def on_joy(self, msg):
        self.latched = msg.data
        if self.timer is not None:
            self.timer.shutdown()
        self.timer = rospy.Timer(rospy.Duration(0.5), self.expire, oneshot=True)
        speed = msg.data
        rospy.Timer(rospy.Duration(1.0), lambda e: self.send(speed), oneshot=True)

    def send(self, v):
        t = Twist()
        t.linear.x = v if self.armed else 0.0
        self.pub.publish(t)  # sink joy ~arm

    def expire(self, event):
        self.st.publish(Bool(False))  # clean
        self.send(0.0)


rospy.init_node("d")
Deadman()
rospy.spin()
