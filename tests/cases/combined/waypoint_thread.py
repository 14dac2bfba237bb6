import queue
import threading
import math
import rospy
from geometry_msgs.msg import PoseStamped, Twist, PoseWithCovarianceStamped
from nav_msgs.msg import Path
from std_msgs.msg import Empty, Int32


class Navigator(threading.Thread):
    def __init__(self):
        super(Navigator, self).__init__(daemon=True)
        self.goals = queue.Queue()
        self.cancel = threading.Event()
        self.pose = None
        self.lock = threading.RLock()
        self.pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        self.left = rospy.Publisher("/goals_left", Int32, queue_size=1)
        self.done = rospy.Publisher("/done", Empty, queue_size=1)
        rospy.Subscriber("/plan", Path, self.on_plan)  # source plan
        rospy.Subscriber("/amcl_pose", PoseWithCovarianceStamped, self.on_pose)  # source pose
        rospy.Subscriber("/cancel", Empty, lambda _: self.cancel.set())  # source cancel

    def on_plan(self, path):
        for stamped in path.poses:  # step plan
            self.goals.put((stamped.pose.position.x, stamped.pose.position.y))  # step plan
        self.left.publish(self.goals.qsize())  # sink plan

    def on_pose(self, msg):
        with self.lock:
            self.pose = msg.pose.pose  # step pose

    def snapshot(self):
        with self.lock:
            return None if self.pose is None else (self.pose.position.x, self.pose.position.y)  # step pose

    def run(self):
        while not rospy.is_shutdown():
            try:
                gx, gy = self.goals.get(timeout=0.1)  # step plan
            except queue.Empty:
                continue
            self.cancel.clear()
            self.drive(gx, gy)  # step plan
            self.done.publish()  # sink ~plan

    def drive(self, gx, gy):
        rate = rospy.Rate(20)
        while not self.cancel.is_set() and not rospy.is_shutdown():
            here = self.snapshot()  # step pose
            if here is None:
                rate.sleep()
                continue
            dx, dy = gx - here[0], gy - here[1]  # step plan pose
            if math.hypot(dx, dy) < 0.1:  # step ~plan ~pose
                break
            out = Twist()
            out.linear.x = 0.5 * dx  # step plan pose
            out.angular.z = math.atan2(dy, dx)  # step plan pose
            self.pub.publish(out)  # sink plan pose
            rate.sleep()
        self.pub.publish(Twist())  # sink ~plan


rospy.init_node("nav")
rospy.Publisher("/ready", Empty, queue_size=1).publish()  # clean
Navigator().start()
rospy.spin()
