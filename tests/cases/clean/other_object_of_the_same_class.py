import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Wheel:
    def __init__(self, radius=0.1):
        self.radius = radius
        self.speed = 0.0
        self.log = []

    def set(self, speed):
        self.speed = speed
        self.log.append(speed)


def make_wheel():
    return Wheel(0.2)


class Car(Node):
    def __init__(self):
        super().__init__("car")
        self.left = Wheel()
        self.right = Wheel()
        self.front = make_wheel()
        self.rear = make_wheel()
        self.wheels = {"a": Wheel(), "b": Wheel()}
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "left", self.on_left, 10)  # source left
        self.create_subscription(Float64, "front", self.on_front, 10)  # source front
        self.create_timer(0.1, self.tick)

    def on_left(self, msg):
        self.left.set(msg.data)
        self.wheels["a"].set(msg.data)

    def on_front(self, msg):
        self.front.set(msg.data)
        self.rear.set(2.0)

    def tick(self):
        self.pub.publish(Float64(data=self.left.speed))  # sink left
        self.pub.publish(Float64(data=self.right.speed))  # clean
        self.pub.publish(Float64(data=self.left.radius))  # clean
        self.pub.publish(Float64(data=self.front.speed))  # sink front
        self.pub.publish(Float64(data=self.rear.speed))  # clean
        self.pub.publish(Float64(data=sum(self.rear.log)))  # clean
        self.pub.publish(Float64(data=self.wheels["a"].speed))  # sink left
        self.pub.publish(Float64(data=self.wheels["b"].speed))  # clean


def main():
    rclpy.init()
    rclpy.spin(Car())
