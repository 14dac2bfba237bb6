"""The robot model and the motions of moveit_commander, worked out by hand for a planar arm."""

from __future__ import annotations

from math import cos, sin
from typing import Any

import pytest

from pytest_tarl.ros.kdl import Frame, Rotation, Vector
from pytest_tarl.ros.moveit_commander import move_group
from pytest_tarl.ros.moveit_commander.conversions import (
    list_to_pose,
    list_to_transform,
    pose_to_list,
    rpy_of,
    transform_to_list,
)
from pytest_tarl.ros.moveit_commander.exception import MoveItCommanderException
from pytest_tarl.ros.moveit_commander.motion import straight
from pytest_tarl.ros.moveit_commander.robot_model import RobotModel, described
from pytest_tarl.ros.moveit_commander.targets import along
from tests.plugin.ros.conftest import Start
from tests.plugin.ros.test_moveit_commander import SRDF, URDF, run

ARM = RobotModel(URDF, SRDF)
AT_REST = {"shoulder": 0.0, "elbow": 0.0}


def semantic(text: str, urdf: str = URDF) -> RobotModel:
    return RobotModel(urdf, f'<robot name="planar">{text}</robot>')


# the model


def test_link_pose_follows_from_earlier_joints() -> None:
    state = {"shoulder": 0.4, "elbow": 0.7}
    hand = ARM.pose("hand", state)
    assert [*hand.p] == pytest.approx([cos(0.4) + cos(1.1), sin(0.4) + sin(1.1), 0.0])
    assert Rotation.RotZ(1.1) == hand.M
    lower = ARM.pose("lower", state)
    assert [*lower.p] == pytest.approx([cos(0.4), sin(0.4), 0.0])
    assert ARM.pose("base", state) == Frame()
    assert [*ARM.pose("hand", {"elbow": 0.7}).p] == pytest.approx([1 + cos(0.7), sin(0.7), 0.0])
    with pytest.raises(KeyError, match="leg"):
        ARM.pose("leg", state)


def test_the_moving_joints_of_the_robot_exclude_fixed_joints() -> None:
    assert ARM.joints == ("shoulder", "elbow")
    assert ARM.root == "base"


def test_limits_are_inclusive_up_to_rounding() -> None:
    assert ARM.bounds("elbow") == (-2.0, 2.0)
    for value, allowed in (
        (2.0, True),
        (2.0000005, True),
        (2.00001, False),
        (-2.0000005, True),
        (-2.1, False),
    ):
        assert ARM.allowed({"elbow": value, "shoulder": 0.0}) is allowed
    assert ARM.allowed({})


def joint(name: str, kind: str, more: str = "") -> str:
    return (
        f'<robot name="r"><link name="base"/><link name="tip"/><joint name="{name}" type="{kind}">'
        f'<parent link="base"/><child link="tip"/>{more}</joint></robot>'
    )


def test_joint_without_limits_is_unbounded() -> None:
    limit = '<limit lower="-1" upper="1" effort="1" velocity="{}"/>'
    turning = semantic("", joint("j", "continuous", limit.format(3)))
    assert (turning.bounds("j"), turning.speed("j")) == (None, 3.0)
    assert turning.allowed({"j": 99.0})
    still = semantic("", joint("j", "prismatic", limit.format(0)))
    assert (still.bounds("j"), still.speed("j")) == ((-1.0, 1.0), 1.0)
    bare = semantic("", joint("j", "continuous"))
    assert (bare.bounds("j"), bare.speed("j")) == (None, 1.0)
    assert ARM.speed("shoulder") == 0.5


def test_mimicking_joint_does_not_move_alone() -> None:
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    assert semantic("", joint("j", "revolute", limit)).joints == ("j",)
    assert semantic("", joint("j", "revolute", f'{limit}<mimic joint="other"/>')).joints == ()
    assert semantic("", joint("j", "floating")).joints == ()


@pytest.mark.parametrize(
    ("text", "frame"),
    [
        ("", "base"),
        ('<virtual_joint name="v" type="fixed" parent_frame="world" child_link="base"/>', "base"),
        ('<virtual_joint name="v" type="planar" parent_frame="odom" child_link="base"/>', "odom"),
        ('<virtual_joint name="v" type="floating" child_link="base"/>', "base"),
    ],
)
def test_planning_frame_is_the_virtual_joint_frame_or_the_root(text: str, frame: str) -> None:
    assert semantic(text).planning_frame == frame


def test_chain_group_has_the_joints_of_its_chain() -> None:
    arm = ARM.groups["arm"]
    assert (arm.joints, arm.tip) == (("shoulder", "elbow"), "hand")
    assert arm.links[-1] == "hand"
    assert arm.states == {"folded": {"shoulder": 1.0, "elbow": -1.5}}
    fore = ARM.groups["fore"]
    assert (fore.joints, fore.links, fore.tip, fore.states) == (("elbow",), ("lower",), "lower", {})


def test_group_consists_of_links_joints_and_groups() -> None:
    model = semantic(
        '<group name="links"><link name="upper"/><link name="base"/></group>'
        '<group name="both"><group name="links"/><joint name="elbow"/><joint name="wrist"/></group>'
        '<group name="loop"><group name="loop"/><joint name="elbow"/></group>'
        '<group name="empty"/>'
    )
    links, both = model.groups["links"], model.groups["both"]
    assert (links.joints, links.links) == (("shoulder",), ("upper", "base"))
    assert both.joints == ("shoulder", "elbow")
    assert set(both.links) == {"upper", "base", "lower", "hand"}
    assert model.groups["loop"].joints == ("elbow",)
    assert (model.groups["empty"].joints, model.groups["empty"].tip) == ((), "")


def test_an_end_effector_of_the_group_is_its_tip() -> None:
    group = '<group name="arm"><chain base_link="base" tip_link="hand"/></group>'
    effector = '<end_effector name="e" parent_link="{}" group="g" {}/>'
    assert semantic(group + effector.format("lower", "")).groups["arm"].tip == "lower"
    assert semantic(group + effector.format("lower", 'parent_group="arm"')).groups["arm"].tip == "lower"
    assert semantic(group + effector.format("lower", 'parent_group="leg"')).groups["arm"].tip == "hand"
    assert semantic(group + effector.format("foot", "")).groups["arm"].tip == "hand"


def test_group_joints_reach_a_pose_within_limits() -> None:
    arm, fore = ARM.groups["arm"], ARM.groups["fore"]
    wanted = {"shoulder": 0.4, "elbow": 0.7}
    found = ARM.reached(arm, "hand", ARM.pose("hand", wanted), {"shoulder": 0.3, "elbow": 0.6})
    assert found == pytest.approx(wanted, abs=1e-3)
    assert ARM.reached(arm, "hand", Frame(Vector(9, 0, 0)), AT_REST) is None
    beyond = ARM.pose("hand", {"shoulder": 2.5, "elbow": 0.0})
    assert ARM.reached(arm, "hand", beyond, {"shoulder": 1.9, "elbow": 0.1}) is None
    near = ARM.pose("hand", {"shoulder": 0.4, "elbow": 0.2})
    assert ARM.reached(fore, "hand", near, {"shoulder": 0.4, "elbow": 0.1}) == pytest.approx(
        {"elbow": 0.2}, abs=1e-3
    )
    assert ARM.reached(fore, "hand", near, {"shoulder": 0.0, "elbow": 0.1}) is None


def test_joint_search_starts_inside_the_range() -> None:
    assert ARM._between(["elbow"], 0.25) == {"elbow": -1.0}
    assert ARM._between(["elbow"], 0.75) == {"elbow": 1.0}
    assert semantic("", joint("j", "continuous"))._between(["j"], 0.5) == {"j": 0.0}
    assert semantic("", joint("j", "continuous"))._between(["j"], 0.75) == {"j": 1.5}


def test_a_robot_needs_both_of_its_descriptions() -> None:
    assert described({"r": URDF}, "r") is None
    assert described({"r_semantic": SRDF}, "r") is None
    assert described({"r": URDF, "r_semantic": SRDF, "other": ""}, "other") is None
    found = described({"r": URDF, "r_semantic": SRDF}, "r")
    assert found is not None
    assert found.joints == ("shoulder", "elbow")


# motions


def test_straight_motion_takes_as_long_as_its_slowest_joint() -> None:
    found = straight(ARM, AT_REST, [{"shoulder": 0.1, "elbow": -0.05}], 1.0)
    assert (found.joint_names, found.header.frame_id) == (["shoulder", "elbow"], "base")
    assert [one.time_from_start.to_sec() for one in found.points] == pytest.approx([0.0, 0.1, 0.2])
    assert [one.positions for one in found.points] == [
        [0.0, 0.0],
        [pytest.approx(0.05), pytest.approx(-0.025)],
        [0.1, -0.05],
    ]
    assert [one.velocities for one in found.points] == [
        [0.0, 0.0],
        [pytest.approx(0.5), pytest.approx(-0.25)],
        [0.0, 0.0],
    ]
    assert {tuple(one.accelerations) for one in found.points} == {(0.0, 0.0)}


def test_slower_motion_takes_longer() -> None:
    found = straight(ARM, AT_REST, [{"shoulder": 0.1, "elbow": 0.0}], 0.5)
    assert found.points[-1].time_from_start.to_sec() == pytest.approx(0.4)
    assert len(found.points) == 5


def test_the_parts_of_a_motion_follow_each_other() -> None:
    found = straight(ARM, AT_REST, [{"elbow": 0.15}, {"elbow": 0.15}, {"elbow": 0.05}], 1.0)
    assert [one.time_from_start.to_sec() for one in found.points] == pytest.approx(
        [*[0.0, 0.075, 0.15, 0.2, 0.25][:3], 0.25]
    )
    assert [one.positions[0] for one in found.points] == pytest.approx([0.0, 0.075, 0.15, 0.05])
    assert [one.velocities[0] for one in found.points] == pytest.approx([0.0, 1.0, 1.0, 0.0])


def test_a_motion_to_the_present_values_has_one_point() -> None:
    found = straight(ARM, AT_REST, [dict(AT_REST)], 1.0)
    assert [one.positions for one in found.points] == [[0.0, 0.0]]
    assert straight(ARM, AT_REST, [], 1.0).joint_names == []


def test_interpolated_frame_lies_in_between() -> None:
    one, other = Frame(Rotation.RotX(0.2), Vector(0, 0, 0)), Frame(Rotation.RotX(1.0), Vector(4, 0, 2))
    assert along(one, other, 0.25) == Frame(Rotation.RotX(0.4), Vector(1, 0, 0.5))
    assert along(one, other, 0.0) == one
    assert along(one, other, 1.0) == other


# conversions


def test_lists_and_poses_are_converted_to_each_other() -> None:
    turned = [1.0, 2.0, 3.0, 0.0, 0.0, sin(0.25), cos(0.25)]
    assert pose_to_list(list_to_pose(turned)) == turned
    assert pose_to_list(list_to_pose([1, 2, 3, 0, 0, 0.5])) == pytest.approx(turned)
    assert rpy_of(list_to_pose([1, 2, 3, 0.1, 0.2, 0.3])) == pytest.approx([0.1, 0.2, 0.3])
    for wrong in ([1] * 5, [1] * 8):
        with pytest.raises(MoveItCommanderException, match="Expected either 6 or 7 elements"):
            list_to_pose(wrong)
    assert transform_to_list(list_to_transform(turned)) == turned


# groups in a node


def test_settings_are_kept_and_returned(start: Start) -> None:
    assert run(
        start,
        """
    group.set_planning_time(3.0)
    group.set_planner_id("RRT")
    group.set_goal_tolerance(0.5)
    group.set_goal_joint_tolerance(0.25)
    found += [group.get_planning_time(), group.get_planner_id(), group.get_goal_tolerance()]
    found += [group.get_name(), group.get_variable_count(), group.get_pose_reference_frame()]
    group.set_pose_reference_frame("lower")
    found += [group.get_pose_reference_frame(), group.get_planning_frame(), group.get_link_names()[-1]]
    group.set_end_effector_link("lower")
    found += [group.get_end_effector_link(), group.get_current_pose().pose.position.x]
    """,
    ) == [3.0, "RRT", (0.25, 0.5, 0.5), "arm", 2, "base", "lower", "base", "hand", "lower", 1.0]


def test_target_may_be_a_list_mapping_name_or_message(start: Start) -> None:
    assert run(
        start,
        """
    group.set_joint_value_target([0.1, 0.2])
    found.append(group.get_joint_value_target())
    group.set_joint_value_target({"elbow": 0.3})
    found.append(group.get_joint_value_target())
    group.set_joint_value_target("shoulder", 0.4)
    found.append(group.get_joint_value_target())
    group.set_joint_value_target(JointState(name=["elbow", "wheel"], position=[0.5, 9.0]))
    found.append(group.get_joint_value_target())
    group.set_named_target("folded")
    found.append(group.get_joint_value_target())
    """,
    ) == [[0.1, 0.2], [0.1, 0.3], [0.4, 0.3], [0.4, 0.5], [1.0, -1.5]]


def test_target_is_relative_to_the_present_pose(start: Start) -> None:
    found = run(
        start,
        """
    group.go([0.4, 0.7])
    here = group.get_current_pose().pose
    group.set_rpy_target([0, 0, 1.1])
    found.append(group.go() and abs(group.get_current_pose().pose.position.x - here.position.x) < 1e-3)
    group.shift_pose_target(5, 0.0)
    found.append(group.go())
    group.shift_pose_target(2, 0.5)
    found.append(group.go())
    group.set_position_target([here.position.x, here.position.y, 0.0])
    found.append(group.go())
    group.set_position_target([here.position.x, here.position.y, 1.0])
    found.append(group.plan()[3].val)
    group.clear_pose_targets()
    found.append(group.plan()[3].val)
    """,
    )
    assert found == [True, True, False, True, -31, -16]


def test_a_plan_without_a_target_is_invalid(start: Start) -> None:
    assert run(start, "    found += [group.plan()[0], group.plan()[3].val]") == [False, -16]


def test_plan_begins_at_the_given_start(start: Start) -> None:
    found = run(
        start,
        """
    state = robot.get_current_state()
    state.joint_state.position = [0.5, 0.5]
    group.set_start_state(state)
    _, path, seconds, _ = group.plan([0.5, 0.4])
    found += [list(path.joint_trajectory.points[0].positions), seconds, len(path.joint_trajectory.points)]
    group.set_start_state_to_current_state()
    _, path, _, _ = group.plan([0.0, 0.1])
    found.append(list(path.joint_trajectory.points[0].positions))
    slower = group.retime_trajectory(robot.get_current_state(), path, 0.5)
    found.append(slower.joint_trajectory.points[-1].time_from_start.to_sec())
    """,
    )
    assert found == [[0.5, 0.5], 0.0, 2, [0.0, 0.0], pytest.approx(0.2)]


def test_pose_in_a_link_frame_is_reached(start: Start) -> None:
    found = run(
        start,
        """
    group.go([0.4, 0.7])
    goal = group.get_current_pose()
    goal.header.frame_id = "upper"
    goal.pose.position.x, goal.pose.position.y = 2.0, 0.0
    goal.pose.orientation.z, goal.pose.orientation.w = 0.0, 1.0
    found += [group.go(goal), group.get_current_joint_values()]
    goal.header.frame_id = "/nowhere"
    found.append(group.go(goal))
    """,
    )
    assert found == [True, pytest.approx([0.4, 0.0], abs=2e-3), False]


def test_random_values_are_repeatable_within_limits(start: Start) -> None:
    source = "    found += [group.get_random_joint_values() for _ in range(5)]"
    one = run(start, source)
    assert all(-2.0 <= value <= 2.0 for values in one for value in values)
    assert run(start, source)[:5] == one[:5]


def test_the_robot_has_groups_joints_and_links(start: Start) -> None:
    assert run(
        start,
        """
    found += [robot.get_root_link(), robot.get_joint_names(), robot.get_joint_names("fore"), robot.has_group("leg")]
    found += [robot.get_link_names(), robot.get_current_variable_values(), robot.get_default_owner_group("wrist")]
    found += [robot.arm is robot.get_group("arm"), list(robot.get_current_state().joint_state.name)]
    """,
    ) == [
        "base",
        ["shoulder", "elbow"],
        ["elbow"],
        False,
        ["base", "upper", "lower", "hand"],
        AT_REST,
        None,
        True,
        ["shoulder", "elbow"],
    ]


@pytest.mark.parametrize("value", [0, -0.1, 1.01])
def test_scaling_factors_are_between_zero_and_one(value: float, start: Start) -> None:
    source = """
    for name in ("velocity", "acceleration"):
        try:
            getattr(group, f"set_max_{{name}}_scaling_factor")({value})
        except moveit_commander.MoveItCommanderException as error:
            found.append(str(error))
    group.set_max_velocity_scaling_factor(1)
    group.set_max_acceleration_scaling_factor(0.01)
    """
    assert len(run(start, source.format(value=value))) == 2


def test_a_cartesian_path_needs_a_positive_step(start: Start) -> None:
    source = """
    pose = group.get_current_pose().pose
    for arguments in (([pose], 0.0), ([pose], -1.0), ([pose], 0.1, -1.0)):
        try:
            group.compute_cartesian_path(*arguments)
        except moveit_commander.MoveItCommanderException:
            found.append("refused")
    found.append(group.compute_cartesian_path([], 0.1)[1])
    found.append(group.compute_cartesian_path([pose], 0.1, True)[1])
    """
    assert run(start, source) == ["refused"] * 3 + [1.0, 1.0]


def test_cartesian_path_has_a_part_per_step(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    goals: list[int] = []

    def counted(model: Any, begin: Any, parts: Any, share: float) -> Any:
        goals.append(len(parts))
        return straight(model, begin, parts, share)

    monkeypatch.setattr(move_group, "straight", counted)
    monkeypatch.setattr(
        RobotModel, "reached", lambda *_: {}
    )  # the arm has too few joints to keep its direction
    source = """
    begin, near = group.get_current_pose().pose, group.get_current_pose().pose
    near.position.x -= 0.19
    for waypoints in ([begin], [near], [near, begin], [near, near]):
        group.set_start_state_to_current_state()
        found.append(group.compute_cartesian_path(waypoints, 0.05, 0.0)[1])
    """
    assert run(start, source, 30.0) == [1.0] * 4
    assert goals[-4:] == [1, 4, 4 + 4, 4 + 1]  # 0.19 m in steps of at most 0.05 m


def test_a_trajectory_without_points_is_not_executed(start: Start) -> None:
    found: list[Any] = run(
        start,
        """
    from moveit_msgs.msg import RobotTrajectory
    found.append(group.execute(RobotTrajectory()))
    """,
    )
    assert found == [False]
