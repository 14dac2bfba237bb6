"""TARL201: state is shared between threads without the lock that guards it elsewhere.

In rospy, every subscriber, timer and service runs its callbacks in a separate thread, alongside the main loop. In
rclpy, callbacks run in several threads only if the node starts threads itself, or if it uses a MultiThreadedExecutor
with callback groups that allow parallel calls. If one thread accesses an attribute or global under a lock, and another
thread changes or reads it without the lock, the other thread may see a partial change, or a change may be lost.

The rule reports an access only if other code guards the same state with a lock, and only if the access can go wrong:

- One thread changes a container while another thread reads the container.
- A value is incremented or changed in place.
- A function reads the state twice and may see two different values.
- A function reads several values that belong together.

Reading a value once is harmless if threads only replace the value as a whole, because Python does this atomically. The
rule does not report

- such reads, and flags that are set to constants,
- checks before the lock is taken, for example whether a value exists or how long it is,
- methods of objects that may do their own locking,
- state under a lock that is taken only if it is free (`acquire(blocking=False)`), because such a lock only prevents two
  runs of the same code at once,
- coroutines that an event loop runs later,
- code that runs before the threads start,
- callbacks that are registered in opposite branches of an `if`, so that only one of them ever runs.

If one caller of a function has the lock and another does not, the message names the call without the lock.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from tarl_lint.evidence import Evidence
from tarl_lint.model import Finding
from tarl_lint.prefilter.one_sided_groups import Side
from tarl_lint.rules.races.alternatives import never_both
from tarl_lint.rules.races.guarded_names import always_or_never_guarded
from tarl_lint.rules.races.locksets import MADE, Harm, Locking, Use, unguarded

CODE: Final = "TARL201"
SUMMARY: Final = "state is shared between threads without the lock that guards it elsewhere"

INVALID: Final = (
    """
    import threading
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    class Keeper:
        def __init__(self):
            self.lock = threading.Lock()
            self.pose = None
            self.pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("/odom", Odometry, self.on_odom)

        def on_odom(self, msg):
            with self.lock:
                self.pose = msg.pose.pose

        def run(self):
            while not rospy.is_shutdown():
                cmd = Twist()
                cmd.linear.x = max(-1.0, min(1.0, -self.pose.position.x))
                cmd.angular.z = max(-1.0, min(1.0, -self.pose.position.y))
                self.pub.publish(cmd)

    Keeper().run()
    """,
)

VALID: Final = (
    """
    import threading
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    class Keeper:
        def __init__(self):
            self.lock = threading.Lock()
            self.pose = None
            self.pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("/odom", Odometry, self.on_odom)

        def on_odom(self, msg):
            with self.lock:
                self.pose = msg.pose.pose

        def run(self):
            while not rospy.is_shutdown():
                with self.lock:
                    y = self.pose.position.y
                cmd = Twist()
                cmd.angular.z = max(-1.0, min(1.0, -y))
                self.pub.publish(cmd)

    Keeper().run()
    """,
    """
    import threading
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    class Keeper:
        def __init__(self):
            self.lock = threading.Lock()
            self.pose = None
            self.pub = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
            rospy.Subscriber("/odom", Odometry, self.on_odom)

        def on_odom(self, msg):
            with self.lock:
                self.pose = msg.pose.pose

        def run(self):
            while not rospy.is_shutdown():
                pose = self.pose
                cmd = Twist()
                cmd.angular.z = max(-1.0, min(1.0, -pose.position.y))
                self.pub.publish(cmd)

    Keeper().run()
    """,
    """
    import threading
    import rclpy
    from nav_msgs.msg import Odometry
    from rclpy.node import Node
    from std_msgs.msg import Float64

    class Keeper(Node):
        def __init__(self):
            super().__init__("keeper")
            self.lock = threading.Lock()
            self.y = 0.0
            self.pub = self.create_publisher(Float64, "y", 1)
            self.create_subscription(Odometry, "odom", self.on_odom, 10)
            self.create_timer(0.1, self.on_timer)

        def on_odom(self, msg):
            with self.lock:
                self.y = msg.pose.pose.position.y

        def on_timer(self):
            self.pub.publish(Float64(data=self.y))

    rclpy.init()
    rclpy.spin(Keeper())
    """,
)


def ruled_out(side: Side) -> bool:
    """Return whether the group certainly has no state that is guarded in only some places.

    This is so if the group creates no lock. It is also so if each state is guarded at all of its uses, or at none.
    """
    return not any(map(MADE.search, side.texts)) or always_or_never_guarded(side.modules)


def findings(evidence: Evidence) -> Iterator[Finding]:
    """Yield a hazard for each function that uses shared state without its lock while another thread uses it."""
    every = Locking(evidence).uses()
    harm = Harm(every)
    for state, uses in every.items():
        written = [u for u in uses if u.writes]
        if not written or all(u.constant for u in written):
            continue
        told: set[tuple[str, str]] = set()
        for use, spot in sorted(unguarded(uses), key=lambda found: (found[1].path, found[1].pos)):
            others = [u for u in uses if u.guards and not never_both(evidence, use.thread, u.thread)]
            other = _conflict(use, [u for u in others if harm.between(state, use, u)])
            if other is None or (spot.path, spot.function) in told:
                continue
            told.add((spot.path, spot.function))
            about = f"{use.name} {_done(use)}"
            yield evidence.finding(CODE, evidence.span(spot.path, spot.pos), _message(use, other), about)


def _conflict(use: Use, uses: Sequence[Use]) -> Use | None:
    """Return an access in another thread that holds a lock, if one of the two accesses writes."""
    others = (u for u in uses if u.thread != use.thread and (u.writes or use.writes))
    return min(others, key=lambda u: (not u.writes, u.spots[0].path, u.spots[0].pos), default=None)


def _message(use: Use, other: Use) -> str:
    lock, doing = min(other.guards), "writing" if other.writes else "reading"
    there = f"{other.spots[0].function} holds in another thread when {doing} {use.name}"
    return f"{use.name} is {_done(use)} without {lock}, which {there}"


def _done(use: Use) -> str:
    return "written" if use.writes else "read"
