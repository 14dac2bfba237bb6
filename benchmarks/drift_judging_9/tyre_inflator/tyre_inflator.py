"""Inflate the four tyres of a car: couple the hose, read the pressure, open the valve for a computed time, uncouple.

The gauge sees the hose's pressure while air flows, so the pressure of a tyre is read before and after
filling, not during it. A tyre cannot be deflated through the coupling.
"""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String

IDLE, COUPLING, READING, FILLING, CHECKING, RELEASING = range(6)
NAMES = ("idle", "coupling", "reading", "filling", "checking", "releasing")


class TyreInflator(Node):
    def __init__(self):
        super().__init__("tyre_inflator")
        self.declare_parameter("seconds_per_bar", 5.2)  # mid-size tyre at the station's pressure
        self.declare_parameter("tolerance", 0.1)  # bar
        self.declare_parameter("lowest", 0.6)  # a lower pressure means a puncture (bar)
        self.declare_parameter("longest", 20.0)  # s
        self.declare_parameter("settle", 0.6)  # s
        self.declare_parameter("couple_time", 1.0)  # s
        self.state = IDLE
        self.since = 0.0
        self.open_for = 0.0
        self.pressure = 0.0
        self.wanted = 0.0
        self.readings = []
        self.create_subscription(Float32, "hose/pressure", self.pressure_cb, 10)
        self.create_subscription(Float32, "car/target", self.target_cb, 10)
        self.valve = self.create_publisher(Bool, "hose/valve", 10)
        self.couple = self.create_publisher(Bool, "hose/couple", 10)
        self.info = self.create_publisher(String, "~/state", 10)
        self.timer = self.create_timer(0.05, self.run)

    def value(self, name):
        return self.get_parameter(name).value

    def clock(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def pressure_cb(self, msg):
        self.pressure = msg.data
        if self.state in (READING, CHECKING):
            self.readings.append(msg.data)

    def target_cb(self, msg):
        self.wanted = msg.data

    def go(self, state):
        self.state = state
        self.since = self.clock()
        self.readings = []

    def measured(self):
        """Return the mean of the second half of the readings, when the hose is quiet."""
        quiet = self.readings[len(self.readings) // 2 :]
        return sum(quiet) / len(quiet)

    def plan(self):
        """Compute how long the valve has to be open."""
        missing = self.wanted - self.measured()
        if self.measured() < self.value("lowest"):
            self.get_logger().warning("punctured")
            return 0.0
        if missing < self.value("tolerance"):
            return 0.0
        return min(self.value("longest"), missing * self.value("seconds_per_bar"))

    def run(self):
        spent = self.clock() - self.since
        if self.state == IDLE and self.wanted > 0.0:
            self.go(COUPLING)
        elif self.state == COUPLING and spent > self.value("couple_time"):
            self.go(READING)
        elif self.state == READING and spent > self.value("settle"):
            self.open_for = self.plan()
            self.go(FILLING if self.open_for > 0.0 else RELEASING)
        elif self.state == FILLING and spent > self.open_for:
            self.go(CHECKING)
        elif self.state == CHECKING and spent > self.value("settle"):
            self.get_logger().info(f"{self.measured():.2f} of {self.wanted:.2f} bar")
            self.go(RELEASING)
        elif self.state == RELEASING and self.wanted <= 0.0:
            self.go(IDLE)
        self.valve.publish(Bool(data=self.state == FILLING))
        self.couple.publish(Bool(data=self.state not in (IDLE, RELEASING)))
        self.info.publish(String(data=NAMES[self.state]))


def main(args=None):
    rclpy.init(args=args)
    node = TyreInflator()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
