#!/usr/bin/env python
"""Watches the pack and the charging contacts of the robot. Says whether it charges."""

import rospy
from std_msgs.msg import Bool, Float32, String

CELLS = 7
CELL_EMPTY = 3.15  # V
CELL_FULL = 4.12
CHARGER_VOLTS = 26.5  # voltage at the contacts from which on the charger feeds them (V)
DEBOUNCE = 4


class BatteryWatch(object):
    def __init__(self):
        self.count = 0
        self.pack = None
        self.charging = rospy.Publisher("battery/charging", Bool, queue_size=1)
        self.level = rospy.Publisher("battery/percent", Float32, queue_size=1)
        self.state = rospy.Publisher("battery/state", String, queue_size=1)
        rospy.Subscriber("battery/volts", Float32, self.on_pack)
        rospy.Subscriber("contacts/volts", Float32, self.on_contacts)

    def on_pack(self, msg):
        if self.pack is None:
            self.pack = msg.data
        self.pack = 0.9 * self.pack + 0.1 * msg.data
        share = (self.pack / CELLS - CELL_EMPTY) / (CELL_FULL - CELL_EMPTY)
        self.level.publish(100.0 * min(1.0, max(0.0, share)))
        self.state.publish("low" if share < 0.2 else "ok")

    def on_contacts(self, msg):
        if msg.data > CHARGER_VOLTS:
            self.count = min(self.count + 1, 3 * DEBOUNCE)
        else:
            self.count = max(self.count - 2, 0)
        self.charging.publish(self.count >= DEBOUNCE)


if __name__ == "__main__":
    rospy.init_node("battery_watch")
    BatteryWatch()
    rospy.spin()
