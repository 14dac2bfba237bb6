#!/usr/bin/env python3
import rospy, math
from sensor_msgs.msg import LaserScan
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from tf.transformations import euler_from_quaternion

regions_ = {'right': 0, 'fright': 0, 'front': 0, 'fleft': 0, 'left': 0}
state_ = 0
state_dict_ = {0: 'find the wall', 1: 'turn left', 2: 'follow the wall'}
pub_ = None
yaw_ = 0
desired = [0.0, 0.0]
count = 0


def clbk_laser(msg):
    global regions_
    regions_ = {
        'right': min(min(msg.ranges[0:143]), 10),
        'front': min(min(msg.ranges[288:431]), 10),
        'left': min(min(msg.ranges[576:713]), 10),
    }
    take_action()


def clbk_odom(msg):
    global yaw_
    o = msg.pose.pose.orientation
    roll, pitch, yaw_ = euler_from_quaternion([o.x, o.y, o.z, o.w])
    desired[0] = msg.pose.pose.position.x


def change_state(state):
    global state_
    if state != state_:
        print('Wall follower - [%s] - %s' % (state, state_dict_[state]))
        state_ = state


def take_action():
    global count
    count += 1
    d = 1.5
    if regions_['front'] > d:
        change_state(0)
    elif regions_['front'] < d:
        change_state(1)
    else:
        rospy.loginfo(regions_)


def find_wall():
    msg = Twist()
    msg.linear.x = 0.2
    msg.angular.z = -0.3
    return msg


def turn_left():
    msg = Twist()
    msg.angular.z = 0.3 * math.cos(yaw_)
    return msg


def main():
    global pub_
    rospy.init_node('reading_laser')
    pub_ = rospy.Publisher('/cmd_vel', Twist, queue_size=1)
    dbg = rospy.Publisher('/dbg', Twist, queue_size=1)
    sub = rospy.Subscriber('/scan', LaserScan, clbk_laser)  # source scan
    rospy.Subscriber('/odom', Odometry, clbk_odom)  # source odom
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        msg = Twist()
        if state_ == 0:
            msg = find_wall()
        elif state_ == 1:
            msg = turn_left()
        elif state_ == 2:
            msg.linear.x = 0.5
        else:
            rospy.logerr('Unknown state!')
        pub_.publish(msg)  # sink odom ~scan
        out = Twist()
        out.linear.x = desired[1]
        dbg.publish(out)  # clean
        out.linear.y = desired[0]
        dbg.publish(out)  # sink odom
        out.linear.y = count
        dbg.publish(out)  # clean
        rate.sleep()


if __name__ == '__main__':
    main()
