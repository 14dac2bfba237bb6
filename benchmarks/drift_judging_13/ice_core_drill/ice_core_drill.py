#!/usr/bin/env python
"""Mission program of a drill for ice cores: drill, clear the chips now and then, and bring the core up."""

import enum

import rospy
from sensor_msgs.msg import Temperature
from std_msgs.msg import Bool, Float32, String

CORE = 1.8  # length of core to drill per run (m)
TRIP_SPEED = 0.5  # speed in the open hole (m/s)
APPROACH = 1.0  # height above the bottom from which the drill moves slowly (m)
FEED = 0.018  # m/s
CLEAR_EVERY = 0.60  # m of core
CLEAR_STROKE = 0.9  # stroke up and down during which chips fall behind the barrel (m)
CLEAR_SPEED = 0.15  # m/s
MOTOR_RPM = 90.0
BREAK_PULL = 4.0  # duration of the pull with the core dogs at the bottom (s)
OVERLOAD = 14.0  # A
STABLE = 0.02  # m


class Phase(enum.Enum):
    LOWER = 0
    DRILL = 1
    LIFT = 2
    RETURN = 3
    BREAK = 4
    RAISE = 5
    UP = 6


class Mission:
    def __init__(self):
        self.phase = Phase.LOWER
        self.depth = 0.0  # of the bit
        self.bottom = None  # of the hole
        self.start = None
        self.cleared_at = 0.0
        self.amps = 0.0
        self.coldest = 0.0
        self.entered = rospy.get_time()
        self.winch = rospy.Publisher("winch/speed", Float32, queue_size=1)
        self.motor = rospy.Publisher("drill/rpm", Float32, queue_size=1)
        self.done = rospy.Publisher("mission/done", Bool, queue_size=1, latch=True)
        self.status = rospy.Publisher("mission/phase", String, queue_size=1)
        rospy.Subscriber("winch/depth", Float32, self._depth)
        rospy.Subscriber("hole/bottom", Float32, self._bottom)
        rospy.Subscriber("drill/current", Float32, self._current)
        rospy.Subscriber("hole/temperature", Temperature, self._temperature)

    def _depth(self, msg):
        self.depth = msg.data

    def _bottom(self, msg):
        self.bottom = msg.data
        if self.start is None:
            self.start = msg.data
            self.cleared_at = msg.data

    def _current(self, msg):
        self.amps = msg.data

    def _temperature(self, msg):
        self.coldest = min(self.coldest, msg.temperature)  # for the log book

    def enter(self, phase):
        rospy.loginfo("%s at %.2f m, coldest ice %.1f C", phase.name, self.depth, self.coldest)
        self.phase = phase
        self.entered = rospy.get_time()
        self.status.publish(phase.name)

    def lower(self):
        left = self.bottom - self.depth
        if left < STABLE:
            self.enter(Phase.DRILL)
            return 0.0, 0.0
        return (TRIP_SPEED if left > APPROACH else 0.3 * TRIP_SPEED), 0.0

    def drill(self):
        if self.bottom - self.start >= CORE:
            self.enter(Phase.BREAK)
            return 0.0, 0.0
        if self.depth - self.cleared_at >= CLEAR_EVERY:
            self.enter(Phase.LIFT)
            return 0.0, MOTOR_RPM
        feed = FEED if self.amps < OVERLOAD else 0.3 * FEED
        return feed, MOTOR_RPM

    def lift(self):
        if self.bottom - self.depth >= CLEAR_STROKE:
            self.enter(Phase.RETURN)
        return -CLEAR_SPEED, 0.5 * MOTOR_RPM

    def back(self):
        if self.bottom - self.depth < STABLE:
            self.cleared_at = self.bottom
            self.enter(Phase.DRILL)
            return 0.0, MOTOR_RPM
        return min(CLEAR_SPEED, 0.7 * (self.bottom - self.depth) + 0.01), 0.5 * MOTOR_RPM

    def break_core(self):
        if rospy.get_time() - self.entered > BREAK_PULL:
            self.enter(Phase.RAISE)
        return -0.005, 0.0

    def hoist(self):
        if self.depth < 0.3:
            self.enter(Phase.UP)
            self.done.publish(True)
        return (-TRIP_SPEED if self.depth > APPROACH else -0.4 * TRIP_SPEED), 0.0

    def step(self):
        if self.bottom is None:
            return
        acts = {
            Phase.LOWER: self.lower,
            Phase.DRILL: self.drill,
            Phase.LIFT: self.lift,
            Phase.RETURN: self.back,
            Phase.BREAK: self.break_core,
            Phase.RAISE: self.hoist,
            Phase.UP: lambda: (0.0, 0.0),
        }
        speed, rpm = acts[self.phase]()
        self.winch.publish(speed)
        self.motor.publish(rpm)


def main():
    rospy.init_node("ice_core_drill")
    mission = Mission()
    rate = rospy.Rate(2)
    while not rospy.is_shutdown():
        mission.step()
        rate.sleep()


if __name__ == "__main__":
    main()
