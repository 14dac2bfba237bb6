"""Cut a block of cheese into portions of one weight: push it under the scanner, and cut when enough has passed."""

import rclpy
from profile_of_block import Section, section
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Float32MultiArray


class CheesePortioner(Node):
    def __init__(self):
        super().__init__("cheese_portioner")
        self.declare_parameters(
            "",
            [
                ("portion", 250.0),  # g
                ("density", 1.09),  # g/cm³
                ("kerf", 0.10),  # thickness that the blade cuts away (cm)
                ("spacing", 1.0),  # distance between two heights (cm)
                ("push", 2.0),  # cm/s
                ("creep", 0.5),  # speed near the cut (cm/s)
                ("creep_at", 0.85),  # as a share of a portion
                ("clearance", 12.0),  # clearance under the raised blade (cm)
            ],
        )
        self.area = 0.0
        self.highest = 0.0
        self.pusher = None
        self.volume = 0.0
        self.cutting = 0
        self.portions = 0
        self.create_subscription(Float32MultiArray, "scanner/heights", self.on_heights, 10)
        self.create_subscription(Float32, "pusher/place", self.on_pusher, 10)
        self.speed = self.create_publisher(Float32, "pusher/speed", 10)
        self.blade = self.create_publisher(Bool, "blade/down", 10)
        self.weight = self.create_publisher(Float32, "panel/grams", 10)
        self.create_timer(0.05, self.tick)

    def value(self, name):
        return self.get_parameter(name).value

    def on_heights(self, msg):
        measured: Section = section(list(msg.data), self.value("spacing"))
        self.area = measured.area if self.area == 0.0 else 0.7 * self.area + 0.3 * measured.area
        self.highest = measured.highest

    def on_pusher(self, msg):
        if self.pusher is not None and not self.cutting:
            self.volume += self.area * max(0.0, msg.data - self.pusher)
        self.pusher = msg.data

    def grams(self):
        """Return the weight of what has passed the blade since the last cut."""
        lost = self.area * self.value("kerf")
        return (self.volume - lost) * self.value("density")

    def push(self):
        if self.highest > self.value("clearance"):
            return 0.0
        near = self.grams() > self.value("creep_at") * self.value("portion")
        return self.value("creep") if near else self.value("push")

    def tick(self):
        speed = 0.0
        if self.cutting:
            self.cutting -= 1
        elif self.grams() >= self.value("portion"):
            self.cutting = 6
            self.portions += 1
            self.volume = 0.0
        else:
            speed = self.push()
        self.blade.publish(Bool(data=self.cutting > 0))
        self.speed.publish(Float32(data=speed))
        self.weight.publish(Float32(data=float(self.grams())))


def main():
    rclpy.init()
    rclpy.spin(CheesePortioner())


if __name__ == "__main__":
    main()
