import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64, String

COMMANDS = {"left": 0.5, "right": -0.5, "none": 0.0}
side = "none"
speed = 0.0
names = []


def on_scan(msg):
    global side, speed
    if msg.ranges[0] < msg.ranges[-1]:
        side = "left"
    elif msg.ranges[0] > msg.ranges[-1]:
        side = "right"
    speed = 0.2
    if msg.ranges[0] < 0.1:
        names.append("near")


def turn_for(name):
    if name == "left":
        return 1.0
    elif name == "right":
        return -1.0
    return 0.0


def tick(event):
    pub.publish(COMMANDS[side])  # sink ~scan
    pub.publish(turn_for(side))  # sink ~scan
    pub.publish(turn_for("left"))  # clean
    pub.publish(speed)  # clean
    text.publish(side)  # sink ~scan
    text.publish(", ".join(names))  # sink ~scan
    cmd = Twist()
    cmd.angular.z = COMMANDS.get(side, 0.0)
    twist.publish(cmd)  # sink ~scan
    cmd.angular.z = COMMANDS["none"]
    twist.publish(cmd)  # clean
    for name in names:
        text.publish(name)  # sink ~scan


rospy.init_node("chosen")
pub = rospy.Publisher("turn", Float64, queue_size=1)
twist = rospy.Publisher("cmd_vel", Twist, queue_size=1)
text = rospy.Publisher("side", String, queue_size=1)
rospy.Subscriber("scan", LaserScan, on_scan)  # source scan
rospy.Timer(rospy.Duration(0.1), tick)
rospy.spin()
