"""If data chooses an object, the results of its methods and properties depend on the choice."""

import rospy
from std_msgs.msg import Float32, Int32


class Gear:
    def __init__(self, ratio):
        self.ratio = ratio
        self.load = 0.0

    def speed(self):
        return 3.0 / self.ratio

    @property
    def torque(self):
        return self.ratio * 2.0

    def message(self):
        made = Float32()
        made.data = self.ratio
        return made

    def unit(self):
        return 1.0


class Reverse(Gear):
    def speed(self):
        return -1.0


gears = [Gear(float(n)) for n in range(1, 5)]
mixed = [Gear(1.0), Reverse(2.0)]
pub = rospy.Publisher("speed", Float32, queue_size=1)


def on_gear(msg):
    gear = gears[msg.data]
    pub.publish(gears[msg.data].speed())  # sink gear
    pub.publish(gear.speed())  # sink gear
    pub.publish(gear.torque)  # sink gear
    pub.publish(gear.message())  # sink gear
    pub.publish(mixed[msg.data].speed())  # sink gear
    pub.publish(gear.unit())  # clean
    pub.publish(gears[0].speed())  # clean


def on_load(msg):
    nearest = min(gears, key=lambda gear: abs(gear.ratio - msg.data))
    pub.publish(nearest.torque)  # sink ~load


rospy.init_node("gears")
rospy.Subscriber("gear", Int32, on_gear)  # source gear
rospy.Subscriber("load", Float32, on_load)  # source load
rospy.spin()
