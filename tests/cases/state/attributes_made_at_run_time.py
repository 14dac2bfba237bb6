import rospy
from std_msgs.msg import Float64


class Borg:
    _shared = {}

    def __init__(self):
        self.__dict__ = self._shared


class Config(Borg):
    def __init__(self, **values):
        super().__init__()
        self.__dict__.update(values)


class Box:
    def __getattr__(self, name):
        return self.__dict__["_" + name]

    def __init__(self):
        self._x = 0.0
        self._y = 0.0


box = Box()


def on(msg):
    box._x = msg.data
    Config().speed = msg.data
    pub.publish(box.x)  # sink a
    pub.publish(box._y)  # clean


def tick(_):
    pub.publish(Config().speed)  # sink a


rospy.init_node("b")
pub = rospy.Publisher("p", Float64, queue_size=1)
rospy.Subscriber("a", Float64, on)  # source a
rospy.Timer(rospy.Duration(1), tick)
rospy.spin()
