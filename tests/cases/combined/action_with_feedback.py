import time
import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.callback_groups import ReentrantCallbackGroup
from nav_msgs.msg import Odometry
from geometry_msgs.msg import Twist
from my_interfaces.action import Drive


class DriveServer(Node):
    def __init__(self):
        super().__init__("drive_server")
        self.x = 0.0
        self.group = ReentrantCallbackGroup()
        self.sub = self.create_subscription(Odometry, "odom", self.on_odom, 10, callback_group=self.group)  # source odom
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.server = ActionServer(  # source goal
            self, Drive, "drive",
            execute_callback=self.execute,
            goal_callback=self.on_goal,
            cancel_callback=lambda h: CancelResponse.ACCEPT,
            callback_group=self.group)
        self.pub.publish(Twist())  # clean

    def on_odom(self, msg):
        self.x = msg.pose.pose.position.x

    def on_goal(self, request):
        return GoalResponse.ACCEPT if request.distance > 0 else GoalResponse.REJECT

    async def execute(self, handle):
        start = self.x
        self.pub.publish(Twist())  # sink ~goal
        feedback = Drive.Feedback()
        while self.x - start < handle.request.distance:
            if handle.is_cancel_requested:
                handle.canceled()
                return Drive.Result()  # sink ~odom ~goal
            cmd = Twist()
            cmd.linear.x = min(0.5, handle.request.speed)
            self.pub.publish(cmd)  # sink goal ~odom
            feedback.travelled = self.x - start
            handle.publish_feedback(feedback)  # sink odom ~goal
            time.sleep(0.1)
        self.pub.publish(Twist())  # sink ~odom ~goal
        handle.succeed()
        result = Drive.Result()
        result.total = self.x - start
        return result  # sink odom ~goal


def main():
    rclpy.init()
    node = DriveServer()
    rclpy.spin(node, executor=rclpy.executors.MultiThreadedExecutor())
