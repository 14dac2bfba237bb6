#!/usr/bin/env python3
"""Fill bags with powder: turn a screw as often as the recipe requires, then release the bag."""

import rospy
from std_msgs.msg import Bool, Float64

RECIPE = {
    "kg_per_turn": 0.04,
    "fast": 12.0,  # turns per second
    "slow": 1.5,
    "ease": 1.8,  # speed (turns/s) per remaining turn
}


class Doser:
    """Count turns, command the motor."""

    def __init__(self):
        self.order = 0.0
        self.turns = 0.0
        self.first = None
        self.enough = rospy.get_param("~enough", 0.1)  # turns
        rospy.Subscriber("/order", Float64, self.on_order)
        rospy.Subscriber("/turns", Float64, self.on_turns)
        self.motor = rospy.Publisher("/screw", Float64, queue_size=1)
        self.release = rospy.Publisher("/release", Bool, queue_size=1)

    def on_order(self, msg):
        """Store the ordered weight of the bag, kg."""
        self.order = msg.data

    def on_turns(self, msg):
        """Store the number of turns of the screw since it was switched on."""
        if self.first is None:
            self.first = msg.data
        self.turns = msg.data - self.first

    def left(self):
        """Return the turns that are missing."""
        return self.order / RECIPE["kg_per_turn"] - self.turns

    def step(self):
        """Command the screw; release the bag when it is full."""
        missing = self.left()
        if missing < self.enough:
            self.motor.publish(0.0)
            self.release.publish(True)
            return
        self.motor.publish(max(RECIPE["slow"], min(RECIPE["fast"], RECIPE["ease"] * missing)))

    def run(self):
        """Dose until it is interrupted."""
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            if self.order > 0.0 and self.first is not None:
                self.step()
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("doser")
    Doser().run()
