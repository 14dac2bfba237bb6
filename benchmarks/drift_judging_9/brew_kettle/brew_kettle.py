#!/usr/bin/env python
"""Mash: heat a kettle through its rests, and hold each of them.

rest   degC   s
maltose  63  100
sugar    72  100
"""

import rospy
from pid import PID
from std_msgs.msg import Bool, Float32, String

RESTS = [("maltose", 63.0, 100.0), ("sugar", 72.0, 100.0)]
CLOSE = 0.9  # distance from the temperature of a rest at which the time of the rest starts (K)
LOSS = 0.0062  # duty per kelvin above room temperature, with the lid on
ROOM = 20.0  # degC
STIR_FAST, STIR_SLOW = 0.9, 0.4
DRY = 5.0  # volume of water below which the element burns (litres)
DUTY_MAX = 0.95


class BrewKettle(object):
    def __init__(self):
        self.pid = PID(kp=0.12, ki=0.0, kd=0.25, low=0.0, high=DUTY_MAX)
        self.rest = 0
        self.left = RESTS[0][2]
        self.temperature = None
        self.litres = 0.0
        self.heater = rospy.Publisher("kettle/duty", Float32, queue_size=1)
        self.stirrer = rospy.Publisher("kettle/stir", Float32, queue_size=1)
        self.done = rospy.Publisher("mash/done", Bool, queue_size=1, latch=True)
        self.info = rospy.Publisher("mash/rest", String, queue_size=1)
        rospy.Subscriber("kettle/temperature", Float32, self.temperature_cb)
        rospy.Subscriber("kettle/level", Float32, self.level_cb)

    def temperature_cb(self, msg):
        self.temperature = msg.data

    def level_cb(self, msg):
        self.litres = msg.data

    def next_rest(self):
        self.rest += 1
        if self.rest < len(RESTS):
            self.left = RESTS[self.rest][2]
            self.pid.reset()
            rospy.loginfo("next: %s", RESTS[self.rest][0])

    def step(self, dt):
        if self.temperature is None:
            return
        finished = self.rest >= len(RESTS)
        self.done.publish(finished)
        if finished or self.litres < DRY:
            self.heater.publish(0.0)
            return
        name, target, _ = RESTS[self.rest]
        error = target - self.temperature
        duty = self.pid.update(error, self.temperature, LOSS * (target - ROOM), dt)
        self.left -= dt if self.left < RESTS[self.rest][2] or abs(error) < CLOSE else 0.0
        if self.left <= 0.0:
            self.next_rest()
        self.heater.publish(duty)
        self.stirrer.publish(STIR_FAST if abs(error) > CLOSE else STIR_SLOW)
        self.info.publish(name)


def main():
    rospy.init_node("brew_kettle")
    kettle = BrewKettle()
    rate = rospy.Rate(1)
    while not rospy.is_shutdown():
        kettle.step(1.0)
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
