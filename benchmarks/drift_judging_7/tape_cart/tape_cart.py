#!/usr/bin/env python
# linen cart: follows the black tape on the hospital floor and stops at the cross mark
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, UInt16MultiArray

PITCH = 0.02  # distance between two eyes (m)
lost = 0
offset = 0.0


def eyes_cb(msg):
    global lost, offset
    limit = rospy.get_param("~dark", 420)
    dark = [v < limit for v in msg.data]
    n = sum(dark)
    cmd = Twist()
    if n == len(dark):
        done_pub.publish(True)
        cmd_pub.publish(cmd)
        return
    if n == 0:
        lost += 1
    else:
        lost = 0
        middle = (len(dark) - 1) / 2.0
        offset = PITCH * sum(i - middle for i, d in enumerate(dark) if d) / n
    if lost > 8:
        rospy.logwarn_throttle(5, "tape lost")
        cmd_pub.publish(cmd)
        return
    cmd.linear.x = rospy.get_param("~speed", 0.4)
    cmd.angular.z = -rospy.get_param("~kp", 12.0) * offset
    cmd_pub.publish(cmd)


rospy.init_node("tape_cart")
cmd_pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
done_pub = rospy.Publisher("arrived", Bool, queue_size=1)
rospy.Subscriber("line_eyes", UInt16MultiArray, eyes_cb)
rospy.spin()
