import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, String

STOP, GO, TURN = 0, 1, 2


class Machine:
    def __init__(self):
        self.state = STOP
        self.blocked = False
        self.enabled = False
        self.name = "idle"
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.text = rospy.Publisher("state", String, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("enable", Bool, self.on_enable)  # source enable
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_scan(self, msg):
        self.blocked = min(msg.ranges) < 0.5
        if self.state == GO and self.blocked:
            self.state = TURN
        elif self.state == TURN and not self.blocked:
            self.state = GO

    def on_enable(self, msg):
        self.enabled = msg.data

    def tick(self, event):
        cmd = Twist()
        if self.state == GO:
            cmd.linear.x = 0.2
        elif self.state == TURN:
            cmd.angular.z = 0.5
        self.pub.publish(cmd)  # sink ~scan ~enable
        if self.enabled:
            self.state = GO
            self.text.publish("go")  # sink ~enable
        if self.blocked and self.enabled:
            self.text.publish("blocked")  # sink ~scan ~enable
        self.text.publish(self.name)  # clean
        self.text.publish("on" if self.enabled else "off")  # sink ~enable
        speed = {True: 0.0, False: 0.3}[self.blocked]
        fast = Twist()
        fast.linear.x = speed
        self.pub.publish(fast)  # sink scan


rospy.init_node("machine")
Machine()
rospy.spin()
