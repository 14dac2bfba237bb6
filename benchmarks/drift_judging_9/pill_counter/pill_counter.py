#!/usr/bin/env python
"""Count pills into vials: feed fast, then dribble, then close the gate behind the last one."""

import rospy
from std_msgs.msg import Bool, Float32, Int32

DEFAULTS = {
    "fast": 0.9,  # drive of the vibrating bowl, 0 to 1
    "slow": 0.1,
    "dribble_at": 7,  # the bowl slows down when this number of pills is missing
    "soft_start": 0.4,  # s
    "jam_after": 3.0,  # time without a pill (s)
    "jam_drive": 1.0,
    "jam_time": 0.5,  # s
    "vial_time": 1.0,  # time for a new vial (s)
    "rate": 20.0,
}


class PillCounter(object):
    def __init__(self, params):
        self.p = params
        self.order = 0
        self.count = 0
        self.started = 0.0
        self.last_pill = 0.0
        self.shaking_until = 0.0
        self.closed_until = 0.0
        self.bowl = rospy.Publisher("bowl/drive", Float32, queue_size=1)
        self.gate = rospy.Publisher("gate/open", Bool, queue_size=1)
        rospy.Subscriber("vial/order", Int32, self.on_order)
        rospy.Subscriber("eye/count", Int32, self.on_count)

    def on_order(self, msg):
        """Receive the number of pills ordered for the vial in place; 0 means that there is no vial."""
        if msg.data != self.order:
            now = rospy.get_time()
            self.order = msg.data
            self.started = self.last_pill = now

    def on_count(self, msg):
        if msg.data != self.count:
            self.last_pill = rospy.get_time()
        self.count = msg.data

    def drive(self, now):
        p = self.p
        missing = self.order - self.count
        if missing <= 0:
            return 0.0
        if now < self.shaking_until:
            return p["jam_drive"]
        if now - self.last_pill > p["jam_after"]:
            rospy.logwarn("no pill for %.1f s: shaking", p["jam_after"])
            self.shaking_until = now + p["jam_time"]
            self.last_pill = now
        if missing <= p["dribble_at"]:
            return p["slow"]
        return min(1.0, (now - self.started) / p["soft_start"]) * p["fast"]

    def step(self):
        now = rospy.get_time()
        filled = self.order > 0 and self.count >= self.order
        self.bowl.publish(self.drive(now))
        self.gate.publish(self.order > 0 and not filled)


def main():
    rospy.init_node("pill_counter")
    params = dict(DEFAULTS)
    params.update(rospy.get_param("~", {}) or {})
    counter = PillCounter(params)
    rate = rospy.Rate(params["rate"])
    while not rospy.is_shutdown():
        counter.step()
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
