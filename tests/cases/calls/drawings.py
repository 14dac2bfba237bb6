"""The image of a figure contains the data that was drawn into its axes, its lines or the current figure."""

import io

import matplotlib.pyplot as plt
import numpy as np
import PIL.Image
import rospy
from cv_bridge import CvBridge
from matplotlib.patches import Circle
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import Bool, Float64

bridge = CvBridge()


class Plot:
    def __init__(self):
        self.figure = plt.figure(figsize=(8, 5))
        self.axes = self.figure.add_subplot(1, 1, 1)
        (self.line,) = self.axes.plot([0, 0])
        self.image = rospy.Publisher("image", Image, queue_size=1)
        self.size = rospy.Publisher("size", Float64, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("found", Bool, self.on_found)  # source found
        rospy.Timer(rospy.Duration(0.1), self.draw)

    def on_scan(self, scan):
        self.line.set_data(range(len(scan.ranges)), scan.ranges)

    def on_found(self, msg):
        if msg.data:
            plt.plot(0.0, 1.0, "bo")

    def draw(self, event):
        self.axes.add_patch(Circle((0, 0), radius=1.0))
        self.size.publish(Circle((0, 0), radius=1.0).radius)  # clean
        buffer = io.BytesIO()
        self.figure.savefig(buffer, format="png")
        pixels = np.array(PIL.Image.open(buffer))
        self.image.publish(bridge.cv2_to_imgmsg(pixels))  # sink scan ~found
        self.figure.canvas.draw()
        again = np.frombuffer(self.figure.canvas.tostring_rgb())
        self.image.publish(bridge.cv2_to_imgmsg(again))  # sink scan ~found


rospy.init_node("plot")
Plot()
rospy.spin()
