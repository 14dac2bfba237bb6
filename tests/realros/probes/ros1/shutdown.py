import rospy
from std_msgs.msg import Float64

rospy.init_node("prober")
publisher = rospy.Publisher("out", Float64, queue_size=1)
rospy.on_shutdown(lambda: say("first hook", rospy.is_shutdown()))
rospy.on_shutdown(lambda: say("second hook", publisher.publish(0.0)))
try:
    rospy.on_shutdown(3)
except Exception as error:
    say(type(error).__name__)
rospy.sleep(0.15)
rospy.signal_shutdown("enough")
say("shut down", rospy.is_shutdown())
try:
    rospy.sleep(0.1)
except Exception as error:
    say(type(error).__name__, error)
rospy.spin()
say("end")
