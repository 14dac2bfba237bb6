#!/usr/bin/env python
"""Feeder on a barge of a fish farm: an auger doses pellets into a pipe, and a blower throws them into the cage."""

import rospy
from sensor_msgs.msg import RelativeHumidity
from std_msgs.msg import Float32, String

FEEDER = {
    "rate": 0.085,  # kg/s of pellets from the auger
    "spin_up": 2.0,  # s that the blower gets before the auger starts
    "purge": 3.0,  # s that the blower runs on
    "largest": 4.0,  # kg in one meal
}
meal = {"phase": "idle", "left": 0.0, "since": None}
air = {"humidity": None}
pubs = {}


def on_order(msg):
    if meal["phase"] != "idle":
        rospy.logwarn("still feeding, order of %.1f kg ignored", msg.data)
        return
    meal["left"] = min(msg.data, FEEDER["largest"])
    switch("spin_up")


def on_humidity(msg):
    air["humidity"] = msg.relative_humidity
    rospy.logdebug("silo at %.0f %%", 100.0 * msg.relative_humidity)


def switch(phase):
    rospy.loginfo("%s -> %s", meal["phase"], phase)
    meal["phase"] = phase
    meal["since"] = rospy.get_time()


def dose(seconds):
    meal["left"] -= FEEDER["rate"] * seconds
    return meal["left"] > 0.0


def tick(event):
    phase = meal["phase"]
    if phase in ("spin_up", "purge") and rospy.get_time() - meal["since"] >= FEEDER[phase]:
        switch("dose" if phase == "spin_up" else "idle")
    elif phase == "dose" and not dose(0.5):
        switch("purge")
    pubs["auger"].publish(1.0 if meal["phase"] == "dose" else 0.0)
    pubs["blower"].publish(0.0 if meal["phase"] == "idle" else 0.7)
    pubs["phase"].publish(meal["phase"])


def main():
    rospy.init_node("fish_feeder")
    pubs["auger"] = rospy.Publisher("auger", Float32, queue_size=1)
    pubs["blower"] = rospy.Publisher("blower", Float32, queue_size=1)
    pubs["phase"] = rospy.Publisher("feeder/phase", String, queue_size=1)
    rospy.Subscriber("cage/order", Float32, on_order)
    rospy.Subscriber("silo/humidity", RelativeHumidity, on_humidity)
    rospy.Timer(rospy.Duration(0.5), tick)
    rospy.spin()


if __name__ == "__main__":
    main()
