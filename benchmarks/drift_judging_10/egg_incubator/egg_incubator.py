#!/usr/bin/env python
"""Keep eggs warm and turn them: a setter for most of the time, then a hatcher that is cooler and damper."""

import rospy
import thermistor
from sensor_msgs.msg import RelativeHumidity
from std_msgs.msg import Bool, Float32, UInt16

PHASES = [  # minutes from the start, °C, share of humidity, minutes between turns
    (0.0, 37.7, 0.55, 20.0),
    (60.0, 37.2, 0.60, 30.0),
    (100.0, 36.8, 0.72, None),
]


class Pid(object):
    def __init__(self, kp, ki, low, high):
        self.kp, self.ki = kp, ki
        self.low, self.high = low, high
        self.total = 0.0

    def update(self, error, dt):
        out = self.kp * error + self.ki * (self.total + error * dt)
        if self.low < out < self.high:
            self.total += error * dt
        return max(self.low, min(self.high, out))


class Incubator(object):
    def __init__(self):
        self.pid = Pid(rospy.get_param("~kp", 0.45), rospy.get_param("~ki", 0.0012), 0.0, 1.0)
        self.too_hot = rospy.get_param("~too_hot", 40.5)
        self.period = rospy.get_param("~period", 10.0)
        self.measured = None
        self.humidity = 0.55
        self.turned = None
        self.side = False
        self.start = rospy.Time.now()
        self.heater = rospy.Publisher("heater/duty", Float32, queue_size=1)
        self.mist = rospy.Publisher("mist/on", Bool, queue_size=1)
        self.tray = rospy.Publisher("tray/side", Bool, queue_size=1)
        self.shown = rospy.Publisher("panel/celsius", Float32, queue_size=1)
        rospy.Subscriber("thermistor/counts", UInt16, self.on_counts)
        rospy.Subscriber("air/humidity", RelativeHumidity, self.on_humidity)
        rospy.Timer(rospy.Duration(self.period), self.control)

    def on_counts(self, msg):
        value = thermistor.celsius(msg.data)
        if value is None:
            self.measured = None
        elif self.measured is None:
            self.measured = value
        else:
            self.measured += 0.4 * (value - self.measured)

    def on_humidity(self, msg):
        self.humidity = msg.relative_humidity

    def minutes(self):
        return (rospy.Time.now() - self.start).to_sec() / 60.0

    def phase(self):
        """Return the temperature, humidity and time between turns of this phase."""
        now = self.minutes()
        current = PHASES[0]
        for phase in PHASES:
            if now >= phase[0]:
                current = phase
        return current[1:]

    def turn(self, every):
        if every is None:
            return
        if self.turned is None or self.minutes() - self.turned >= every:
            self.turned = self.minutes()
            self.side = not self.side
            self.tray.publish(self.side)

    def control(self, _event):
        celsius, humidity, every = self.phase()
        duty = 0.0
        if self.measured is not None and self.measured < self.too_hot:
            duty = self.pid.update(celsius - self.measured, self.period)
        self.heater.publish(duty)
        self.mist.publish(self.humidity < humidity - 0.02)
        self.turn(every)
        if self.measured is not None:
            self.shown.publish(self.measured)


if __name__ == "__main__":
    rospy.init_node("egg_incubator")
    Incubator()
    rospy.spin()
