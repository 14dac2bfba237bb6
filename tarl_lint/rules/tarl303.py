"""TARL303: a subscription requests a stricter quality of service than its publisher offers.

ROS 2 does not connect a `RELIABLE` subscription with a `BEST_EFFORT` publisher, nor a `TRANSIENT_LOCAL` subscription
with a `VOLATILE` publisher. No message arrives. For example, sensor drivers publish with `qos_profile_sensor_data`,
which is `BEST_EFFORT`. If the code of a subscription gives the number 10 instead of a profile, it is `RELIABLE` and
`VOLATILE`, and receives nothing from a laser scanner (https://github.com/ros2/ros2_documentation/issues/569).

The rule reports a connection only if both profiles are constant. A profile may come from another module, from a
function, or from a table of topics and profiles. In C++ programs of the workspace, the call that names the topic must
contain the profile or a variable with the profile. The rule ignores profiles that a launch file may override
(`qos_overriding_options`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tarl_lint.fingerprints import topic_text
from tarl_lint.model import Finding
from tarl_lint.system.hazards import at_end
from tarl_lint.system.model import Endpoint, System
from tarl_lint.workspace.conditions import exclusive

CODE: Final = "TARL303"
SUMMARY: Final = "a subscription requests a stricter quality of service than its publisher offers"

INVALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="scanner.py" name="scanner"/>
      <node pkg="robot" type="reader.py" name="reader"/>
    </launch>
    --- scripts/scanner.py
    import rclpy
    from rclpy.node import Node
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    class Scanner(Node):
        def __init__(self):
            super().__init__("scanner")
            self.pub = self.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
            self.create_timer(0.1, lambda: self.pub.publish(LaserScan()))

    if __name__ == "__main__":
        rclpy.init()
        rclpy.spin(Scanner())
    --- scripts/reader.py
    import rclpy
    from rclpy.node import Node
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    class Reader(Node):
        def __init__(self):
            super().__init__("reader")
            self.create_subscription(LaserScan, "scan", self.on_scan, 10)

        def on_scan(self, scan):
            print(min(scan.ranges))

    if __name__ == "__main__":
        rclpy.init()
        rclpy.spin(Reader())
    """,
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="mapper.py" name="mapper"/>
      <node pkg="robot" type="reader.py" name="reader"/>
    </launch>
    --- scripts/mapper.py
    import rclpy
    from nav_msgs.msg import OccupancyGrid
    from rclpy.node import Node

    class Mapper(Node):
        def __init__(self):
            super().__init__("mapper")
            self.pub = self.create_publisher(OccupancyGrid, "map", 1)
            self.create_timer(1.0, lambda: self.pub.publish(OccupancyGrid()))

    if __name__ == "__main__":
        rclpy.init()
        rclpy.spin(Mapper())
    --- scripts/reader.py
    import rclpy
    from nav_msgs.msg import OccupancyGrid
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile

    class Reader(Node):
        def __init__(self):
            super().__init__("reader")
            profile = QoSProfile(depth=1)
            profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
            self.create_subscription(OccupancyGrid, "map", self.on_map, profile)

        def on_map(self, grid):
            print(grid.info.width)

    if __name__ == "__main__":
        rclpy.init()
        rclpy.spin(Reader())
    """,
)

VALID: Final = (
    """
    --- launch/robot.launch
    <launch>
      <node pkg="robot" type="scanner.py" name="scanner"/>
      <node pkg="robot" type="reader.py" name="reader"/>
    </launch>
    --- scripts/scanner.py
    import rclpy
    from rclpy.node import Node
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    class Scanner(Node):
        def __init__(self):
            super().__init__("scanner")
            self.pub = self.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
            self.create_timer(0.1, lambda: self.pub.publish(LaserScan()))

    if __name__ == "__main__":
        rclpy.init()
        rclpy.spin(Scanner())
    --- scripts/reader.py
    import rclpy
    from rclpy.node import Node
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    class Reader(Node):
        def __init__(self):
            super().__init__("reader")
            self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)

        def on_scan(self, scan):
            print(min(scan.ranges))

    if __name__ == "__main__":
        rclpy.init()
        rclpy.spin(Reader())
    """,
)


def findings(system: System) -> Iterator[Finding]:
    """Yield a hazard for each subscription that ROS 2 does not connect with a publisher of its topic."""
    for name, who, end in system.named("subscribes"):
        for other, them, offered in system.named("publishes"):
            if other == name and not exclusive(who.node, them.node):
                for policies in _refused(offered, end):
                    message = (
                        f"{who.name} asks for {policies[0]} on {name}, but {them.name} offers {policies[1]}"
                    )
                    yield at_end(CODE, who, end, f"{message}: no message arrives", topic_text(end.in_code))


def _refused(offered: Endpoint, asked: Endpoint) -> Iterator[tuple[str, str]]:
    """Yield each policy that the subscription requests, with the weaker policy that the publisher offers."""
    if offered.qos is None or asked.qos is None:
        return
    if asked.qos.reliable is True and offered.qos.reliable is False:
        yield "RELIABLE", "BEST_EFFORT"
    if asked.qos.latched is True and offered.qos.latched is False:
        yield "TRANSIENT_LOCAL", "VOLATILE"
