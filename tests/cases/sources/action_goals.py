import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from std_msgs.msg import Float64


class Actions(Node):
    def __init__(self):
        super().__init__("actions")
        self.limit = 3
        self.reading = 0
        self.handle = None
        self.wanted = 0
        self.pub = self.create_publisher(Float64, "order", 10)
        self.create_subscription(Float64, "reading", self.on_reading, 10)  # source reading
        self.server = ActionServer(  # source goal
            self,
            Fibonacci,
            "fibonacci",
            execute_callback=self.execute,
            goal_callback=self.on_goal,
            handle_accepted_callback=self.on_accepted,
            cancel_callback=self.on_cancel,
        )
        self.create_timer(0.1, self.tick)

    def on_reading(self, msg):
        self.reading = msg.data

    def on_goal(self, goal):
        self.wanted = goal.order
        return GoalResponse.ACCEPT

    def on_accepted(self, handle):
        self.handle = handle
        handle.execute()

    def on_cancel(self, handle):
        return CancelResponse.ACCEPT

    async def execute(self, goal_handle):
        feedback = Fibonacci.Feedback()
        feedback.sequence = [0, 1]
        goal_handle.publish_feedback(feedback)  # clean
        for i in range(goal_handle.request.order):
            feedback.sequence.append(feedback.sequence[i])
            goal_handle.publish_feedback(feedback)  # sink goal
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()  # clean
            return Fibonacci.Result()  # clean
        goal_handle.succeed()  # clean
        result = Fibonacci.Result()
        result.sequence = [self.reading]
        return result  # sink reading

    def tick(self):
        self.pub.publish(Float64(data=float(self.wanted)))  # sink goal
        if self.handle is not None:
            self.pub.publish(Float64(data=float(self.handle.request.order)))  # sink goal
        self.pub.publish(Float64(data=float(self.limit)))  # clean


def main():
    rclpy.init()
    rclpy.spin(Actions())
