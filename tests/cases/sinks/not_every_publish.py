import rospy
from std_msgs.msg import Float64
import paho.mqtt.client as mqtt


class Board:
    def publish(self, value):
        self.shown = value


class Relay:
    def __init__(self):
        self.out = rospy.Publisher("out", Float64, queue_size=1)

    def publish(self, value):
        self.out.publish(value)  # sink value


class Quiet:
    def __init__(self):
        self.out = rospy.Publisher("quiet", Float64, queue_size=1)

    def publish(self, value):
        self.out.publish(1.0)  # clean


board, relay, quiet = Board(), Relay(), Quiet()
client = mqtt.Client()


def on_value(msg):
    board.publish(msg.data)
    relay.publish(msg.data)
    quiet.publish(msg.data)
    client.publish("topic", msg.data)


rospy.init_node("not_every")
rospy.Subscriber("value", Float64, on_value)  # source value
rospy.spin()
