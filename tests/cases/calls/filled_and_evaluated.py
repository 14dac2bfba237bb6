import dlib
import rospy
from std_msgs.msg import Float64


class Filter:
    def __init__(self):
        self.expression = rospy.get_param("~expression")
        self.pub = rospy.Publisher("found", Float64, queue_size=1)
        self.full = rospy.Publisher("full", Float64, queue_size=1)
        self.value = rospy.Publisher("value", Float64, queue_size=1)
        self.fixed = rospy.Publisher("fixed", Float64, queue_size=1)
        rospy.Subscriber("image", Float64, self.on_image)  # source image
        rospy.Subscriber("raw", Float64, self.on_raw)  # source raw

    def on_image(self, msg):
        rects, known = [], [1.0]
        dlib.find_locations(msg.data, rects, known)
        for rect in rects:
            self.pub.publish(rect.left())  # sink image
        self.full.publish(known[0])  # clean

    def on_raw(self, m):
        self.value.publish(eval(self.expression))  # sink raw
        self.fixed.publish(eval("1 + 1"))  # clean


Filter()
rospy.spin()
