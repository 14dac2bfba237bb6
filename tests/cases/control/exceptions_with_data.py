import contextlib
import rospy
from std_msgs.msg import Float64, String
from sensor_msgs.msg import Range


class TooClose(Exception):
    def __init__(self, distance):
        super().__init__("too close")
        self.distance = distance


class Stale(Exception):
    pass


def check(distance):
    if distance < 0.3:
        raise TooClose(distance)
    return distance


@contextlib.contextmanager
def recorded(values):
    entry = {"start": rospy.get_time()}
    yield entry
    values.append(entry)


class Guard:
    def __init__(self):
        self.pub = rospy.Publisher("speed", Float64, queue_size=1)
        self.why = rospy.Publisher("why", String, queue_size=1)
        self.other = rospy.Publisher("other", Float64, queue_size=1)
        self.log = []
        rospy.Subscriber("range", Range, self.cb)  # source range

    def cb(self, msg):
        with recorded(self.log) as entry:
            entry["distance"] = msg.range
            try:
                ok = check(msg.range)
                self.pub.publish(ok * 0.5)  # sink range
            except TooClose as e:
                self.pub.publish(-e.distance)  # sink range
                self.why.publish("%s" % e)  # sink range
            except Stale:
                self.other.publish(0.0)  # clean
        self.other.publish(self.log[-1]["start"])  # clean


try:
    rospy.init_node("guard")
    Guard()
    rospy.spin()
except rospy.ROSInterruptException:
    pass
