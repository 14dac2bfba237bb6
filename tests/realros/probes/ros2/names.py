import rclpy

rclpy.init()
node = rclpy.create_node("prober", namespace="space")
say(node.get_name(), node.get_namespace(), node.get_fully_qualified_name())
for name in ("topic", "/topic", "~/topic", "a/b"):
    say(node.resolve_topic_name(name))
from std_msgs.msg import Float64

say(node.create_publisher(Float64, "out", 1).topic_name, node.create_subscription(Float64, "~/in", print, 1).topic_name)
for action in (
    lambda: rclpy.create_node("bad name"),
    lambda: rclpy.create_node("x/y"),
    lambda: node.create_publisher(Float64, "bad topic", 1),
    lambda: node.create_publisher(int, "out", 1),
    lambda: node.create_publisher(Float64, "out2", 1).publish("x"),
    lambda: node.create_publisher(Float64, "out2", 1).publish(1.0),
    lambda: rclpy.init(),
):
    try:
        say(action() is not None)
    except Exception as error:
        say(type(error).__name__)
rclpy.shutdown()
say(rclpy.ok())
for action in (rclpy.shutdown, rclpy.try_shutdown, lambda: rclpy.create_node("late")):
    try:
        say(action())
    except Exception as error:
        say(type(error).__name__)
