import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from std_msgs.msg import Float32, String


class Agent:
    def __init__(self, node, name):
        self.node = node
        self.name = name
        self.charge = 1.0
        self.goal = node.create_publisher(PoseStamped, f"{name}/goal", 10)
        self.chosen = node.create_publisher(String, f"{name}/chosen", 10)
        node.create_subscription(Float32, f"{name}/charge", self.charged, 10)  # source charge

    def charged(self, msg):
        self.charge = msg.data

    def send(self):
        goal = PoseStamped()
        goal.header.stamp = self.node.get_clock().now().to_msg()
        self.goal.publish(goal)  # sink ~charge

    def tell(self):
        self.chosen.publish(String(data=self.name))  # sink ~charge


class Fleet(Node):
    def __init__(self):
        super().__init__("fleet")
        self.agents = [Agent(self, "a"), Agent(self, "b")]
        self.stamp = self.create_publisher(PoseStamped, "stamp", 10)
        self.create_timer(1.0, self.dispatch)

    def dispatch(self):
        best = max(self.agents, key=lambda agent: agent.charge)
        pose = PoseStamped()
        pose.header.stamp = best.node.get_clock().now().to_msg()
        self.stamp.publish(pose)  # clean
        if best.charge > 0.5:
            best.send()
        best.tell()


rclpy.init()
rclpy.spin(Fleet())
