import message_filters
import rospy
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Float64, Header


class Camera:
    def __init__(self):
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        self.sub = message_filters.Subscriber("image", Image)  # source image
        self.sub.registerCallback(self.on_image)
        self.cache = message_filters.Cache(message_filters.Subscriber("info", CameraInfo), 10)  # source info
        self.cache.registerCallback(self.on_info)
        self.width = 0

    def on_image(self, msg):
        self.pub.publish(msg.height)  # sink image
        self.pub.publish(self.width)  # sink info

    def on_info(self, msg):
        self.width = msg.width
        self.pub.publish(3.0)  # clean


rospy.init_node("camera")
Camera()
rospy.spin()
