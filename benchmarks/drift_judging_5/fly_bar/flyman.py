#!/usr/bin/env python3
"""The flyman: lowers the bar with the backdrop to the depth that the prompter calls."""

import rospy
from drum import approach, depth
from std_msgs.msg import Float64, String

CUES = {
    "forest": 5.6,
    "castle": 4.4,
    "moon": 2.5,
    "storm": 3.5,
}
settings = dict(fastest=0.9, braking=0.35, near=0.03, drum=0.80)
bar = {"cue": "", "turns": None, "there": True}

motor = None
says = None


def called(msg):
    if msg.data in CUES and msg.data != bar["cue"]:
        bar.update(cue=msg.data, there=False)
        rospy.loginfo("cue: %s", msg.data)


def turned(msg):
    bar["turns"] = msg.data


def move(_event):
    """One tick of the timer."""
    if bar["turns"] is None or not bar["cue"]:
        return
    left = CUES[bar["cue"]] - depth(bar["turns"])
    if abs(left) < settings["near"]:
        motor.publish(0.0)
        if not bar["there"]:
            bar["there"] = True
            says.publish(bar["cue"])
    elif not bar["there"]:
        motor.publish(approach(left, settings["fastest"], settings["braking"]) / settings["drum"])


def main():
    global motor, says
    rospy.init_node("flyman")
    bar.update(cue="", turns=None, there=True)
    motor = rospy.Publisher("bar/motor", Float64, queue_size=1)  # turns per second
    says = rospy.Publisher("bar/there", String, queue_size=1, latch=True)
    rospy.Subscriber("prompter/cue", String, called)
    rospy.Subscriber("bar/turns", Float64, turned)
    rospy.Timer(rospy.Duration(0.1), move)
    rospy.spin()


if __name__ == "__main__":
    main()
