import rospy
from std_msgs.msg import Float64

for action in (lambda: rospy.Time.now(), lambda: rospy.Rate(10), lambda: rospy.sleep(0.1), lambda: rospy.spin(),
               lambda: rospy.get_time()):  # fmt: skip
    try:
        say(action())
    except Exception as error:
        say(type(error).__name__, error)
early = rospy.Publisher("early", Float64, queue_size=1)
try:
    early.publish(1.0)
except Exception as error:
    say(type(error).__name__, error)
for name in ("", "a/b"):
    try:
        rospy.init_node(name)
    except Exception as error:
        say(type(error).__name__, error)
rospy.init_node("prober")
say(rospy.get_name(), early.resolved_name)
try:
    rospy.init_node("another")
except Exception as error:
    say(type(error).__name__)
