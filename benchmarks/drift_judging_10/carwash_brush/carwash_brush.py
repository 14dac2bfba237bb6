"""Press the side brush of a car wash against the car; the current of its motor shows how hard."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32
from std_srvs.srv import Trigger


class BrushPid:
    def __init__(self, kp, ki, kd, limit):
        self.kp, self.ki, self.kd, self.limit = kp, ki, kd, limit
        self.reset()

    def reset(self):
        self.total = 0.0
        self.last = None

    def update(self, error, dt):
        slope = 0.0 if self.last is None else (error - self.last) / dt
        self.last = error
        self.total = max(-self.limit, min(self.limit, self.total + self.ki * error * dt))
        out = self.kp * error + self.total + self.kd * slope
        return max(-self.limit, min(self.limit, out))


class CarwashBrush(Node):
    def __init__(self):
        super().__init__("carwash_brush")
        self.target_force = self.declare_parameter("target_force", 50.0).value  # N
        self.idle = self.declare_parameter("idle_current", 2.0).value  # current of the free brush (A)
        self.per_newton = self.declare_parameter("amps_per_newton", 0.030).value  # A/N
        self.contact = self.declare_parameter("contact_force", 12.0).value  # N
        self.approach = self.declare_parameter("approach_speed", 0.15).value  # m/s
        self.stuck = self.declare_parameter("stuck_force", 160.0).value  # N
        self.smooth = self.declare_parameter("smooth", 0.4).value
        self.pid = BrushPid(0.0030, 0.0010, 0.0, 0.35)
        self.current = self.idle
        self.state = "parked"
        self.car = False
        self.create_subscription(Float32, "brush/current", self.on_current, 10)
        self.create_subscription(Bool, "portal/over_car", self.on_car, 10)
        self.arm = self.create_publisher(Float32, "arm/speed", 10)
        self.spin = self.create_publisher(Bool, "brush/spin", 10)
        self.create_service(Trigger, "brush/release", self.on_release)
        self.dt = 0.05
        self.create_timer(self.dt, self.tick)

    def on_current(self, msg):
        self.current += self.smooth * (msg.data - self.current)

    def on_car(self, msg):
        self.car = msg.data

    def on_release(self, _request, response):
        self.state = "retract"
        response.success = True
        return response

    def force(self):
        """Return how hard the brush presses, N."""
        return max(0.0, (self.current - self.idle) / self.per_newton)

    def next_state(self):
        force = self.force()
        if not self.car:
            return "retract"
        if force > self.stuck:
            self.get_logger().error("the brush is caught")
            return "retract"
        if self.state in ("parked", "retract"):
            return "approach"
        if self.state == "approach" and force > self.contact:
            self.pid.reset()
            return "wash"
        return self.state

    def tick(self):
        self.state = self.next_state()
        speed = 0.0
        if self.state == "approach":
            speed = self.approach
        elif self.state == "wash":
            speed = self.pid.update(self.target_force - self.force(), self.dt)
        elif self.state == "retract":
            speed = -0.3
        self.spin.publish(Bool(data=self.state in ("approach", "wash")))
        self.arm.publish(Float32(data=float(speed)))


def main():
    rclpy.init()
    rclpy.spin(CarwashBrush())


if __name__ == "__main__":
    main()
