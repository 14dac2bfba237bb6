import rospy
from overlays.text import Overlay
from paho.mqtt.client import Client
from std_msgs.msg import Float64


class Fixed(Overlay):
    def publish(self, text):
        self.pub.publish(text)  # sink level


def on_level(msg):
    global level
    level = msg
    fixed.publish(msg.data)


def on_timer(event):
    if level:
        if level.data > 3:
            text.publish("high")  # sink ~level
        client.publish("vision/mode", "high" if level.data > 3 else "low")
    text.publish("alive")  # clean


level = None
text = Overlay("~text")
fixed = Fixed("~fixed")
client = Client("someone")
rospy.Subscriber("level", Float64, on_level)  # source level
rospy.Timer(rospy.Duration(0.1), on_timer)
rospy.spin()
