#!/usr/bin/env python3
"""Plug a charging connector into a car.

The camera gives a rough position of the inlet. The arm goes there, presses lightly, and follows a spiral until the
connector drops in. If the spiral ends without success, the car is left to the attendant.
"""

import math
from enum import Enum, auto

import rclpy
from geometry_msgs.msg import Point, PointStamped, WrenchStamped
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Bool, String

RATE_HZ = 10.0


class Phase(Enum):
    IDLE = auto()
    APPROACH = auto()
    TOUCH = auto()
    SEARCH = auto()
    INSERT = auto()
    LATCHED = auto()
    CALL = auto()


class Spiral:
    """Archimedean spiral, followed at constant speed along its arc."""

    def __init__(self, pitch, speed, max_radius):
        self.pitch = pitch
        self.speed = speed
        self.max_radius = max_radius
        self.angle = 0.0

    @property
    def radius(self):
        return self.pitch * self.angle / (2.0 * math.pi)

    @property
    def exhausted(self):
        return self.radius > self.max_radius

    def advance(self, dt):
        """Return the next offset from the middle, m."""
        arm = max(self.radius, 0.25 * self.pitch)
        self.angle += self.speed * dt / arm
        return self.radius * math.cos(self.angle), self.radius * math.sin(self.angle)


class Plugger(Node):
    def __init__(self):
        super().__init__("plugger")
        declared = self.declare_parameters(
            namespace="",
            parameters=[
                ("spiral.pitch", 0.0016),
                ("spiral.speed", 0.009),
                ("spiral.max_radius", 0.005),
                ("touch_force", 5.0),
                ("insert_depth", 0.02),
                ("insert_speed", 0.02),
                ("approach_gap", 0.03),
            ],
        )
        self.cfg = {p.name: p.value for p in declared}
        self.phase = Phase.IDLE
        self.inlet = None
        self.tool = Point()
        self.push = 0.0
        self.spiral = None
        self.surface = 0.0
        qos = QoSProfile(depth=5)
        self.create_subscription(PointStamped, "camera/inlet", self.on_inlet, qos)
        self.create_subscription(PointStamped, "arm/tool", self.on_tool, qos)
        self.create_subscription(WrenchStamped, "arm/wrench", self.on_wrench, qos)
        self.command = self.create_publisher(PointStamped, "arm/command", qos)
        self.state = self.create_publisher(String, "plugger/state", qos)
        self.latched = self.create_publisher(Bool, "plugger/latched", qos)
        self.timer = self.create_timer(1.0 / RATE_HZ, self.on_timer)

    # -- input ---------------------------------------------------------------------------------------------------

    def on_inlet(self, msg):
        """Average the camera's estimates while the arm still waits or approaches."""
        seen = (msg.point.x, msg.point.y)
        if self.inlet is None:
            self.inlet = seen
        elif self.phase in (Phase.IDLE, Phase.APPROACH):
            self.inlet = tuple(0.7 * old + 0.3 * new for old, new in zip(self.inlet, seen))

    def on_tool(self, msg):
        self.tool = msg.point

    def on_wrench(self, msg):
        self.push = msg.wrench.force.z

    # -- phases --------------------------------------------------------------------------------------------------

    def enter(self, phase):
        self.get_logger().info(f"{self.phase.name} -> {phase.name}")
        self.phase = phase

    def send(self, x, y, z):
        msg = PointStamped()
        msg.header.stamp = self.get_clock().now().to_msg()
        msg.header.frame_id = "bay"
        msg.point = Point(x=x, y=y, z=z)
        self.command.publish(msg)

    def approach(self):
        x, y = self.inlet
        gap = self.cfg["approach_gap"]
        self.send(x, y, -gap)
        if math.dist((self.tool.x, self.tool.y, self.tool.z), (x, y, -gap)) < 0.002:
            self.enter(Phase.TOUCH)

    def touch(self):
        x, y = self.inlet
        self.send(x, y, self.tool.z + 0.05 / RATE_HZ)
        if self.push > self.cfg["touch_force"]:
            self.surface = self.tool.z
            self.spiral = Spiral(*(self.cfg[f"spiral.{key}"] for key in ("pitch", "speed", "max_radius")))
            self.enter(Phase.SEARCH)
        elif self.tool.z > 0.006:  # the connector touches nothing, so the estimate was right
            self.enter(Phase.INSERT)

    def search(self):
        if self.tool.z > self.surface + 0.004:
            self.enter(Phase.INSERT)
            return
        if self.spiral.exhausted:
            self.send(self.tool.x, self.tool.y, -self.cfg["approach_gap"])
            self.enter(Phase.CALL)
            return
        dx, dy = self.spiral.advance(1.0 / RATE_HZ)
        self.send(self.inlet[0] + dx, self.inlet[1] + dy, self.surface + 0.006)

    def insert(self):
        self.send(self.tool.x, self.tool.y, self.tool.z + self.cfg["insert_speed"] / RATE_HZ)
        if self.tool.z > self.surface + self.cfg["insert_depth"]:
            self.enter(Phase.LATCHED)

    def on_timer(self):
        if self.phase is Phase.IDLE:
            if self.inlet is not None:
                self.enter(Phase.APPROACH)
        elif self.phase is Phase.APPROACH:
            self.approach()
        elif self.phase is Phase.TOUCH:
            self.touch()
        elif self.phase is Phase.SEARCH:
            self.search()
        elif self.phase is Phase.INSERT:
            self.insert()
        self.state.publish(String(data=self.phase.name))
        self.latched.publish(Bool(data=self.phase is Phase.LATCHED))


def main(args=None):
    rclpy.init(args=args)
    plugger = Plugger()
    try:
        rclpy.spin(plugger)
    except KeyboardInterrupt:
        pass
    plugger.destroy_node()


if __name__ == "__main__":
    main()
