"""Python scripts that start nodes with the `roslaunch` API or with a `LaunchService`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.workspace.launch_model import Launch
from tests.lint.workspace.launching import launched, names, reasons, settings


def script(package: Path, text: str) -> Launch:
    return launched(package, text, "start.py")


def test_a_roslaunch_parent_starts_launch_files_with_arguments(package):
    found = script(
        package,
        """
        import rospkg
        import rospy
        import roslaunch

        def main():
            rospy.init_node("start")
            uuid = roslaunch.rlutil.get_or_generate_uuid(None, False)
            roslaunch.configure_logging(uuid)
            folder = rospkg.RosPack().get_path("arm")
            first = roslaunch.parent.ROSLaunchParent(uuid, [folder + "/part.launch"])
            first.start()
            resolved = roslaunch.rlutil.resolve_launch_arguments(["arm", "part.launch"])[0]
            second = roslaunch.parent.ROSLaunchParent(uuid, roslaunch_files=[(resolved, ["rate:=8", "x:=1"])])
            second.start()
            first.spin()

        if __name__ == "__main__":
            main()
        """,
    )
    assert names(found) == ["/part_5", "/part_8"]
    assert {one.file.name for one in found.nodes} == {"part.launch"}
    assert not reasons(found)
    assert not found.ros2


def test_script_nodes_started_through_the_core_api_are_found(package):
    found = script(
        package,
        """
        from roslaunch import scriptapi
        from roslaunch.core import Node
        import roslaunch

        class Starter:
            def __init__(self, arms):
                self.launch = scriptapi.ROSLaunch()
                self.launch.start()
                for arm in arms:
                    node = Node("arm", "drive.py", name="drive_" + arm, namespace=arm, args="--fast in:=/scan _kp:=2",
                                remap_args=[("out", "/cmd_vel")], output="screen")
                    self.running = self.launch.launch(node)
                self.launch.load("part.launch")

        Starter(["left", "right"])
        roslaunch.core.Node("arm", "watch.py")
        """,
    )
    assert names(found) == ["/left/drive_left", "/right/drive_right", "/part_5", "/watch"]
    left, *_, watch = found.nodes
    assert (left.package, left.executable, left.line) == ("arm", "drive.py", 11)
    assert left.remaps == (("in", "/scan"), ("out", "/cmd_vel"))
    assert settings(left) == {"~kp": "2"}
    assert watch.anonymous
    assert not left.anonymous


def test_conditions_and_unknown_files_of_a_script_are_stated(package):
    found = script(
        package,
        """
        import sys
        import rospy
        import roslaunch
        if rospy.get_param("/simulated"):
            roslaunch.parent.ROSLaunchParent("x", ["part.launch"])
        else:
            roslaunch.core.Node("arm", "drive.py", "drive")
        roslaunch.parent.ROSLaunchParent("x", [sys.argv[1]])
        roslaunch.parent.ROSLaunchParent("x", sys.argv[1:])
        roslaunch.parent.ROSLaunchParent("x", ["absent.launch"])
        roslaunch.parent.ROSLaunchParent("x", roslaunch.rlutil.resolve_launch_arguments(["other", "a.launch"]))
        """,
    )
    assert [(one.name, one.condition) for one in found.nodes] == [
        ("part_5", "rospy.get_param('/simulated')"),
        ("drive", "not rospy.get_param('/simulated')"),
    ]
    assert reasons(found)[1:] == [
        "the launch file $(sys.argv[1]) is known on the robot only",
        "the launch files $(sys.argv[1:]) are known on the robot only",
        "the launch file absent.launch does not exist",
        "the launch file $(find other/a.launch) is known on the robot only",
    ]


def test_a_script_that_starts_nothing_is_reported_as_such(package):
    assert reasons(
        script(package, "import roslaunch\ndef later():\n    roslaunch.core.Node('a', 'b')\n")
    ) == ["it starts no launch file or node that can be followed"]


@pytest.mark.parametrize(
    "included", ["describe()", "LaunchDescription([node])", "[LaunchDescription([node])][0]"]
)
def test_launch_service_descriptions_are_the_launch_file(package, included):
    found = script(
        package,
        f"""
        import sys
        from launch import LaunchDescription, LaunchService
        from launch_ros.actions import Node

        node = Node(package="arm", executable="drive", name="drive", remappings=[("a", "b")])

        def describe():
            return LaunchDescription([node])

        def main(argv=sys.argv[1:]):
            service = LaunchService(argv=argv)
            service.include_launch_description({included})
            return service.run()

        if __name__ == "__main__":
            sys.exit(main())
        """,
    )
    assert names(found) == ["/drive"]
    assert found.nodes[0].remaps == (("a", "b"),)
    assert found.ros2
    assert not reasons(found)


def test_runnable_launch_file_starts_its_nodes_once(package):
    found = script(
        package,
        """
        from launch import LaunchDescription, LaunchService
        from launch_ros.actions import Node
        def generate_launch_description():
            return LaunchDescription([Node(package="arm", executable="drive", name="drive")])
        service = LaunchService()
        service.include_launch_description(generate_launch_description())
        service.run()
        """,
    )
    assert names(found) == ["/drive"]
