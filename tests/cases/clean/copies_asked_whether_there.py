"""Whether a message has arrived is not its data, even if a copy is tested: a variable, a result, a parameter."""

import threading

import cv2
import rospy
from cv_bridge import CvBridge
from sensor_msgs.msg import Image
from std_msgs.msg import Bool, Float64


class Camera:
    def __init__(self):
        self.bridge = CvBridge()
        self.lock = threading.Lock()
        self.image = None
        self.level = None
        self.high = None
        self.best = None
        self.slots = [None, None]
        self.there = rospy.Publisher("there", Bool, queue_size=1)
        self.out = rospy.Publisher("out", Image, queue_size=1)
        rospy.Subscriber("image", Image, self.on_image)  # source image
        rospy.Subscriber("level", Float64, self.on_level)  # source level

    def on_image(self, msg):
        with self.lock:
            self.image = self.bridge.imgmsg_to_cv2(msg)

    def on_level(self, msg):
        self.level = msg.data
        self.slots[0] = msg.data
        if msg.data > 3.0:
            self.high = msg.data
            self.best = msg.data
        else:
            self.best = None

    def take(self):
        with self.lock:
            image = self.image
            self.image = None
        return image

    def both(self):
        return self.level, self.high

    def large(self):
        if self.level > 1.0:
            return None
        return self.level

    def draw(self, image):
        if image is None:
            self.there.publish(False)  # clean
            return
        self.there.publish(True)  # clean
        self.out.publish(self.bridge.cv2_to_imgmsg(cv2.flip(image, 1)))  # sink image

    def low(self, level=None):
        if level is None:
            self.there.publish(False)  # sink ~level

    def variables(self, _):
        level = self.level
        if level is None:
            return
        self.there.publish(True)  # clean
        high = self.high
        if high is not None:
            self.there.publish(True)  # sink ~level
        best = self.best
        self.there.publish(best is None)  # sink ~level
        first = self.slots[0]
        if first is None:
            self.there.publish(False)  # clean
        if level:
            self.there.publish(True)  # sink ~level

    def results(self, _):
        image = self.take()
        if image is None:
            return
        if image.mean() > 3.0:
            cv2.circle(image, (5, 5), 3, (0, 0, 255))
        self.there.publish(True)  # clean
        level, high = self.both()
        if level is None:
            self.there.publish(False)  # clean
        if high is None:
            self.there.publish(False)  # sink ~level
        if self.take() is None:
            self.there.publish(False)  # clean
        large = self.large()
        if large is None:
            self.there.publish(False)  # sink ~level

    def parameters(self, _):
        self.draw(self.image)
        self.low(level=self.high)
        self.low()


rospy.init_node("camera")
camera = Camera()
rospy.Timer(rospy.Duration(0.1), camera.variables)
rospy.Timer(rospy.Duration(0.1), camera.results)
rospy.Timer(rospy.Duration(0.1), camera.parameters)
rospy.spin()
