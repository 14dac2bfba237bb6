import rospy
from std_msgs.msg import Float64

rospy.init_node("prober")
say(rospy.wait_for_message("/in", Float64).data, rospy.get_time())
say(rospy.wait_for_message("/in", Float64, timeout=1.0).data, rospy.get_time())
try:
    rospy.wait_for_message("/silent", Float64, timeout=0.2)
except Exception as error:
    say(type(error).__name__, error)
try:
    rospy.wait_for_message("/silent", Float64)
except Exception as error:
    say(type(error).__name__)
