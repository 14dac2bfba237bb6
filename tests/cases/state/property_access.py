import functools

import rospy
from std_msgs.msg import Float64


class Battery:
    def __init__(self):
        self._voltage = 12.0
        self._nominal = 12.0

    @property
    def voltage(self):
        return self._voltage

    @voltage.setter
    def voltage(self, value):
        self._voltage = 0.9 * self._voltage + 0.1 * value

    @property
    def charge(self):
        return self.voltage / self.nominal

    @property
    def nominal(self):
        return self._nominal

    @functools.cached_property
    def cells(self):
        return 6.0


class Monitor:
    def __init__(self):
        self.battery = Battery()
        self.spare = Battery()
        self.pub = rospy.Publisher("charge", Float64, queue_size=1)
        rospy.Subscriber("voltage", Float64, self.on_voltage)  # source voltage
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_voltage(self, msg):
        self.battery.voltage = msg.data

    def tick(self, event):
        self.pub.publish(self.battery.voltage)  # sink voltage
        self.pub.publish(self.battery.charge)  # sink voltage
        self.pub.publish(self.battery.nominal)  # clean
        self.pub.publish(self.battery.cells)  # clean
        self.pub.publish(self.spare.charge)  # clean


rospy.init_node("battery")
Monitor()
rospy.spin()
