"""A simulator plugin that registers its callbacks in a helper function instead of its own methods."""

from geometry_msgs.msg import Twist
from std_msgs.msg import Float64

from sim.wiring import wire


class Wheels:
    def init(self, simulator, properties):
        self.turn = 0.0
        self.node = wire(Twist, "cmd_vel", self.on_command)  # source command
        self.left = self.node.create_publisher(Float64, "left", 1)
        self.beat = self.node.create_publisher(Float64, "beat", 1)

    def on_command(self, msg):
        self.turn = msg.angular.z

    def step(self):
        self.left.publish(Float64(data=-self.turn))  # sink command
        self.beat.publish(Float64(data=1.0))  # clean


class Forgotten:
    """A class that no package file names."""

    def init(self, simulator, properties):
        self.node = wire(Twist, "forgotten", self.on_command)
        self.left = self.node.create_publisher(Float64, "left", 1)

    def on_command(self, msg):
        self.left.publish(Float64(data=msg.angular.z))  # clean
