import rclpy
from copy import deepcopy
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.node import Node
from std_msgs.msg import Float64, Int32


class Smoother(Node):
    def __init__(self):
        super().__init__("smoother")
        self.path = Path()
        self.limit = 0.0
        self.trail = Path()
        self.pub = self.create_publisher(Float64, "out", 1)
        self.count = self.create_publisher(Int32, "count", 1)
        self.path_pub = self.create_publisher(Path, "smooth", 1)
        self.create_subscription(Path, "path", self.on_path, 1)  # source path
        self.create_subscription(Float64, "limit", self.on_limit, 1)  # source limit
        self.create_subscription(PoseStamped, "pose", self.on_pose, 1)  # source pose
        self.create_timer(0.1, self.tick)

    def on_path(self, msg):
        self.path = msg

    def on_limit(self, msg):
        self.limit = msg.data

    def on_pose(self, msg):
        if msg.pose.position.x > 1.0:
            self.trail.poses.append(PoseStamped())

    def tick(self):
        path = deepcopy(self.path)
        for p in path.poses:
            p.pose.position.z = min(p.pose.position.z, self.limit)
        self.path_pub.publish(path)  # sink path limit
        self.count.publish(Int32(data=len(path.poses)))  # sink path
        self.pub.publish(Float64(data=sum(p.pose.position.x for p in path.poses)))  # sink path
        first, second, *_ = path.poses
        self.pub.publish(Float64(data=second.pose.position.z))  # sink path limit
        self.pub.publish(Float64(data=second.pose.position.x))  # sink path
        if path.poses:
            self.pub.publish(Float64(data=1.0))  # sink ~path
        self.count.publish(Int32(data=len(self.trail.poses)))  # sink ~pose
        self.count.publish(Int32(data=3))  # clean
        self.mark()

    def mark(self):
        route = Path()
        route.poses = [PoseStamped(), PoseStamped()]
        route.poses[0].pose.position.x = self.limit
        self.pub.publish(Float64(data=sum(p.pose.position.x for p in route.poses)))  # sink limit
        self.pub.publish(Float64(data=sum(p.pose.position.y for p in route.poses)))  # clean
        known = deepcopy(self.path)
        known.poses[0].pose.position.x = self.limit
        self.pub.publish(Float64(data=sum(p.pose.position.x for p in known.poses)))  # sink path limit
        self.pub.publish(Float64(data=sum(p.pose.position.y for p in known.poses)))  # sink path


rclpy.init()
rclpy.spin(Smoother())
