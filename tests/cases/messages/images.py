import cv2
import numpy as np
import rospy
from cv_bridge import CvBridge, CvBridgeError
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Float64


class Blobs:
    def __init__(self):
        self.bridge = CvBridge()
        self.background = None
        self.threshold = 30
        self.images = rospy.Publisher("debug", Image, queue_size=1)
        self.area = rospy.Publisher("area", Float64, queue_size=1)
        rospy.Subscriber("image", Image, self.on_image)  # source image
        rospy.Subscriber("jpeg", CompressedImage, self.on_jpeg)  # source jpeg

    def on_image(self, msg):
        try:
            frame = self.bridge.imgmsg_to_cv2(msg, desired_encoding="bgr8")
        except CvBridgeError as error:
            rospy.logerr(error)
            return
        gray = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
        _, mask = cv2.threshold(gray, self.threshold, 255, cv2.THRESH_BINARY)
        contours, _ = cv2.findContours(mask, cv2.RETR_TREE, cv2.CHAIN_APPROX_SIMPLE)
        largest = max(contours, key=cv2.contourArea)
        self.area.publish(cv2.contourArea(largest))  # sink image
        self.area.publish(self.threshold)  # clean
        moments = cv2.moments(mask)
        if moments["m00"] > 0:
            self.area.publish(moments["m10"] / moments["m00"])  # sink image
        canvas = np.zeros((10, 10, 3), np.uint8)
        cv2.drawContours(canvas, contours, -1, (0, 255, 0), 2)
        out = self.bridge.cv2_to_imgmsg(canvas, "bgr8")
        self.images.publish(out)  # sink image
        empty = self.bridge.cv2_to_imgmsg(np.zeros((10, 10, 3), np.uint8), "bgr8")
        self.images.publish(empty)  # clean

    def on_jpeg(self, msg):
        buffer = np.frombuffer(msg.data, np.uint8)
        frame = cv2.imdecode(buffer, cv2.IMREAD_COLOR)
        height, width = frame.shape[:2]
        self.area.publish(width * height)  # sink jpeg
        small = cv2.resize(frame, (0, 0), fx=0.5, fy=0.5)
        self.images.publish(self.bridge.cv2_to_imgmsg(small[10:20, 5:]))  # sink jpeg


rospy.init_node("blobs")
Blobs()
rospy.spin()
