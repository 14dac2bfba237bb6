import rospy
from geometry_msgs.msg import *
from std_msgs.msg import *


def advertise(topic, kind):
    return rospy.Publisher(topic, kind, queue_size=1)
