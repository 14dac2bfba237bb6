"""moveit_commander: plans in joint space, executed as by MoveIt's fake controllers."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import message_type
from tests.plugin.ros.conftest import Start, heard

FAKE = "/move_group/fake_controller_joint_states"
LINKS = "".join(f'<link name="{name}"/>' for name in ("base", "upper", "lower", "hand"))
JOINT = """<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{x} 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="{speed}"/></joint>"""
URDF = (
    f'<robot name="planar">{LINKS}'
    + JOINT.format(name="shoulder", kind="revolute", parent="base", child="upper", x=0, speed=0.5)
    + JOINT.format(name="elbow", kind="revolute", parent="upper", child="lower", x=1, speed=1.0)
    + JOINT.format(name="wrist", kind="fixed", parent="lower", child="hand", x=1, speed=1.0)
    + "</robot>"
)
SRDF = """<robot name="planar">
  <virtual_joint name="anchor" type="fixed" parent_frame="world" child_link="base"/>
  <group name="arm"><chain base_link="base" tip_link="hand"/></group>
  <group name="fore"><joint name="elbow"/></group>
  <group_state name="folded" group="arm">
    <joint name="shoulder" value="1"/><joint name="elbow" value="-1.5"/>
  </group_state>
</robot>"""
DESCRIBED = {"robot_description": URDF, "robot_description_semantic": SRDF}
BEGIN = """
    import sys
    import moveit_commander, rospy
    from geometry_msgs.msg import Pose, PoseStamped
    from sensor_msgs.msg import JointState
    from moveit_commander.conversions import pose_to_list

    moveit_commander.roscpp_initialize(sys.argv)
    rospy.init_node("arm")
    robot = moveit_commander.RobotCommander()
    group = moveit_commander.MoveGroupCommander("arm")
    found = []
"""


def found(ros: Any) -> list[Any]:
    return ros.namespace["found"]  # type: ignore[no-any-return]


def run(start: Start, source: str, seconds: float = 20.0, **parameters: object) -> list[Any]:
    ros = start(BEGIN + source, parameters=parameters or DESCRIBED)
    ros.step(seconds)
    return found(ros)


def test_groups_and_links_come_from_descriptions(start: Start) -> None:
    assert run(
        start,
        """
    found += [robot.get_group_names(), robot.get_robot_name(), robot.get_planning_frame(), group.get_active_joints()]
    found += [group.get_end_effector_link(), robot.fore.get_joints(), group.get_named_targets()]
    found += [group.get_named_target_values("folded"), robot.get_default_owner_group("elbow")]
    """,
    ) == [["arm", "fore"], "planar", "base", ["shoulder", "elbow"], "hand", ["elbow"], ["folded"],
          {"shoulder": 1.0, "elbow": -1.5}, "fore"]  # fmt: skip


def test_motion_publishes_its_joint_states(start: Start) -> None:
    ros = start(
        BEGIN
        + """
    began = rospy.get_time()
    group.set_max_velocity_scaling_factor(0.5)
    found += [group.go([0.5, -0.5], wait=True), rospy.get_time() - began, group.get_current_joint_values()]
    """,
        parameters=DESCRIBED,
    )
    states = heard(ros, FAKE)
    ros.step(5.0)
    assert found(ros) == [True, pytest.approx(2.0), [0.5, -0.5]]  # 0.5 rad at 0.25 rad/s
    assert [one.position[0] for one in states[-3:]] == pytest.approx([0.45, 0.475, 0.5])
    assert any("obstacles and accelerations are not considered" in one for one in ros.notes)


def test_moveit_reads_the_present_joint_values_from_joint_states(start: Start) -> None:
    ros = start(
        BEGIN + "    rospy.sleep(1.0)\n    found.append(group.get_current_joint_values())",
        parameters=DESCRIBED,
    )
    state = message_type("sensor_msgs/JointState")(name=["elbow", "shoulder"], position=[0.2, 0.1])
    ros.bus.publish("/joint_states", state)
    ros.step(2.0)
    assert found(ros) == [[0.1, 0.2]]


def test_a_pose_is_reached_by_inverse_kinematics(start: Start) -> None:
    source = """
    group.set_joint_value_target({"shoulder": 0.4, "elbow": 0.7})
    group.go()
    goal = group.get_current_pose()
    group.go("folded")
    group.set_pose_target(goal)
    found += [group.go(), pose_to_list(group.get_current_pose().pose)[:2], group.get_current_rpy()[2]]
    goal.pose.position.x = 9.0
    group.set_pose_target(goal)
    succeeded, trajectory, seconds, code = group.plan()
    found += [succeeded, trajectory.joint_trajectory.points, code.val, group.go()]
    """
    x, y = math.cos(0.4) + math.cos(1.1), math.sin(0.4) + math.sin(1.1)
    assert run(start, source) == [
        True, pytest.approx([x, y], abs=1e-4), pytest.approx(1.1, abs=1e-2), False, [], -31, False,
    ]  # fmt: skip


def test_cartesian_path_ends_before_an_unreachable_point(start: Start) -> None:
    source = """
    group.go([0.8, -1.6])
    begin = group.get_current_pose().pose
    near, far = Pose(), Pose()
    group.set_joint_value_target([0.9, -1.8])
    for pose, x in ((near, begin.position.x - 0.1), (far, 9.0)):
        pose.position.x, pose.position.y, pose.orientation = x, begin.position.y, begin.orientation
    path, part = group.compute_cartesian_path([begin], 0.05, 0.0)
    found += [part, len(path.joint_trajectory.points)]
    path, part = group.compute_cartesian_path([far], 0.05, 0.0)
    found += [0 <= part < 1, group.execute(path)]
    """
    assert run(start, source, 30.0)[0] == 1.0
    assert run(start, source, 30.0)[2] is True


def test_background_motion_can_be_stopped(start: Start) -> None:
    source = """
    found.append(group.go([1.0, 0.0], wait=False))
    rospy.sleep(0.5)
    group.stop()
    rospy.sleep(5.0)
    found.append(group.get_current_joint_values()[0])
    """
    started, reached = run(start, source)
    assert started is True
    assert 0.2 <= reached <= 0.3  # 0.5 rad/s for 0.5 s


WRONG = {
    "too few values": "group.set_joint_value_target([1.0])",
    "beyond the limits": "group.set_joint_value_target([3.0, 0.0])",
    "unknown joint": "group.set_joint_value_target('knee', 1.0)",
    "unknown state": "group.set_named_target('nowhere')",
    "unknown group": "robot.get_group('leg')",
    "scale": "group.set_max_velocity_scaling_factor(2.0)",
    "list": "moveit_commander.conversions.list_to_pose([1, 2])",
}


@pytest.mark.parametrize("line", WRONG.values(), ids=WRONG)
def test_wrong_arguments_are_refused(line: str, start: Start) -> None:
    with pytest.raises(NodeError, match="MoveItCommanderException"):
        run(start, f"    {line}")


def test_unknown_groups_and_missing_functions_are_named(start: Start) -> None:
    with pytest.raises(NodeError, match="RuntimeError: Group 'leg' was not found"):
        run(start, "    moveit_commander.MoveGroupCommander('leg')")
    with pytest.raises(Exception, match=r"MoveGroupCommander\.pick is not in the in-process ROS"):
        run(start, "    group.pick('cup')")
    with pytest.raises(Exception, match=r"PlanningSceneInterface\.add_mesh is not in the in-process ROS"):
        run(start, "    moveit_commander.PlanningSceneInterface().add_mesh('cup', None, 'cup.stl')")


def test_without_descriptions_every_plan_fails_with_a_note(start: Start) -> None:
    source = """
    group.set_pose_target([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]) if group.has_end_effector_link() else None
    found += [group.go(), group.get_active_joints(), robot.get_group_names()]
    """
    ros = start(BEGIN + source)
    ros.step(1.0)
    assert found(ros) == [False, [], []]
    assert any("robot_description and robot_description_semantic are not set" in one for one in ros.notes)
    for line in ("group.get_current_pose()", "group.set_joint_value_target([1.0])"):
        with pytest.raises(
            NodeError, match="robot_description_semantic are not set: pass the texts of the URDF"
        ):
            start(f"{BEGIN}    {line}")


def test_objects_are_remembered_and_published(start: Start) -> None:
    ros = start(
        BEGIN
        + """
    scene = moveit_commander.PlanningSceneInterface()
    rospy.sleep(0.1)
    pose = PoseStamped()
    pose.header.frame_id = "base"
    scene.add_box("table", pose, (1, 2, 0.1))
    scene.add_sphere("ball", pose, 0.2)
    scene.attach_box("hand", "ball")
    found += [scene.get_known_object_names(), list(scene.get_attached_objects())]
    scene.remove_attached_object("hand", "ball")
    scene.remove_world_object("table")
    found.append(scene.get_known_object_names())
    """,
        parameters=DESCRIBED,
    )
    scenes = heard(ros, "/planning_scene")
    ros.step(1.0)
    assert found(ros) == [["table"], ["ball"], ["ball"]]
    first = scenes[0].world.collision_objects[0]
    assert (first.id, tuple(first.primitives[0].dimensions)) == ("table", (1.0, 2.0, 0.1))
    assert (len(scenes), scenes[-1].world.collision_objects[0].operation) == (5, 1)
