import rclpy
from rclpy.qos import (
    DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data, qos_profile_system_default)  # fmt: skip
from std_msgs.msg import Float64

rclpy.init()
plain = QoSProfile(depth=5)
say(plain.depth, plain.reliability.name, plain.durability.name, plain.history.name)
say(qos_profile_sensor_data.depth, qos_profile_sensor_data.reliability.name, qos_profile_system_default.history.name)
say(plain == QoSProfile(depth=5), plain == QoSProfile(depth=6))
for action in (lambda: QoSProfile(), lambda: QoSProfile(depth=-1), lambda: QoSProfile(history=HistoryPolicy.KEEP_LAST)):
    try:
        say(action() is not None)
    except Exception as error:
        say(type(error).__name__)
node = rclpy.create_node("prober")
kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)
publisher = node.create_publisher(Float64, "kept", kept)
publisher.publish(Float64(data=1.0))
publisher.publish(Float64(data=2.0))
node.create_subscription(Float64, "kept", lambda message: say("late", message.data), kept)
node.create_subscription(Float64, "kept", lambda message: say("volatile", message.data), 10)
deep = node.create_publisher(Float64, "deep", 10)
node.create_subscription(Float64, "deep", lambda message: say("shallow", message.data), 2)
node.create_subscription(Float64, "deep", lambda message: say("wants more", message.data), kept)
for number in range(4):
    deep.publish(Float64(data=float(number)))
for _ in range(10):
    rclpy.spin_once(node, timeout_sec=0.05)
say("end")
