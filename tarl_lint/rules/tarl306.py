"""TARL306: a loop continues to publish commands after its messages stop.

A callback stores what it receives, and a loop or timer repeatedly computes a command from the stored value and
publishes it. If the messages stop because a sensor hangs, a cable breaks or a node crashes, the robot continues with
the last command. For this reason, a Pioneer robot collided with expensive equipment
(https://github.com/amor-ros-pkg/rosaria/pull/51). Store the time of the last message, and stop the robot when the
message is too old.

The rule covers the commands of TARL305, such as velocities, trajectories, and numbers on topics such as
`blade_controller/command`. The timer or loop may publish the commands directly or through functions, and the callback
may store the data in attributes, globals or tables.

The rule reports nothing if the program may detect old messages, which it assumes in these cases:

- The code of the loop or timer reads the time (sleeping and reading the stamps of messages do not count).
- The code of the loop or timer contains a word such as `timeout`, `last_` or `counter`.
- A word such as `watchdog` or `deadline` occurs anywhere in the program.
- The stored value is set to `None`, or the loop or timer resets or changes it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Finding
from tarl_lint.system.model import System

CODE: Final = "TARL306"
SUMMARY: Final = "a loop continues to publish commands after its messages stop"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="follower.py" name="follower"/>
    </launch>
    --- scripts/follower.py
    import rospy
    from geometry_msgs.msg import PointStamped, Twist

    class Follower:
        def __init__(self):
            self.offset = 0.0
            self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("person", PointStamped, self.on_person)

        def on_person(self, person):
            self.offset = person.point.y

        def run(self):
            rate = rospy.Rate(10)
            while not rospy.is_shutdown():
                cmd = Twist()
                cmd.linear.x = 0.3
                cmd.angular.z = self.offset
                self.pub.publish(cmd)
                rate.sleep()

    rospy.init_node("follower")
    Follower().run()
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="follower.py" name="follower"/>
    </launch>
    --- scripts/follower.py
    import rospy
    from geometry_msgs.msg import PointStamped, Twist

    class Follower:
        def __init__(self):
            self.offset = 0.0
            self.seen = 0.0
            self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("person", PointStamped, self.on_person)

        def on_person(self, person):
            self.offset = person.point.y
            self.seen = rospy.get_time()

        def run(self):
            rate = rospy.Rate(10)
            while not rospy.is_shutdown():
                cmd = Twist()
                if rospy.get_time() - self.seen < 0.5:
                    cmd.linear.x = 0.3
                    cmd.angular.z = self.offset
                self.pub.publish(cmd)
                rate.sleep()

    rospy.init_node("follower")
    Follower().run()
    """,
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="follower.py" name="follower"/>
    </launch>
    --- scripts/follower.py
    import rospy
    from geometry_msgs.msg import PointStamped, Twist

    class Follower:
        def __init__(self):
            self.offset = 0.0
            self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("person", PointStamped, self.on_person)

        def on_person(self, person):
            self.offset = person.point.y

        def run(self):
            rate = rospy.Rate(10)
            while not rospy.is_shutdown():
                cmd = Twist()
                cmd.linear.x = self.offset
                self.offset = 0.0
                self.pub.publish(cmd)
                rate.sleep()

    rospy.init_node("follower")
    Follower().run()
    """,
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each command that is computed from the last message and published repeatedly."""
    for instance in system.instances:
        for finding in instance.interface.stale if instance.interface is not None else ():
            flow = finding.flow
            if flow is None or not (flow.source.topics and flow.sink.topics):
                continue
            source, sink = (", ".join(map(instance.resolve, end.topics)) for end in (flow.source, flow.sink))
            message = f"{instance.name} continues to publish {sink} ({flow.sink.type}) after {source} stops"
            about = f"{topic_text(flow.sink.topics)} after {topic_text(flow.source.topics)}"
            package = instance.interface.package if instance.interface is not None else ""
            yield Finding(
                CODE, flow.sink.span, message, about=about, place=flow.sink.qualname, package=package
            )
