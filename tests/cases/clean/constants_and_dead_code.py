import rospy
from std_msgs.msg import Bool, Float64

DEBUG = False
MODE = "fixed"
level = 0.0


def on_level(msg):
    global level
    level = msg.data
    flag.publish(True)  # clean
    flag.publish(Bool(data=True))  # clean
    if DEBUG:
        pub.publish(msg)  # clean
    if not DEBUG:
        pub.publish(msg)  # sink level
    if MODE == "live":
        pub.publish(level)  # clean
    elif MODE == "fixed":
        pub.publish(1.0)  # clean
    if False:
        pub.publish(msg.data)  # clean
    while DEBUG:
        pub.publish(msg.data)  # clean
    pub.publish(msg.data if DEBUG else 2.0)  # clean
    return
    pub.publish(msg.data)  # clean


def never_called():
    pub.publish(level)  # clean


class NeverMade:
    def __init__(self):
        pub.publish(level)  # clean


def tick(event):
    pub.publish(level)  # sink level
    pub.publish(3.0)  # clean
    raise rospy.ROSInterruptException
    pub.publish(level)  # clean


rospy.init_node("dead")
pub = rospy.Publisher("out", Float64, queue_size=1)
flag = rospy.Publisher("flag", Bool, queue_size=1)
rospy.Subscriber("level", Float64, on_level)  # source level
rospy.Timer(rospy.Duration(1), tick)
rospy.spin()
