import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64


class Reset:
    def __init__(self):
        self.cmd = Twist()
        self.other = Twist()
        self.value = 0.0
        self.values = {"x": 0.0}
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.num = rospy.Publisher("num", Float64, queue_size=1)
        rospy.Subscriber("speed", Float64, self.on_speed)  # source speed

    def on_speed(self, msg):
        self.cmd.linear.x = msg.data
        self.pub.publish(self.cmd)  # sink speed
        self.cmd.linear.x = 0.0
        self.pub.publish(self.cmd)  # clean
        self.value = msg.data
        self.value = 1.0
        self.num.publish(self.value)  # clean
        local = msg.data
        rospy.loginfo("%f", local)
        local = 2.0
        self.num.publish(local)  # clean
        self.values["x"] = msg.data
        self.values["x"] = 3.0
        self.num.publish(self.values["x"])  # clean
        cmd = self.other
        cmd.angular.z = msg.data
        self.other = Twist()
        self.pub.publish(self.other)  # clean
        self.pub.publish(cmd)  # sink speed
        if msg.data > 1.0:
            local = 4.0
        else:
            local = 4.5
        local = 5.0
        self.num.publish(local)  # clean
        numbers = [msg.data]
        numbers.clear()
        numbers.append(6.0)
        self.num.publish(numbers[0])  # clean
        del numbers
        numbers = [7.0]
        self.num.publish(numbers[0])  # clean


rospy.init_node("reset")
Reset()
rospy.spin()
