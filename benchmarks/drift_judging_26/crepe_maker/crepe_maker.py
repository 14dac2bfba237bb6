#!/usr/bin/env python
"""Makes crepes at a market stall: pours and spreads the batter, waits, flips, waits again and serves."""

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

COLD = 140.0  # deg C, the batter would not set
HOT = 250.0  # deg C, the batter would burn at once
LEAST_BATTER = 0.08  # l, one crepe
SECOND_SIDE = 0.6  # of the time of the first side


class Plate(object):
    """What is known about the hot plate."""

    def __init__(self):
        self.temperature = None
        self.lowest = 999.0

    def update(self, value):
        self.temperature = value if self.temperature is None else 0.7 * self.temperature + 0.3 * value
        self.lowest = min(self.lowest, self.temperature)

    @property
    def usable(self):
        return self.temperature is not None and COLD < self.temperature < HOT


class CrepeMaker(object):
    def __init__(self):
        self.fry_time = rospy.get_param("~fry_time", 44.0)  # s, of the first side
        self.orders = 0
        self.served = 0
        self.batter = 0.0
        self.busy = False
        self.plate = Plate()
        self.stage = "wait"
        self.entered = rospy.get_time()
        self.steps = {
            "wait": self.wait,
            "pour": self.pour,
            "spread": self.spread,
            "first": self.first,
            "flip": self.flip,
            "second": self.second,
            "serve": self.serve,
        }
        self.arm_pub = rospy.Publisher("arm/action", String, queue_size=1)
        self.served_pub = rospy.Publisher("stall/served", Int32, queue_size=1)
        self.status_pub = rospy.Publisher("stall/status", String, queue_size=1)
        rospy.Subscriber("plate/temperature", Float32, lambda msg: self.plate.update(msg.data))
        rospy.Subscriber("batter/level", Float32, self.on_batter)
        rospy.Subscriber("arm/busy", Bool, self.on_busy)
        rospy.Subscriber("till/orders", Int32, self.on_orders)
        rospy.Timer(rospy.Duration(1.0), self.tick)
        rospy.Timer(rospy.Duration(15.0), self.report)

    def on_batter(self, msg):
        self.batter = msg.data

    def on_busy(self, msg):
        self.busy = msg.data

    def on_orders(self, msg):
        self.orders = max(self.orders, msg.data)

    def go(self, stage, action=None):
        self.stage = stage
        self.entered = rospy.get_time()
        if action is not None:
            self.arm_pub.publish(action)
            self.busy = True

    def spent(self):
        return rospy.get_time() - self.entered

    def wait(self):
        if self.served >= self.orders:
            return
        if not self.plate.usable:
            rospy.logwarn_throttle(30.0, "plate at %s deg C", self.plate.temperature)
        elif self.batter < LEAST_BATTER:
            rospy.logerr_throttle(30.0, "no batter")
        else:
            self.go("pour", "pour")

    def pour(self):
        if not self.busy:
            self.go("spread", "spread")

    def spread(self):
        if not self.busy:
            self.go("first")

    def first(self):
        if self.spent() >= self.fry_time:
            self.go("flip", "flip")

    def flip(self):
        if not self.busy:
            self.go("second")

    def second(self):
        if self.spent() >= SECOND_SIDE * self.fry_time:
            self.go("serve", "serve")

    def serve(self):
        if not self.busy:
            self.served += 1
            self.served_pub.publish(self.served)
            self.go("wait")

    def tick(self, event):
        self.steps[self.stage]()

    def report(self, event):
        if self.plate.temperature is not None:
            text = "%s, plate %.0f, lowest %.0f deg C" % (
                self.stage,
                self.plate.temperature,
                self.plate.lowest,
            )
            self.status_pub.publish(text)


if __name__ == "__main__":
    rospy.init_node("crepe_maker")
    CrepeMaker()
    rospy.spin()
