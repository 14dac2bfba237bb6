import rospy
from nav_msgs.srv import GetMap, GetMapRequest, GetMapResponse, GetPlan, SetMap

rospy.init_node("prober")
response = GetMapResponse()
response.map.header.frame_id = "hall"
response.map.data = [1, -1, 100]


def give(request):
    say("asked", type(request).__name__, rospy.get_time())
    rospy.sleep(0.1)
    return response


def fail(request):
    raise ValueError("no plan")


GIVING = rospy.Service("~give", GetMap, give)
rospy.Service("fail", GetPlan, fail)
rospy.Service("nothing", SetMap, lambda request: None)
rospy.Service("wrong", GetMap, lambda request: "text")
rospy.Service("fields", SetMap, lambda request: {"success": request.initial_pose.pose.pose.position.x > 1})
say(GIVING.resolved_name, GetMap._type, GetMap._md5sum, GetMap._request_class.__name__)
rospy.wait_for_service("/prober/give")
ask = rospy.ServiceProxy("~give", GetMap)
say(ask.resolved_name, ask.request_class.__name__, ask.response_class.__name__)
for arguments in ((), (GetMapRequest(),)):
    answer = ask(*arguments)
    say(type(answer).__name__, answer.map.header.frame_id, answer.map.data, rospy.get_time())
say(ask.call(GetMapRequest()) == response)
steady = rospy.ServiceProxy("~give", GetMap, persistent=True)
say(steady().map.data, steady().map.data, rospy.get_time())
steady.close()
fields = rospy.ServiceProxy("fields", SetMap)
request = fields.request_class()
say(fields(request).success)
request.initial_pose.pose.pose.position.x = 2.0
say(fields(map=request.map, initial_pose=request.initial_pose).success)
for action in (
    lambda: rospy.ServiceProxy("fail", GetPlan)(),
    lambda: rospy.ServiceProxy("nothing", SetMap)(),
    lambda: rospy.ServiceProxy("nobody", GetMap)(),
    lambda: rospy.wait_for_service("nobody", timeout=0.2),
    lambda: rospy.wait_for_service("nobody", timeout=0),
    lambda: ask(1),
    lambda: ask(wrong=1),
    lambda: rospy.Service("fail", GetPlan, fail) is None,
    lambda: rospy.ServiceProxy("", GetMap),
):
    try:
        say(action() is not None)
    except Exception as error:
        say(type(error).__name__, error)
try:
    rospy.ServiceProxy("wrong", GetMap)()
except rospy.ServiceException as error:
    say(str(error).partition("processing request")[0])
GIVING.shutdown("enough")
try:
    ask()
except Exception as error:
    say(type(error).__name__, error)
say("end", rospy.get_time())
