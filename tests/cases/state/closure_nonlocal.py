import rclpy
from std_msgs.msg import Float64, Int32


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node("closure")
    pub = node.create_publisher(Float64, "out", 10)
    latest = 0.0
    best = 100.0
    shadowed = 1.0
    counter = {"n": 0}

    def on_value(msg):
        nonlocal latest, best
        latest = msg.data
        best = 1.0
        shadowed = msg.data
        node.get_logger().info(f"{shadowed}")

    def on_count(msg):
        counter["n"] += msg.data

    def on_timer():
        pub.publish(Float64(data=latest))  # sink value
        pub.publish(Float64(data=best))  # clean
        pub.publish(Float64(data=shadowed))  # clean
        pub.publish(Float64(data=float(counter["n"])))  # sink count

    node.create_subscription(Float64, "value", on_value, 10)  # source value
    node.create_subscription(Int32, "count", on_count, 10)  # source count
    node.create_timer(0.1, on_timer)
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
