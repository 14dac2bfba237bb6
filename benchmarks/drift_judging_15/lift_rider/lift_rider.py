#!/usr/bin/env python
"""Takes a delivery robot of a hospital to another floor by lift."""

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float32, Int32, String

TIMEOUTS = {"call": 22.0, "door": 8.0, "ride": 60.0}  # s
STOP_LINE = 1.2  # distance from the door of the lift (m)
INSIDE = -1.3  # position behind the door (m)
DOOR_GAP = 0.9  # m


class LiftRider(object):
    def __init__(self):
        self.target = rospy.get_param("~target_floor", 3)
        self.cruise = rospy.get_param("~cruise_speed", 0.6)
        self.enter = rospy.get_param("~enter_speed", 0.4)
        self.k_stop = rospy.get_param("~k_stop", 0.8)
        self.call_period = rospy.get_param("~call_period", 2.0)
        self.state, self.since = "APPROACH", rospy.Time.now()
        self.called = rospy.Time(0)
        self.door_distance = None
        self.door_gap = 0.0
        self.floor = 0
        self.charge = 1.0
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.call = rospy.Publisher("lift/call", Int32, queue_size=1)
        self.status = rospy.Publisher("rider/status", String, queue_size=1)
        rospy.Subscriber("lift/distance", Float32, self.on_distance)
        rospy.Subscriber("lift/door_gap", Float32, self.on_gap)
        rospy.Subscriber("lift/floor", Int32, self.on_floor)
        rospy.Subscriber("battery/charge", Float32, self.on_charge)
        rospy.Timer(rospy.Duration(0.25), self.tick)

    def on_distance(self, msg):
        self.door_distance = msg.data

    def on_gap(self, msg):
        self.door_gap = 0.5 * self.door_gap + 0.5 * msg.data

    def on_floor(self, msg):
        self.floor = msg.data

    def on_charge(self, msg):
        self.charge = msg.data
        if self.charge < 0.2:
            rospy.logwarn_throttle(30.0, "charge %.0f %%" % (100.0 * self.charge))

    def go(self, state):
        rospy.loginfo("%s -> %s", self.state, state)
        self.state, self.since = state, rospy.Time.now()

    def elapsed(self):
        return (rospy.Time.now() - self.since).to_sec()

    def move(self, speed):
        msg = Twist()
        msg.linear.x = speed
        self.cmd.publish(msg)

    def tick(self, _event):
        self.status.publish(self.state)
        if self.door_distance is None:
            return
        handler = getattr(self, "do_" + self.state.lower())
        handler()

    def do_approach(self):
        left = self.door_distance - STOP_LINE
        if left < 0.05:
            self.move(0.0)
            self.go("CALL")
            return
        self.move(max(0.05, min(self.cruise, self.k_stop * left)))

    def do_call(self):
        self.move(0.0)
        if self.door_gap > DOOR_GAP:
            self.go("ENTER")
        elif self.elapsed() > TIMEOUTS["call"]:
            self.go("GIVE_UP")
        elif (rospy.Time.now() - self.called).to_sec() > self.call_period:
            self.call.publish(self.target)
            self.called = rospy.Time.now()

    def do_enter(self):
        if self.door_distance < INSIDE:
            self.move(0.0)
            self.go("RIDE")
        elif self.door_gap < 0.7 and self.door_distance > 0.4:
            self.go("CALL")
        elif self.elapsed() > TIMEOUTS["door"]:
            self.move(-0.2)
        else:
            self.move(self.enter)

    def do_ride(self):
        self.move(0.0)
        if self.floor == self.target:
            self.go("DONE")
        elif self.elapsed() > TIMEOUTS["ride"]:
            self.go("GIVE_UP")

    def do_give_up(self):
        self.move(0.0)

    def do_done(self):
        self.move(0.0)


if __name__ == "__main__":
    rospy.init_node("lift_rider")
    LiftRider()
    rospy.spin()
