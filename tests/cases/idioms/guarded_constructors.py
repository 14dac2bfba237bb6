"""A package that may be missing: `__init__` raises, and the `main` function handles the exception."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, String

try:
    import vision

    READY = True
except ImportError:
    READY = False


class Planner:
    def plan(self, speed):
        if speed > 1.0:
            return "brake"
        return "cruise"


class Pilot(Node):
    def __init__(self, planner):
        if not READY:
            raise ImportError("install vision")
        super().__init__("pilot")
        self.planner = planner
        self.speed = 0.0
        self.out = self.create_publisher(String, "plan", 10)
        self.create_subscription(Float64, "speed", self.on_speed, 10)  # source speed
        self.create_timer(0.1, self.tick)
        self.out.publish(String(data="ready"))  # clean

    def on_speed(self, msg):
        self.speed = msg.data

    def tick(self):
        self.out.publish(String(data=self.planner.plan(self.speed)))  # sink ~speed


def main():
    rclpy.init()
    try:
        pilot = Pilot(Planner())
        rclpy.spin(pilot)
    except KeyboardInterrupt:
        pass
    except Exception as error:
        print(error)
    finally:
        rclpy.shutdown()


if __name__ == "__main__":
    main()
