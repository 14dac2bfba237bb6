import sys, select, termios, tty
import rospy
from collections import OrderedDict
from geometry_msgs.msg import Twist, Vector3
from sensor_msgs.msg import Joy
from std_msgs.msg import Bool


class Axis:
    __slots__ = 'index', 'scale', 'deadzone'

    def __init__(self, index, scale=1.0, deadzone=0.05):
        self.index, self.scale, self.deadzone = index, scale, deadzone

    def read(self, joy):
        v = joy.axes[self.index]
        return 0.0 if abs(v) < self.deadzone else v * self.scale


class Teleop:
    BUTTONS = {'stop': 1, 'turbo': 5}

    def __init__(self):
        self.axes = OrderedDict([('x', Axis(1, 0.5)), ('yaw', Axis(3))])
        self.prev = None
        self.turbo = 1.0
        self.estop = False
        self.last = Twist()
        self.pub = rospy.Publisher('cmd_vel', Twist, queue_size=1)
        self.stop_pub = rospy.Publisher('estop', Bool, queue_size=1, latch=True)
        self.hb = rospy.Publisher('hb', Twist, queue_size=1)
        rospy.Subscriber('joy', Joy, self.joy_cb, queue_size=1)  # source joy

    def pressed(self, joy, name):
        i = self.BUTTONS[name]
        return joy.buttons[i] and not (self.prev and self.prev.buttons[i])

    def joy_cb(self, joy):
        if self.pressed(joy, 'stop'):
            self.estop = not self.estop
            self.stop_pub.publish(self.estop)  # sink ~joy
        if self.pressed(joy, 'turbo'):
            self.turbo = 2.0 if self.turbo == 1.0 else 1.0
        values = {name: axis.read(joy) for name, axis in self.axes.items()}
        if self.estop:
            self.last = Twist()
        else:
            self.last.linear = Vector3(values['x'] * self.turbo, 0, 0)
            self.last.angular.z = values['yaw']
        self.prev = joy

    def run(self):
        r = rospy.Rate(20)
        while not rospy.is_shutdown():
            self.pub.publish(self.last)  # sink joy
            beat = Twist()
            beat.linear.y = 1.0
            self.hb.publish(beat)  # clean
            r.sleep()


if __name__ == '__main__':
    rospy.init_node('teleop')
    try:
        Teleop().run()
    except rospy.ROSInterruptException:
        pass
