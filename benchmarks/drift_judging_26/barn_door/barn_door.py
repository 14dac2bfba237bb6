#!/usr/bin/env python
"""Opens the sliding door of a barn for cattle and machines, and stops when it meets something."""

import rospy
from std_msgs.msg import Bool, Float32, String


class Settings(object):
    width = 3.2  # m
    speed = 0.4  # m/s
    slow_zone = 0.5  # m before an end
    slow_speed = 0.12  # m/s
    limit = 3.4  # A, more is an obstacle
    limit_for = 0.3  # s
    ignore_start = 0.8  # s, in which the motor may draw more
    back_off = 0.3  # m
    tries = 4
    pause = 4.0  # s after an obstacle


class Motor(object):
    """Watches the current of the motor."""

    def __init__(self):
        self.current = 0.0
        self.peak = 0.0
        self.over_since = None

    def update(self, amps, now):
        self.current += 0.5 * (amps - self.current)
        self.peak = max(self.peak, self.current)
        if self.current <= Settings.limit:
            self.over_since = None
        elif self.over_since is None:
            self.over_since = now

    def obstacle(self, now):
        return self.over_since is not None and now - self.over_since >= Settings.limit_for


class BarnDoor(object):
    def __init__(self):
        self.motor = Motor()
        self.position = None
        self.goal = 0.0
        self.state = "rest"
        self.changed = rospy.get_time()
        self.retreat = 0.0
        self.obstacles = 0
        self.speed_pub = rospy.Publisher("door/speed", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("door/state", String, queue_size=1)
        self.lamp_pub = rospy.Publisher("door/lamp", Bool, queue_size=1)
        rospy.Subscriber("door/position", Float32, self.position_cb)
        rospy.Subscriber("door/current", Float32, self.current_cb)
        rospy.Subscriber("remote/open", Bool, self.remote_cb)
        rospy.Timer(rospy.Duration(0.1), self.loop)
        rospy.Timer(rospy.Duration(20.0), self.note)

    def position_cb(self, msg):
        self.position = msg.data

    def current_cb(self, msg):
        self.motor.update(abs(msg.data), rospy.get_time())

    def remote_cb(self, msg):
        goal = Settings.width if msg.data else 0.0
        if goal != self.goal:
            self.goal = goal
            self.obstacles = 0
            self.enter("move")

    def enter(self, state):
        self.state = state
        self.changed = rospy.get_time()
        self.motor.over_since = None

    def towards(self, goal):
        rest = goal - self.position
        if abs(rest) < 0.02:
            return 0.0
        speed = Settings.speed
        if abs(rest) < Settings.slow_zone:
            share = abs(rest) / Settings.slow_zone
            speed = Settings.slow_speed + share * (Settings.speed - Settings.slow_speed)
        return speed if rest > 0.0 else -speed

    def loop(self, event):
        if self.position is None:
            return
        now = rospy.get_time()
        spent = now - self.changed
        speed = 0.0
        if self.state == "move":
            speed = self.towards(self.goal)
            if speed == 0.0:
                self.enter("rest")
            elif spent > Settings.ignore_start and self.motor.obstacle(now):
                self.obstacles += 1
                rospy.logwarn("obstacle at %.2f m, %.1f A", self.position, self.motor.current)
                self.retreat = self.position - (Settings.back_off if speed > 0.0 else -Settings.back_off)
                self.retreat = min(Settings.width, max(0.0, self.retreat))
                self.enter("back")
                speed = 0.0
        elif self.state == "back":
            speed = self.towards(self.retreat)
            if speed == 0.0 or spent > 3.0:
                self.enter("pause" if self.obstacles < Settings.tries else "stuck")
                speed = 0.0
        elif self.state == "pause" and spent > Settings.pause:
            self.enter("move")
        self.speed_pub.publish(speed)
        self.state_pub.publish(self.state)
        self.lamp_pub.publish(self.state not in ("rest", "stuck"))

    def note(self, event):
        rospy.loginfo("%d obstacles, peak %.1f A", self.obstacles, self.motor.peak)
        self.motor.peak = 0.0


if __name__ == "__main__":
    rospy.init_node("barn_door")
    BarnDoor()
    rospy.spin()
