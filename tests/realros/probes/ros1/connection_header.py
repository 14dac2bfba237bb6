import rospy
from std_msgs.msg import String

rospy.init_node("prober")
out = rospy.Publisher("/words", String, queue_size=10, latch=True, headers={"cookies": "oreo"})


def hear(message):
    header = message._connection_header
    say(message.data, *(header.get(key) for key in ("callerid", "cookies", "latching", "topic", "type", "md5sum")))


rospy.Subscriber("/words", String, hear)
rospy.sleep(0.15)
out.publish("a")
rospy.sleep(0.1)
try:
    String("never sent")._connection_header
except AttributeError:
    say("no header before a message is received")
rospy.spin()
