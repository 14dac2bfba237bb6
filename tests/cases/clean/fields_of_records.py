"""The mapping that `asdict` makes keeps fields apart."""

from collections import namedtuple
from dataclasses import asdict, dataclass, replace

import rospy
from std_msgs.msg import Float64, String

Reading = namedtuple("Reading", "value label")


@dataclass
class Gains:
    gain: float = 1.0
    bias: float = 0.0


class Tuner:
    def __init__(self):
        self.gains = Gains()
        self.reading = Reading(0.0, "none")
        self.pub = rospy.Publisher("gain", Float64, queue_size=1)
        self.label = rospy.Publisher("label", String, queue_size=1)
        rospy.Subscriber("gain_in", Float64, self.tune)  # source gain
        rospy.Timer(rospy.Duration(1.0), self.tell)

    def tune(self, msg):
        self.gains = replace(self.gains, gain=msg.data)
        self.reading = Reading(msg.data, "fixed")

    def tell(self, _):
        fields = asdict(self.gains)
        self.pub.publish(fields["gain"])  # sink gain
        self.pub.publish(fields["bias"])  # clean
        self.pub.publish(self.reading._asdict()["value"])  # sink gain
        self.label.publish(self.reading._asdict()["label"])  # clean


rospy.init_node("tuner")
tuner = Tuner()
rospy.spin()
