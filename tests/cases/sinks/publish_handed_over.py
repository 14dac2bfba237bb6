import rospy
from functools import partial
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64, String


class Controller:
    def __init__(self, emit, report=None):
        self.emit = emit
        self.report = report or (lambda text: None)
        self.gain = 1.5

    def handle(self, msg):
        cmd = Twist()
        cmd.linear.x = self.gain * msg.data
        self.emit(cmd)  # sink x
        self.report("ok")  # clean


class Table:
    def __init__(self):
        self.senders = {}

    def register(self, name, send):
        self.senders[name] = send

    def send(self, name, value):
        self.senders[name](value)  # sink x


def relay(send, value):
    send(value)  # sink x


rospy.init_node("c")
pub = rospy.Publisher("cmd", Twist, queue_size=1)
txt = rospy.Publisher("txt", String, queue_size=1)
val = rospy.Publisher("val", Float64, queue_size=1)
val2 = rospy.Publisher("val2", Float64, queue_size=1)
val3 = rospy.Publisher("val3", Float64, queue_size=1)
c = Controller(pub.publish, txt.publish)
t = Table()
t.register("v", val.publish)


def both(msg):
    c.handle(msg)
    t.send("v", msg.data)
    relay(val2.publish, msg.data)
    list(map(val3.publish, [msg.data, 2 * msg.data]))  # sink x


rospy.Subscriber("x", Float64, both)  # source x
rospy.Subscriber("direct", Float64, val3.publish)  # source d # sink d
rospy.spin()
