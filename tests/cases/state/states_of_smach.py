"""The states of a smach machine pass data on through userdata, in which each state uses its own names."""

import rospy
import smach
from geometry_msgs.msg import Pose, PoseStamped, Twist
from std_msgs.msg import Bool, Int32, String

goal = rospy.Publisher("goal", PoseStamped, queue_size=1)
text = rospy.Publisher("text", String, queue_size=1)
count = rospy.Publisher("count", Int32, queue_size=1)
flag = rospy.Publisher("flag", Bool, queue_size=1)
cmd = rospy.Publisher("cmd", Twist, queue_size=1)


class Search(smach.State):
    def __init__(self):
        smach.State.__init__(self, outcomes=["found"], output_keys=["victim", "turns"])
        self.victim = None
        rospy.Subscriber("victim", PoseStamped, self.on_victim)  # source victim

    def on_victim(self, msg):
        self.victim = msg

    def execute(self, userdata):
        text.publish("searching")  # clean
        while self.victim is None:
            rospy.sleep(0.1)
        userdata.victim = self.victim.pose
        userdata.turns = 1
        return "found"


class Approach(smach.State):
    def __init__(self):
        super().__init__(outcomes=["done"], input_keys=["where", "n", "speed"], io_keys=["n"])

    def execute(self, ud):
        stamped = PoseStamped()
        stamped.pose = ud.where
        goal.publish(stamped)  # sink victim
        stamped.pose = Pose()
        goal.publish(stamped)  # clean
        ud.n += 1
        count.publish(ud.n)  # clean
        twist = Twist()
        twist.linear.x = ud.speed
        cmd.publish(twist)  # clean
        return "done"


class Tell(smach.State):
    def execute(self, userdata):
        if userdata.found.position.x > 3.0:
            flag.publish(True)  # sink ~victim
        count.publish(userdata.rounds)  # clean
        return "told"


@smach.cb_interface(input_keys=["found"], outcomes=["ok"])
def report(userdata, prefix="at"):
    text.publish(prefix + str(userdata.found.position.x))  # sink victim
    text.publish(prefix)  # clean
    return "ok"


def main():
    rospy.init_node("rescue")
    machine = smach.StateMachine(outcomes=["finished"])
    machine.userdata.speed = 0.5
    with machine:
        smach.StateMachine.add(
            "SEARCH",
            Search(),
            transitions={"found": "APPROACH"},
            remapping={"victim": "found", "turns": "rounds"},
        )
        smach.StateMachine.add(
            "APPROACH", Approach(), {"done": "TELL"}, remapping={"where": "found", "n": "rounds"}
        )
        smach.StateMachine.add("TELL", Tell(outcomes=["told"]), {"told": "REPORT"})
        smach.StateMachine.add("REPORT", smach.CBState(report), {"ok": "finished"})
    machine.execute()


if __name__ == "__main__":
    main()
