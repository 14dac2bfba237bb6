#!/usr/bin/env python
# batch dryer for wheat: heat until the moisture is right, then cool and discharge
import rospy
from std_msgs.msg import Float32, String

HEAT, COOL, OUT = "heat", "cool", "out"


class Dryer:
    def __init__(self, target, tau, cool_to, max_air):
        self.target = target
        self.tau = tau
        self.cool_to = cool_to
        self.max_air = max_air
        self.moisture = None
        self.air = 20.0
        self.mode = HEAT
        self.below = 0
        self.mode_pub = rospy.Publisher("dryer/mode", String, queue_size=1, latch=True)
        self.burner_pub = rospy.Publisher("dryer/burner", Float32, queue_size=1)

    def on_air(self, msg):
        self.air = msg.data

    def on_moisture(self, msg):
        """Store the moisture in percent, from a capacitive probe in the return pipe."""
        if self.moisture is None:
            self.moisture = msg.data
        self.moisture += (msg.data - self.moisture) / self.tau

    def dry_enough(self):
        if self.moisture <= self.target:
            self.below += 1
        else:
            self.below = 0
        return self.below >= 3

    def burner(self):
        if self.mode != HEAT:
            return 0.0
        return max(0.0, min(1.0, 0.06 * (self.max_air - self.air)))

    def tick(self, event):
        if self.moisture is None:
            return
        if self.mode == HEAT and self.dry_enough():
            rospy.loginfo("dry at %.1f %%", self.moisture)
            self.mode = COOL
        elif self.mode == COOL and self.air < self.cool_to:
            self.mode = OUT
        self.burner_pub.publish(self.burner())
        self.mode_pub.publish(self.mode)


def main():
    rospy.init_node("grain_dryer")
    dryer = Dryer(
        target=rospy.get_param("~target", 13.5),
        tau=rospy.get_param("~tau", 4.0),
        cool_to=rospy.get_param("~cool_to", 35.0),
        max_air=rospy.get_param("~max_air", 85.0),
    )
    rospy.Subscriber("dryer/air", Float32, dryer.on_air)
    rospy.Subscriber("dryer/moisture", Float32, dryer.on_moisture)
    rospy.Timer(rospy.Duration(60.0), dryer.tick)
    rospy.spin()


if __name__ == "__main__":
    main()
