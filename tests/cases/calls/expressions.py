import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64, String


def on_scan(scan):
    front = scan.ranges[0:10] + scan.ranges[350:]
    pub.publish(min(front))  # sink scan
    pub.publish(front[-1])  # sink scan
    distance = scan.ranges[0] if scan.ranges else 10.0
    pub.publish(distance)  # sink scan
    pub.publish(1.0 if scan.ranges[0] > 1.0 else 2.0)  # sink ~scan
    pub.publish(scan.ranges[0] or 1.0)  # sink scan
    pub.publish(None or 1.0)  # clean
    pub.publish(-scan.ranges[0] ** 2 // 3)  # sink scan
    text.publish("distance %.2f" % distance)  # sink scan
    text.publish("distance {:.2f}".format(distance))  # sink scan
    text.publish(f"distance {distance:.2f} m")  # sink scan
    text.publish("distance " + str(distance))  # sink scan
    text.publish(" ".join(["distance", str(distance)]))  # sink scan
    text.publish("distance {name}".format(name="front"))  # clean
    text.publish(String(data=repr(scan)))  # sink scan
    low, high = (scan.range_min, 5.0) if distance > 1 else (0.0, 6.0)
    pub.publish(low)  # sink scan
    pub.publish(high)  # sink ~scan
    pub.publish(sorted(scan.ranges)[len(scan.ranges) // 2])  # sink scan
    pub.publish([1.0, 2.0, 3.0][1:][0])  # clean
    pub.publish(0.0 < distance < 5.0)  # sink scan
    pub.publish(not scan.ranges)  # sink scan
    pub.publish([0.0, 1.0][distance > 1.0])  # sink scan


rospy.init_node("expressions")
pub = rospy.Publisher("out", Float64, queue_size=1)
text = rospy.Publisher("text", String, queue_size=1)
rospy.Subscriber("scan", LaserScan, on_scan)  # source scan
rospy.spin()
