import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Float64

mode = "idle"
level = 0.0


def on_level(msg):
    global mode, level
    level = msg.data
    if msg.data > 0.5:
        mode = "busy"


def decided(event):
    if mode == "busy":
        pub.publish(1.0)  # sink ~level
    else:
        pub.publish(0.0)  # sink ~level
    pub.publish(2.0)  # clean


def chosen(event):
    value = 0.0
    if level > 1.0:
        value = 1.0
    pub.publish(value)  # sink ~level
    pub.publish(3.0 if level < 0.0 else 4.0)  # sink ~level


def early(event):
    if level > 2.0:
        return
    pub.publish(5.0)  # sink ~level


def loops(event):
    while level > 3.0:
        rospy.sleep(0.1)
    pub.publish(6.0)  # clean
    for _ in range(3):
        if level > 4.0:
            break
        pub.publish(7.0)  # sink ~level
    pub.publish(8.0)  # clean


def checked(event):
    try:
        if level > 5.0:
            raise ValueError(level)
        pub.publish(9.0)  # sink ~level
    except ValueError:
        pub.publish(10.0)  # sink ~level
    pub.publish(11.0)  # clean


def stop():
    pub.publish(0.0)  # sink ~level


def called(event):
    if level > 6.0:
        stop()


def same(event):
    cmd = Twist()
    if level > 7.0:
        cmd.linear.x = 1.0
        cmd.linear.x = 2.0
    cmd.linear.x = 3.0
    twist.publish(cmd)  # clean


def dead(event):
    if False:
        pub.publish(level)  # clean
    while True:
        pub.publish(12.0)  # clean
        rospy.sleep(1.0)


def unreachable():
    pub.publish(level)  # clean


def flag(event):
    pub.publish(level > 1.0)  # sink level


class Fake:
    def publish(self, value):
        self.value = value


fake = Fake()


def not_ros(event):
    fake.publish(level)


pub = rospy.Publisher("out", Float64, queue_size=1)
twist = rospy.Publisher("twist", Twist, queue_size=1)
rospy.Subscriber("level", Float64, on_level)  # source level
for tick in (decided, chosen, early, loops, checked, called, same, dead, flag, not_ros):
    rospy.Timer(rospy.Duration(1.0), tick)
rospy.spin()
