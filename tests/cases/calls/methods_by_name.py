"""Methods that are stored before the call, are found by a prefix of their names, or configure a library object."""

import functools

import cv2
import numpy as np
import rclpy
from geometry_msgs.msg import Point
from rclpy.node import Node
from std_msgs.msg import Float64, String


class Desk(Node):
    def __init__(self):
        super().__init__("desk")
        self.filter = cv2.KalmanFilter(4, 2)
        self.other = cv2.KalmanFilter(4, 2)
        self.speed = 1.0
        listen = functools.partial(self.create_subscription, callback_group=None)
        listen(String, "command", self.on_command, 10)  # source command
        listen(Point, "point", self.on_point, 10)  # source point
        make = self.create_publisher
        self.out = make(Float64, "out", 10)
        self.reply = make(String, "reply", 10)

    def on_point(self, msg):
        measured = np.array([[msg.x], [msg.y]])
        self.filter.correct(measured)
        predicted = self.filter.predict()
        self.out.publish(Float64(data=float(predicted[0])))  # sink point
        self.out.publish(Float64(data=float(self.other.predict()[0])))  # clean

    def on_command(self, msg):
        verb, _, rest = msg.data.partition(" ")
        method = getattr(self, "do_" + verb, None)
        if method is None:
            self.reply.publish(String(data="unknown " + verb))  # sink command
            return
        method(rest)
        getattr(self, f"tell_{verb}")()

    def do_speed(self, text):
        self.speed = float(text)
        self.out.publish(Float64(data=self.speed))  # sink command

    def do_stop(self, _):
        self.out.publish(Float64(data=0.0))  # sink ~command

    def tell_speed(self):
        self.reply.publish(String(data=str(self.speed)))  # sink command

    def other_speed(self):
        self.out.publish(Float64(data=self.speed))


rclpy.init()
rclpy.spin(Desk())
