import rospy
from std_msgs.msg import Bool, Float64

armed = {"value": False}


def arm(msg):
    armed["value"] = msg.data


rospy.init_node("lambda_control")
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("arm", Bool, arm)  # source arm
rospy.Subscriber("level", Float64, lambda m: pub.publish(m.data) if armed["value"] else None)  # source level # sink level ~arm
rospy.Timer(rospy.Duration(1), lambda _: armed["value"] and pub.publish(1.0))  # sink ~arm
rospy.Timer(rospy.Duration(1), lambda _: pub.publish(2.0))  # clean
rospy.spin()
