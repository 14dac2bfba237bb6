import rospy
from geometry_msgs.msg import Point, Twist
from std_msgs.msg import Float64, Int8, String, UInt8

rospy.init_node("prober")
text = rospy.Publisher("text", String, queue_size=5)
number = rospy.Publisher("number", Float64, queue_size=5)
small = rospy.Publisher("small", Int8, queue_size=5)
place = rospy.Publisher("place", Point, queue_size=5)
for publisher, argument in ((number, "x"), (number, None), (number, Twist()), (small, 200), (small, 1.5), (text, 3),
                            (place, Point(1, "y", 3)), (number, True)):  # fmt: skip
    try:
        publisher.publish(argument)
        say("published", argument)
    except Exception as error:
        say(type(error).__name__)
for action in (lambda: number.publish(1, 2), lambda: number.publish(data=1.5), lambda: number.publish(wrong=1),
               lambda: rospy.Publisher("", String, queue_size=1), lambda: rospy.Publisher("x", None, queue_size=1),
               lambda: rospy.Publisher("x", 3, queue_size=1), lambda: rospy.Subscriber("x", int, print),
               lambda: rospy.Publisher("x", int, queue_size=1)):  # fmt: skip
    try:
        say(action() is not None)
    except Exception as error:
        say(type(error).__name__, error)
number.unregister()
try:
    number.publish(1.0)
except Exception as error:
    say(type(error).__name__, error)
