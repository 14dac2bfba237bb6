import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64, String

WEIGHTS = [0.2, 0.3, 0.5]


def on_scan(msg):
    close = [r for r in msg.ranges if r < 1.0]
    pub.publish(min(close))  # sink scan
    pub.publish(len(close))  # sink scan
    weighted = sum(w * r for w, r in zip(WEIGHTS, msg.ranges))
    pub.publish(weighted)  # sink scan
    pub.publish(sum(w for w in WEIGHTS))  # clean
    by_angle = {i: r for i, r in enumerate(msg.ranges)}
    pub.publish(by_angle[0])  # sink scan
    squares = {round(r) for r in msg.ranges}
    pub.publish(max(squares))  # sink scan
    flat = [x for row in [[1.0], [msg.range_max]] for x in row]
    pub.publish(flat[0])  # sink scan
    table = {name: len(name) for name in ("a", "bc")}
    pub.publish(table["a"])  # clean
    if any(r < 0.2 for r in msg.ranges):
        pub.publish(0.0)  # sink ~scan
    chosen = [w for w in WEIGHTS if w > msg.range_min]
    pub.publish(chosen[0])  # sink ~scan
    r = 2.0
    pub.publish(r)  # clean
    text.publish(", ".join(f"{x:.1f}" for x in msg.ranges))  # sink scan


rospy.init_node("comprehend")
pub = rospy.Publisher("out", Float64, queue_size=1)
text = rospy.Publisher("text", String, queue_size=1)
rospy.Subscriber("scan", LaserScan, on_scan)  # source scan
rospy.spin()
