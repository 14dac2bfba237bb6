import actionlib
import rospy
from move_msgs.msg import MoveAction, MoveFeedback, MoveResult
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64


class Mover:
    def __init__(self):
        self.position = 0.0
        self.pub = rospy.Publisher("cmd", Float64, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.on_odom)  # source odom
        self.server = actionlib.SimpleActionServer("move", MoveAction, self.execute, auto_start=False)  # source goal
        self.server.start()
        self.other = actionlib.SimpleActionServer("turn", MoveAction, auto_start=False)  # source turn
        self.other.register_goal_callback(self.on_turn)
        self.other.start()

    def on_odom(self, msg):
        self.position = msg.pose.pose.position.x

    def execute(self, goal):
        result = MoveResult()
        while not rospy.is_shutdown():
            if self.server.is_preempt_requested():
                self.server.set_preempted()  # clean
                return
            self.pub.publish(goal.target - self.position)  # sink goal odom
            feedback = MoveFeedback()
            feedback.position = self.position
            self.server.publish_feedback(feedback)  # sink odom
            rospy.sleep(0.1)
        result.final = goal.target
        self.server.set_succeeded(result)  # sink goal

    def on_turn(self):
        goal = self.other.accept_new_goal()
        self.pub.publish(goal.angle)  # sink turn
        self.other.set_succeeded(MoveResult(final=1.0))  # clean


rospy.init_node("mover")
Mover()
rospy.spin()
