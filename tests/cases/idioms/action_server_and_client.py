"""rclpy actions: a server with feedback and cancel, a client with future callbacks."""

import rclpy
from example_interfaces.action import Fibonacci
from nav2_msgs.action import NavigateToPose
from geometry_msgs.msg import PoseStamped
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from std_msgs.msg import Float64, Int32, String


class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.last = self.create_publisher(Int32, "last", 10)
        self.state = self.create_publisher(String, "state", 10)
        self.server = ActionServer(self, Fibonacci, "fibonacci", execute_callback=self.execute, goal_callback=self.on_goal, cancel_callback=self.on_cancel)  # source goal

    def on_goal(self, request):
        return GoalResponse.REJECT if request.order < 1 else GoalResponse.ACCEPT

    def on_cancel(self, handle):
        self.state.publish(String(data="cancel"))  # clean
        return CancelResponse.ACCEPT

    async def execute(self, handle):
        self.state.publish(String(data="begin"))  # sink ~goal
        feedback = Fibonacci.Feedback()
        feedback.sequence = [0, 1]
        for i in range(1, handle.request.order):
            if handle.is_cancel_requested:
                handle.canceled()
                return Fibonacci.Result()  # sink ~goal
            feedback.sequence.append(feedback.sequence[i] + feedback.sequence[i - 1])
            handle.publish_feedback(feedback)  # sink goal
        self.last.publish(Int32(data=feedback.sequence[-1]))  # sink goal
        handle.succeed()
        result = Fibonacci.Result()
        result.sequence = feedback.sequence
        return result  # sink goal


class Client(Node):
    def __init__(self):
        super().__init__("client")
        self.client = ActionClient(self, NavigateToPose, "navigate_to_pose")
        self.remaining = self.create_publisher(Float64, "remaining", 10)
        self.outcome = self.create_publisher(String, "outcome", 10)
        self.retries = self.create_publisher(Int32, "retries", 10)
        self.tries = 0
        self.goal = None
        self.create_subscription(PoseStamped, "goal", self.on_goal, 10)  # source pose

    def on_goal(self, msg):
        self.goal = NavigateToPose.Goal(pose=msg)
        self.send()

    def send(self):
        self.client.wait_for_server()
        future = self.client.send_goal_async(self.goal, feedback_callback=self.on_feedback)
        future.add_done_callback(self.on_response)

    def on_feedback(self, message):
        self.remaining.publish(Float64(data=message.feedback.distance_remaining))  # sink pose

    def on_response(self, future):
        handle = future.result()
        if not handle.accepted:
            self.outcome.publish(String(data="rejected"))  # sink ~pose
            return
        handle.get_result_async().add_done_callback(self.on_result)

    def on_result(self, future):
        status = future.result().status
        if status != 4 and self.tries < 3:
            self.tries += 1
            self.retries.publish(Int32(data=self.tries))  # sink ~pose
            self.send()
        else:
            self.outcome.publish(String(data=f"ended with {status}"))  # sink pose


def main():
    rclpy.init()
    executor = rclpy.executors.MultiThreadedExecutor()
    executor.add_node(Server())
    executor.add_node(Client())
    executor.spin()


if __name__ == "__main__":
    main()
