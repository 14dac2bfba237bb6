import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Float64, Int32, String


class Marks:
    def __init__(self):
        self.ids = set()
        self.fixed = {1, 2, 3}
        self.goal = (0.0, 0.0, 1.0)
        self.home = (0.0, 0.0)
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        self.names = rospy.Publisher("names", String, queue_size=1)
        rospy.Subscriber("id", Int32, self.on_id)  # source id
        rospy.Subscriber("goal", Point, self.on_goal)  # source goal
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_id(self, msg):
        self.ids.add(msg.data)
        self.fixed.discard(2)

    def on_goal(self, msg):
        self.goal = (msg.x, msg.y, 2.0)

    def tick(self, event):
        for number in self.ids:
            self.pub.publish(number)  # sink id
        self.names.publish(str(self.ids | self.fixed))  # sink id
        self.pub.publish(max(self.fixed))  # clean
        x, y, height = self.goal
        self.pub.publish(x)  # sink goal
        self.pub.publish(height)  # clean
        self.pub.publish(self.goal[1])  # sink goal
        self.pub.publish(self.home[1])  # clean
        (x, y), z = self.home, self.goal[0]
        self.pub.publish(x)  # clean
        self.pub.publish(z)  # sink goal


rospy.init_node("marks")
Marks()
rospy.spin()
