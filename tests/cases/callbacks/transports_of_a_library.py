"""Nodes whose base class, from a library, advertises their topics and calls `subscribe` if there is a listener."""

import numpy as np
import rospy
from cv_bridge import CvBridge
from jsk_topic_tools import ConnectionBasedTransport
from sensor_msgs.msg import Image
from std_msgs.msg import Bool, Float64


class Brightness(ConnectionBasedTransport):
    def __init__(self):
        super().__init__()
        self.bridge = CvBridge()
        self.pub = self.advertise("~output", Float64, queue_size=1)
        self.alive = self.advertise("~alive", Bool, queue_size=1)

    def subscribe(self):
        self.sub = rospy.Subscriber("~input", Image, self.on_image, queue_size=1)  # source image

    def unsubscribe(self):
        self.sub.unregister()

    def on_image(self, msg):
        img = self.bridge.imgmsg_to_cv2(msg, desired_encoding="mono8")
        self.pub.publish(float(np.mean(img)))  # sink image
        self.alive.publish(True)  # clean


if __name__ == "__main__":
    rospy.init_node("brightness")
    Brightness()
    rospy.spin()
