"""actionlib: a SimpleActionServer with preemption, a SimpleActionClient in a callback."""

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, String


class Turner:
    def __init__(self):
        self.yaw = 0.0
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.on_odom)  # source odom
        self.server = actionlib.SimpleActionServer("turn", MoveBaseAction, self.execute, auto_start=False)  # source goal
        self.server.start()

    def on_odom(self, msg):
        self.yaw = msg.pose.pose.orientation.z

    def execute(self, goal):
        rate = rospy.Rate(20)
        wanted = goal.target_pose.pose.orientation.z
        while not rospy.is_shutdown() and abs(wanted - self.yaw) > 0.02:
            if self.server.is_preempt_requested():
                self.server.set_preempted()
                self.cmd.publish(Twist())  # sink ~odom ~goal
                return
            twist = Twist()
            twist.angular.z = 0.5 if wanted > self.yaw else -0.5
            self.cmd.publish(twist)  # sink ~odom ~goal
            rate.sleep()
        self.server.set_succeeded()


class Sender:
    def __init__(self):
        self.client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        self.client.wait_for_server(rospy.Duration(5))
        self.done = rospy.Publisher("done", Bool, queue_size=1)
        self.text = rospy.Publisher("text", String, queue_size=1)
        rospy.Subscriber("target", PoseStamped, self.on_target)  # source target
        rospy.Subscriber("abort", Bool, self.on_abort)  # source abort

    def on_target(self, msg):
        goal = MoveBaseGoal()
        goal.target_pose = msg
        goal.target_pose.header.stamp = rospy.Time.now()
        self.client.send_goal(goal, done_cb=self.on_done, active_cb=self.on_active)

    def on_active(self):
        self.text.publish("moving")  # clean

    def on_done(self, status, result):
        self.done.publish(status == GoalStatus.SUCCEEDED)  # sink target

    def on_abort(self, msg):
        if msg.data:
            self.client.cancel_all_goals()
            self.text.publish("aborted")  # sink ~abort


if __name__ == "__main__":
    rospy.init_node("actions")
    Turner()
    Sender()
    rospy.spin()
