import rospy
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse
from robot_msgs.srv import SetSpeed, SetSpeedResponse


class Server:
    def __init__(self):
        self.speed = 0.0
        self.enabled = True
        self.pub = rospy.Publisher("speed", Float64, queue_size=1)
        rospy.Service("set_speed", SetSpeed, self.on_speed)  # source speed
        rospy.Service("enable", SetBool, self.on_enable)  # source enable
        rospy.Service("reset", Trigger, self.on_reset)  # source reset
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_speed(self, request):
        self.speed = request.speed
        return SetSpeedResponse(True)  # clean

    def on_enable(self, request):
        self.enabled = request.data
        return SetBoolResponse(success=request.data, message="")  # sink enable

    def on_reset(self, _):
        self.pub.publish(0.0)  # clean
        return TriggerResponse()  # clean

    def tick(self, event):
        if not self.enabled:
            return
        self.pub.publish(self.speed)  # sink speed ~enable


rospy.init_node("server")
Server()
rospy.spin()
