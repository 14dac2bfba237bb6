#!/usr/bin/env python3
"""Opens and closes a prosthetic hand by two electrodes on the forearm."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, String

CLOSING, OPENING, RESTING = "closing", "opening", "resting"
DOMINANCE = 1.3  # one muscle must be this much stronger than the other


class EmgHand(Node):
    """Proportional control with thresholds; a gripped object stops the fingers."""

    def __init__(self):
        super().__init__("emg_hand")
        self.declare_parameters(
            "",
            [
                ("flexor_on", 0.42),
                ("extensor_on", 0.36),
                ("flexor_smoothing", 0.30),
                ("extensor_smoothing", 0.25),
                ("release_share", 0.55),  # share of a threshold at which the hand comes to rest
                ("close_speed", 0.09),  # m/s
                ("open_speed", 0.11),
                ("grip_force", 9.0),  # N
                ("k_force", 0.012),
                ("battery_low", 6.9),
            ],
        )
        self.flexor, self.extensor = 0.0, 0.0
        self.force = 0.0
        self.aperture = 0.09
        self.state = RESTING
        self.speed_pub = self.create_publisher(Float64, "hand/speed", 10)
        self.state_pub = self.create_publisher(String, "hand/state", 10)
        self.create_subscription(Float64, "emg/flexor", self.on_flexor, 10)
        self.create_subscription(Float64, "emg/extensor", self.on_extensor, 10)
        self.create_subscription(Float64, "hand/force", self.on_force, 10)
        self.create_subscription(Float64, "hand/aperture", self.on_aperture, 10)
        self.create_subscription(Float64, "hand/battery", self.on_battery, 10)
        self.create_timer(0.05, self.update)

    def get(self, name):
        return self.get_parameter(name).value

    def on_flexor(self, msg):
        self.flexor += self.get("flexor_smoothing") * (abs(msg.data) - self.flexor)

    def on_extensor(self, msg):
        self.extensor += self.get("extensor_smoothing") * (abs(msg.data) - self.extensor)

    def on_force(self, msg):
        self.force = 0.5 * self.force + 0.5 * msg.data

    def on_aperture(self, msg):
        self.aperture = msg.data

    def on_battery(self, msg):
        if msg.data < self.get("battery_low"):
            self.get_logger().warning(f"battery at {msg.data:.1f} V", throttle_duration_sec=10.0)

    def decide(self):
        if self.flexor > self.get("flexor_on") and self.flexor > DOMINANCE * self.extensor:
            return CLOSING
        if self.extensor > self.get("extensor_on") and self.extensor > DOMINANCE * self.flexor:
            return OPENING
        if self.state == CLOSING and self.flexor > self.get("release_share") * self.get("flexor_on"):
            return CLOSING
        return RESTING

    def update(self):
        self.state = self.decide()
        speed = 0.0
        if self.state == CLOSING:
            speed = -self.get("close_speed")
            if self.force > 0.5:  # in contact: build up the force gently
                speed = -self.get("k_force") * max(0.0, self.get("grip_force") - self.force)
        elif self.state == OPENING and self.aperture < 0.088:
            speed = self.get("open_speed")
        self.speed_pub.publish(Float64(data=speed))
        self.state_pub.publish(String(data=self.state))


def main():
    rclpy.init()
    node = EmgHand()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
