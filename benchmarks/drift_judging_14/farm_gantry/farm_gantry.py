#!/usr/bin/env python3
"""Water the plants of a raised bed: move the nozzle above a plant, open the valve for its dose, go on."""

import rclpy
from axis import Axis
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32MultiArray, String

X_TEETH = 20  # pulley on both sides of the track
Y_TEETH = 20
X_TRAVEL = 2900.0  # mm
Y_TRAVEL = 1400.0  # mm


class FarmGantry(Node):
    def __init__(self):
        super().__init__("farm_gantry")
        self.declare_parameter("speed", 250.0)  # mm/s
        self.declare_parameter("flow", 40.0)  # flow through the nozzle (ml/s)
        self.declare_parameter("tolerance", 4.0)  # mm
        self.declare_parameter("settle_time", 0.4)  # time until the nozzle hangs still (s)
        self.speed = self.get_parameter("speed").value
        self.flow = self.get_parameter("flow").value
        self.tolerance = self.get_parameter("tolerance").value
        self.settle_time = self.get_parameter("settle_time").value

        self.x_axis = Axis("x", X_TEETH, X_TRAVEL)
        self.y_axis = Axis("y", Y_TEETH, Y_TRAVEL)
        self.position = (0.0, 0.0)
        self.plant = None
        self.dose = 0.0
        self.state = "idle"
        self.timer = 0.0
        self.soil = 0.0

        self.motor_pub = self.create_publisher(Int32MultiArray, "motors/goal", 10)
        self.valve_pub = self.create_publisher(Bool, "valve", 10)
        self.state_pub = self.create_publisher(String, "gantry/state", 10)
        self.create_subscription(PointStamped, "bed/plant", self.plant_callback, 10)
        self.create_subscription(Int32MultiArray, "motors/steps", self.steps_callback, 10)
        self.create_subscription(Float32, "soil/moisture", self.soil_callback, 10)
        self.period = 0.1
        self.create_timer(self.period, self.tick)

    def plant_callback(self, msg):
        """x and y in m from the corner of the bed; z is the dose in litres."""
        plant = (1000.0 * msg.point.x, 1000.0 * msg.point.y)
        if self.state == "idle" and plant != self.plant:
            self.plant = plant
            self.dose = 1000.0 * msg.point.z
            self.state = "moving"

    def steps_callback(self, msg):
        self.position = (self.x_axis.to_mm(msg.data[0]), self.y_axis.to_mm(msg.data[1]))

    def soil_callback(self, msg):
        self.soil = msg.data

    def arrived(self):
        dx = abs(self.plant[0] - self.position[0])
        dy = abs(self.plant[1] - self.position[1])
        return max(dx, dy) < self.tolerance

    def enter(self, state):
        self.state = state
        self.timer = 0.0

    def tick(self):
        self.timer += self.period
        if self.state == "moving":
            step = self.speed * self.period
            goal = Int32MultiArray()
            goal.data = [
                self.x_axis.advance(self.plant[0], step),
                self.y_axis.advance(self.plant[1], step),
            ]
            self.motor_pub.publish(goal)
            if self.arrived():
                self.enter("settling")
        elif self.state == "settling":
            if self.timer >= self.settle_time:
                self.enter("watering")
        elif self.state == "watering":
            if self.timer * self.flow > self.dose:
                self.get_logger().info(f"plant at {self.plant} done, soil {self.soil:.2f}")
                self.enter("idle")
        self.valve_pub.publish(Bool(data=self.state == "watering"))
        self.state_pub.publish(String(data=self.state))


def main():
    rclpy.init()
    node = FarmGantry()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
