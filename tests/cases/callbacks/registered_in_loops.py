import rospy
from std_msgs.msg import Float64

DRONES = ["alpha", "beta"]


class Drone:
    def __init__(self, name, swarm):
        self.name = name
        self.swarm = swarm
        self.height = 0.0
        self.limit = 10.0
        self.sub = rospy.Subscriber(f"{name}/height", Float64, self.on_height)  # source height
        self.pub = rospy.Publisher(f"{name}/cmd", Float64, queue_size=1)

    def on_height(self, msg):
        self.height = msg.data

    def command(self, target):
        self.pub.publish(target - self.height)  # sink height
        self.pub.publish(self.limit)  # clean


class Swarm:
    def __init__(self):
        self.drones = []
        for name in DRONES:
            self.drones.append(Drone(name, self))
        self.subs = [rospy.Subscriber(n + "/speed", Float64, self.on_speed) for n in DRONES]  # source speed
        self.speed = 0.0

    def on_speed(self, msg):
        self.speed = msg.data

    def step(self):
        for drone in self.drones:
            drone.command(5.0)
            drone.pub.publish(self.speed)  # sink speed


rospy.init_node("swarm")
swarm = Swarm()
while not rospy.is_shutdown():
    swarm.step()
    rospy.sleep(0.1)
