import rospy
from std_msgs.msg import Float64


class Configured:
    def __init__(self):
        self.value = 0.0
        topic = rospy.get_param("~input", "in")
        prefix = rospy.get_param("~prefix")
        gain = rospy.get_param("~gain", 2.0)
        self.gain = gain
        name = rospy.remap_name("remapped")
        self.pub = rospy.Publisher("/".join([prefix, "out"]), Float64, queue_size=1)
        rospy.Subscriber(topic, Float64, self.on_value)  # source value
        rospy.Subscriber(rospy.resolve_name(name), Float64, getattr(self, "on_named"))  # source named
        rospy.Subscriber("{}/{}".format(prefix, "fmt"), Float64, self.on_format)  # source format

    def on_value(self, msg):
        self.pub.publish(self.gain * msg.data)  # sink value
        self.pub.publish(self.gain)  # clean

    def on_named(self, msg):
        self.pub.publish(msg)  # sink named

    def on_format(self, msg):
        self.pub.publish(msg)  # sink format


rospy.init_node("configured")
Configured()
rospy.spin()
