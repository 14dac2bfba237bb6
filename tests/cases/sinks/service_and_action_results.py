import actionlib
import rospy
from robot_msgs.msg import ScanAction, ScanResult
from robot_msgs.srv import GetRange, GetRangeResponse
from sensor_msgs.msg import LaserScan

nearest = 10.0
names = ["front", "rear"]


def on_scan(msg):
    global nearest
    nearest = min(msg.ranges)


def on_request(request):
    if request.index >= len(names):
        return None  # sink ~range
    if request.index == 0:
        return GetRangeResponse(range=nearest)  # sink scan ~range
    return GetRangeResponse(range=0.0, name=names[request.index])  # sink range


def on_fixed(request):
    return {"range": 1.0}  # clean


def execute(goal):
    server.set_succeeded(ScanResult(range=nearest), "done")  # sink scan
    server.set_aborted(text="failed")  # clean


rospy.init_node("ranges")
rospy.Subscriber("scan", LaserScan, on_scan)  # source scan
rospy.Service("get_range", GetRange, on_request)  # source range
rospy.Service("get_fixed", GetRange, on_fixed)  # source fixed
rospy.Service("twice", GetRange, lambda request: GetRangeResponse(2 * request.index))  # source twice # sink twice
server = actionlib.SimpleActionServer("scan", ScanAction, execute_cb=execute)  # source goal
rospy.spin()
