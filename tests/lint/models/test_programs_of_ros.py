"""Subscriptions, services, actions, timers, threads and parameters pass data on as they do in ROS."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing

HEAD = """\
import actionlib, asyncio, functools, message_filters, rclpy, rclpy.action, rclpy.node, rospy, smach, threading, time
from std_msgs.msg import Float64
from sensor_msgs.msg import LaserScan
from demo.srv import Add, AddResponse
from demo.action import Go
from demo.msg import GoAction, GoFeedback, GoResult

out = rospy.Publisher("out", Float64, queue_size=1)
node = rclpy.create_node("node")
"""
# Programs, each below its title.
PROGRAMS = """\
### a subscription with extra arguments
def on(msg, args):
    out.publish(msg.data)  # data
    out.publish(args[0])  # clean
rospy.Subscriber("in", Float64, on, callback_args=(1.0, 2.0))
### a subscription from a mapping of keywords
def on(msg):
    out.publish(msg.data)  # data
given = {"name": "in", "data_class": Float64, "callback": on}
rospy.Subscriber(**given)
### a subscription whose callback is one of several
def near(msg):
    out.publish(msg.data)  # data
def far(msg):
    out.publish(1.0)  # clean
rospy.Subscriber("in", Float64, near if rospy.get_name() else far)
### a callback that is a method, a partial function or a callable object
class C:
    def __init__(self, gain):
        self.gain = gain
    def on(self, msg):
        out.publish(self.gain * msg.data)  # data
        out.publish(self.gain)  # clean
    def __call__(self, msg):
        out.publish(msg.data)  # data
rospy.Subscriber("a", Float64, C(1.0).on)
rospy.Subscriber("b", Float64, C(2.0))
def third(gain, msg):
    out.publish(msg.data)  # data
    out.publish(gain)  # clean
rospy.Subscriber("c", Float64, functools.partial(third, 3.0))
def fourth(msg, gain):
    out.publish(msg.data)  # data
    out.publish(gain)  # clean
rospy.Subscriber("d", Float64, functools.partial(fourth, gain=3.0))
### state that one callback stores and another one publishes
class C:
    def __init__(self):
        self.last = 0.0
        self.count = 0
        self.limit = 1.0
        rospy.Subscriber("in", Float64, self.on)
        rospy.Timer(rospy.Duration(1.0), self.tick)
    def on(self, msg):
        self.last = msg.data
        self.count += 1
        if msg.data > 5.0:
            self.limit = 2.0
    def tick(self, event):
        out.publish(self.last)  # data
        out.publish(self.count)  # clean
        out.publish(self.limit)  # control
        if self.last > 1.0:
            out.publish(3.0)  # control
C()
### a loop of the main program reads what callbacks store
last = [0.0]
def on(msg):
    last[0] = msg.data
rospy.Subscriber("in", Float64, on)
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    out.publish(last[0])  # data
    out.publish(2.0)  # clean
    rate.sleep()
### before the first message, nothing has arrived
last = None
def on(msg):
    global last
    last = msg
rospy.Subscriber("in", Float64, on)
while last is None:
    out.publish(1.0)  # clean
    rospy.sleep(1.0)
out.publish(last.data)  # data
### a message that is waited for
msg = rospy.wait_for_message("in", Float64, timeout=5.0)
out.publish(msg.data)  # data
if msg.data > 1.0:
    out.publish(2.0)  # control
out.publish(3.0)  # clean
### a publisher out of several
pubs = {name: rospy.Publisher(name, Float64, queue_size=1) for name in ("a", "b")}
def on(msg):
    pubs["a"].publish(msg.data)  # data
    pubs[msg.name].publish(1.0)  # control
    for pub in pubs.values():
        pub.publish(2.0)  # clean
rospy.Subscriber("in", Float64, on)
### a publisher that data chooses
left, right = rospy.Publisher("l", Float64), rospy.Publisher("r", Float64)
def on(msg):
    pub = left if msg.data > 0.0 else right
    pub.publish(1.0)  # control
    left.publish(1.0)  # clean
rospy.Subscriber("in", Float64, on)
### a helper that publishes
def send(value, twice=False):
    out.publish(value)  # data
    if twice:
        out.publish(1.0)  # control
def on(msg):
    send(msg.data)
    send(2.0, msg.data > 0.0)
rospy.Subscriber("in", Float64, on)
### a helper that is called under a condition
def send():
    out.publish(1.0)  # control
def stop():
    out.publish(0.0)  # clean
def on(msg):
    if msg.data > 0.0:
        send()
    stop()
rospy.Subscriber("in", Float64, on)
stop()
### a service
def handle(request):
    out.publish(request.a)  # data
    if request.b > 0.0:
        return AddResponse(1.0)  # control
    return AddResponse(request.a)  # data
rospy.Service("add", Add, handle)
### a service without data in its response
def handle(request):
    return AddResponse(1.0)  # clean
rospy.Service("add", Add, handle)
### a service of rclpy
def handle(request, response):
    response.sum = request.a
    out.publish(response.sum)  # data
    out.publish(response.other)  # clean
    return response  # data
node.create_service(Add, "add", handle)
### an action server
class S:
    def __init__(self):
        self.server = actionlib.SimpleActionServer("go", GoAction, execute_cb=self.run, auto_start=False)
        self.server.register_preempt_callback(self.stopped)
        self.server.start()
    def run(self, goal):
        out.publish(goal.target)  # data
        self.server.publish_feedback(GoFeedback(goal.target))  # data
        self.server.publish_feedback(GoFeedback(1.0))  # clean
        if goal.target > 1.0:
            self.server.set_aborted()  # clean
        else:
            self.server.set_succeeded(GoResult(goal.target))  # data
    def stopped(self):
        out.publish(1.0)  # clean
S()
### an action server of rclpy
def run(handle):
    handle.publish_feedback(Go.Feedback(done=handle.request.target))  # data
    out.publish(handle.request.target)  # data
    handle.succeed()  # clean
    result = Go.Result()
    result.reached = handle.request.target
    return result  # data
def accept(goal):
    out.publish(goal.target)  # data
    return 1
rclpy.action.ActionServer(node, Go, "go", run, goal_callback=accept)
### a goal runs only if it is accepted
class S:
    def __init__(self):
        self.level, self.full = 1.0, True
        self.go = rclpy.action.ActionServer(node, Go, "go", self.run, goal_callback=self.accept)
        node.create_subscription(Float64, "level", self.on, 10)
    def on(self, msg):
        self.level = msg.data
        out.publish(5.0)  # clean
    def accept(self, goal):
        if self.level < 0.2:
            return rclpy.action.GoalResponse.REJECT
        return rclpy.action.GoalResponse.ACCEPT
    def run(self, handle):
        out.publish(1.0)  # control
        self.help()
        handle.succeed()
        return Go.Result()  # control
    def help(self):
        out.publish(2.0)  # control
S()
### the goal itself decides whether it runs
def accept(goal):
    good = goal.target > 0.0
    return rclpy.action.GoalResponse.ACCEPT if good else rclpy.action.GoalResponse.REJECT
def run(handle):
    out.publish(1.0)  # control
    out.publish(handle.request.target)  # data
    return Go.Result()  # control
rclpy.action.ActionServer(node, Go, "go", run, goal_callback=accept)
### every goal is accepted
level = 0.0
def on(msg):
    global level
    level = msg.data
def accept(goal):
    if level < 0.2:
        print("low")
        return rclpy.action.GoalResponse.ACCEPT
    return rclpy.action.GoalResponse.ACCEPT
def run(handle):
    out.publish(1.0)  # clean
    return Go.Result()  # clean
rclpy.action.ActionServer(node, Go, "go", run, goal_callback=accept)
node.create_subscription(Float64, "level", on, 10)
### an accepted goal runs when the server executes it
class S:
    def __init__(self):
        self.busy = False
        rclpy.action.ActionServer(node, Go, "go", self.run, handle_accepted_callback=self.begin)
        node.create_subscription(Float64, "busy", self.on, 10)
    def on(self, msg):
        self.busy = msg.data
    def begin(self, handle):
        out.publish(3.0)  # clean
        if not self.busy:
            handle.execute()
    def run(self, handle):
        out.publish(1.0)  # control
        return Go.Result()  # control
S()
### an accepted goal runs in any case
def on(msg):
    global busy
    busy = msg.data
def begin(handle):
    if busy:
        print("late")
    handle.execute()
def accept(goal):
    return rclpy.action.GoalResponse.ACCEPT
def run(handle):
    out.publish(1.0)  # clean
    return Go.Result()  # clean
rclpy.action.ActionServer(node, Go, "go", run, goal_callback=accept, handle_accepted_callback=begin)
node.create_subscription(Float64, "busy", on, 10)
### an accepted goal is kept, and executed later
class S:
    def __init__(self):
        self.goal = None
        rclpy.action.ActionServer(node, Go, "go", self.run, goal_callback=self.accept,
                                  handle_accepted_callback=self.keep)
        node.create_subscription(Float64, "start", self.on, 10)
    def accept(self, goal):
        return goal.target > 0.0
    def keep(self, handle):
        self.goal = handle
        out.publish(4.0)  # control
    def on(self, msg):
        if msg.data > 0.5 and self.goal is not None:
            self.goal.execute()
    def run(self, handle):
        out.publish(1.0)  # control
        return Go.Result()  # control
S()
### timers and threads read shared state
last = 0.0
def on(msg):
    global last
    last = msg.data
def work():
    while True:
        out.publish(last)  # data
        time.sleep(1.0)
class W(threading.Thread):
    def __init__(self, gain):
        threading.Thread.__init__(self)
        self.gain = gain
    def run(self):
        out.publish(last)  # data
        out.publish(self.gain)  # clean
rospy.Subscriber("in", Float64, on)
threading.Thread(target=work, daemon=True).start()
W(2.0).start()
node.create_timer(1.0, lambda: out.publish(last))  # data
### a thread gets its arguments
def work(near, far):
    out.publish(near)  # data
    out.publish(far)  # clean
def on(msg):
    threading.Thread(target=work, args=(msg.data, 1.0)).start()
    threading.Thread(target=work, kwargs={"near": 1.0, "far": 2.0}).start()
rospy.Subscriber("in", Float64, on)
### parameters and their defaults
gain = rospy.get_param("~gain", 1.0)
out.publish(gain)  # clean
out.publish(rospy.get_param("~table")["a"])  # clean
def on(msg):
    out.publish(gain * msg.data)  # data
    out.publish(rospy.get_param("~other", msg.data))  # data
    if rospy.get_param("~on", True):
        out.publish(1.0)  # clean
    rospy.set_param("~x", msg.data)
rospy.Subscriber("in", Float64, on)
### declared parameters of rclpy
node.declare_parameter("gain", 2.0)
node.declare_parameters("", [("a", 1.0), ("b", 2.0)])
def on(msg):
    out.publish(node.get_parameter("gain").value)  # clean
    out.publish(node.get_parameter("gain").get_parameter_value().double_value)  # clean
    out.publish(node.get_parameter("a").value * msg.data)  # data
    out.publish(node.get_parameter_or("c", 1.0))  # clean
    out.publish(node.has_parameter("gain"))  # clean
node.create_subscription(Float64, "in", on, 10)
### a synchroniser passes one message for each subscriber
def on(near, far):
    out.publish(near.data)  # data
    out.publish(far.header)  # data
near = message_filters.Subscriber("near", Float64)
subs = [near]
subs.append(message_filters.Subscriber("far", Float64))
message_filters.ApproximateTimeSynchronizer(subs, 10, 0.1).registerCallback(on)
### a filter of a filter
def on(msg):
    out.publish(msg.data)  # data
cache = message_filters.Cache(message_filters.Subscriber("in", Float64), 10)
cache.registerCallback(on)
def tick(event):
    out.publish(cache.getElemBeforeTime(rospy.Time.now()).data)  # data
    out.publish(cache.getInterval(rospy.Time(0), rospy.Time.now())[0].data)  # data
rospy.Timer(rospy.Duration(1.0), tick)
### a node of rclpy as a class
class N(rclpy.node.Node):
    def __init__(self):
        super().__init__("n")
        self.out = self.create_publisher(Float64, "o", 10)
        self.last = 0.0
        self.create_subscription(Float64, "in", self.on, 10)
        self.create_timer(0.1, self.tick)
    def on(self, msg):
        self.last = msg.data
        self.get_logger().info(str(msg.data))
    def tick(self):
        made = Float64()
        made.data = self.last
        self.out.publish(made)  # data
        made.data = 1.0
        self.out.publish(made)  # clean
rclpy.spin(N())
### a callback that stops listening
def on(msg):
    sub.unregister()
    out.publish(msg.data)  # data
sub = rospy.Subscriber("in", Float64, on)
### a message type that is a callback's only argument
def on(msg):
    out.publish(msg.header.stamp)  # data
    out.publish(len(msg.ranges))  # data
    out.publish(msg.ranges[0])  # data
    out.publish(min(msg.ranges))  # data
    out.publish([r for r in msg.ranges if r > 1.0])  # data
    out.publish(msg)  # data
rospy.Subscriber("in", LaserScan, on)
### times and names are no data of messages
def on(msg):
    out.publish(rospy.Time.now())  # clean
    out.publish(rospy.get_name())  # clean
    out.publish(time.time())  # clean
    out.publish(node.get_clock().now())  # clean
    out.publish((msg.header.stamp - rospy.Time.now()).to_sec())  # data
rospy.Subscriber("in", Float64, on)
### a coroutine as a callback
async def on(msg):
    value = await later(msg.data)
    out.publish(value)  # data
    out.publish(1.0)  # clean
async def later(value):
    await asyncio.sleep(1.0)
    return value
node.create_subscription(Float64, "in", on, 10)
### a state machine
class A(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["done"], output_keys=["x"])
        rospy.Subscriber("in", Float64, self.on)
        self.seen = 0.0
    def on(self, msg):
        self.seen = msg.data
    def execute(self, userdata):
        userdata.x = self.seen
        return "done"
class B(smach.State):
    def execute(self, userdata):
        out.publish(userdata.x)  # data
        out.publish(userdata.y)  # clean
        return "done"
machine = smach.StateMachine(outcomes=["done"])
with machine:
    smach.StateMachine.add("A", A(), transitions={"done": "B"})
    smach.StateMachine.add("B", B())
machine.execute()
"""
CASES = dict(one.split("\n", 1) for one in PROGRAMS.removeprefix("### ").split("\n### "))


@pytest.mark.parametrize("title", CASES)
def test_received_data_reaches_sent_messages_as_in_ros(title):
    assert differing(f"{HEAD}{CASES[title]}\nrospy.spin()\n") == {}
