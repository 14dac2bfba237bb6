import rospy
from std_msgs.msg import Float64, String

rospy.init_node("prober")
heard = rospy.Subscriber("loop", String, lambda message: say("heard", message.data))
out = rospy.Publisher("loop", String, queue_size=10)
rospy.sleep(0.1)
for word in ("a", "b", "c"):
    out.publish(word)
say("published")
rospy.sleep(0.1)
message = String("kept")
out.publish(message)
message.data = "changed"
rospy.sleep(0.1)
latched = rospy.Publisher("latched", Float64, queue_size=1, latch=True)
latched.publish(4.0)
rospy.sleep(0.1)
rospy.Subscriber("latched", Float64, lambda message: say("latched", message.data))
rospy.sleep(0.1)
say("end")
