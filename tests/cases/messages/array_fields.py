import rospy
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Path
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Float64, Float64MultiArray, MultiArrayDimension
from visualization_msgs.msg import Marker, MarkerArray

path = Path()
path.header.frame_id = "map"


def on_pose(msg):
    path.poses.append(msg)
    paths.publish(path)  # sink pose
    numbers.publish(len(path.header.frame_id))  # clean


def on_scan(scan):
    array = MarkerArray()
    for i, distance in enumerate(scan.ranges):
        marker = Marker()
        marker.id = i
        marker.scale.x = 0.1
        marker.points.append(Point(x=distance))
        array.markers.append(marker)
    markers.publish(array)  # sink scan
    out = LaserScan()
    out.ranges = [min(r, 5.0) for r in scan.ranges]
    out.range_max = 5.0
    scans.publish(out)  # sink scan
    numbers.publish(out.range_max)  # clean
    filtered = LaserScan()
    filtered.header = scan.header
    filtered.ranges = list(scan.ranges)[10:20]
    filtered.ranges[0] = 0.0
    scans.publish(filtered)  # sink scan


def on_joints(msg):
    state = JointState()
    state.name = ["a", "b"]
    state.position = [0.0] * 2
    state.position[0] = msg.position[0]
    joints.publish(state)  # sink joints
    numbers.publish(state.position[0])  # sink joints
    fixed = JointState()
    fixed.position = [0.0, 0.0]
    fixed.position.extend([1.0, 2.0])
    joints.publish(fixed)  # clean
    data = Float64MultiArray()
    data.layout.dim.append(MultiArrayDimension())
    data.layout.dim[0].size = 2
    data.data += list(msg.velocity)
    arrays.publish(data)  # sink joints
    empty = Float64MultiArray()
    empty.layout.dim.append(MultiArrayDimension(label="x"))
    arrays.publish(empty)  # clean


rospy.init_node("arrays")
paths = rospy.Publisher("path", Path, queue_size=1)
markers = rospy.Publisher("markers", MarkerArray, queue_size=1)
scans = rospy.Publisher("scan_out", LaserScan, queue_size=1)
joints = rospy.Publisher("joints_out", JointState, queue_size=1)
arrays = rospy.Publisher("array", Float64MultiArray, queue_size=1)
numbers = rospy.Publisher("number", Float64, queue_size=1)
rospy.Subscriber("pose", PoseStamped, on_pose)  # source pose
rospy.Subscriber("scan", LaserScan, on_scan)  # source scan
rospy.Subscriber("joints", JointState, on_joints)  # source joints
rospy.spin()
