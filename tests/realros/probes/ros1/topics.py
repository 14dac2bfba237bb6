import rospy
from std_msgs.msg import Float64

rospy.init_node("prober")
rospy.Subscriber("/in", Float64, lambda message: say("first", message.data))
second = rospy.Subscriber("/in", Float64, lambda message, extra: say("second", message.data, extra), callback_args="x")
while rospy.get_time() < 0.35:
    rospy.sleep(0.1)
second.unregister()
say("unregistered", rospy.get_time())
rospy.spin()
say("spun", rospy.is_shutdown())
