"""Chains, trees and solvers of PyKDL, worked out apart from it: with numpy, and by hand."""

from __future__ import annotations

from math import inf, pi, sqrt

import numpy as np
import pytest

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.ros import kdl
from pytest_tarl.ros.kdl import Frame, Rotation, Twist, Vector
from pytest_tarl.ros.kdl.chains import Chain, Jacobian, JntArray, Joint, JointKind, Segment, Tree
from pytest_tarl.ros.kdl.solvers import (
    ChainFkSolverPos_recursive,
    ChainIkSolverPos_LMA,
    ChainIkSolverPos_NR,
    ChainIkSolverVel_pinv,
    ChainJntToJacSolver,
)
from pytest_tarl.ros.kdl_parser import treeFromString
from tests.plugin.ros.kdl_numbers import A, B, near, numbers
from tests.plugin.ros.test_kdl import MOTION, POSE, TURN, arm, joints


def test_an_array_of_joints_is_resized_and_checked() -> None:
    one = joints(1.0, 2.0)
    assert (one.rows(), one.columns()) == (2, 1)
    one.resize(3)
    assert one.data.tolist() == [1.0, 2.0, 0.0]
    one.resize(1)
    assert one.data.tolist() == [1.0]
    for place in (-1, 1):
        with pytest.raises(IndexError, match="JntArray index out of range"):
            one[place]
        with pytest.raises(IndexError, match="JntArray index out of range"):
            one[place] = 0.0
    same = JntArray(one)
    same[0] = 5.0
    assert one[0] == 1.0
    assert one == joints(1.0000001)
    assert one != joints(1.0, 0.0)
    assert one != 1.0
    assert repr(joints(1.5, -2)) == "[         1.5           -2]"


def test_a_jacobian_has_a_twist_for_each_joint() -> None:
    one = Jacobian(2)
    assert (one.rows(), one.columns()) == (6, 2)
    one.setColumn(1, Twist(A, B))
    assert one.getColumn(1) == Twist(A, B)
    assert one[3, 1] == -4.0
    one[5, 0] = 7
    assert one.data[5].tolist() == [7.0, 6.0]
    same = Jacobian(one)
    same.resize(3)
    assert (same.columns(), float(same.data.sum()), one.columns()) == (3, 0.0, 2)
    for place in ((6, 0), (0, 2), (-1, 0), (0, -1)):
        with pytest.raises(IndexError, match="Jacobian index out of range"):
            one[place]
        with pytest.raises(IndexError, match="Jacobian index out of range"):
            one[place] = 1.0


def test_jacobian_can_be_expressed_in_another_frame() -> None:
    for change, expected in (
        (lambda one: one.changeRefPoint(A), MOTION.RefPoint(A)),
        (lambda one: one.changeBase(TURN), TURN * MOTION),
        (lambda one: one.changeRefFrame(POSE), POSE * MOTION),
    ):
        one = Jacobian(2)
        for place in range(2):
            one.setColumn(place, MOTION)
        change(one)  # type: ignore[no-untyped-call]
        assert [one.getColumn(place) for place in range(2)] == [expected] * 2


@pytest.mark.parametrize(("kind", "axis"), [(Joint.RotX, 0), (Joint.RotY, 1), (Joint.RotZ, 2)])
def test_a_turning_joint_turns_about_its_axis(kind: JointKind, axis: int) -> None:
    unit = Vector(*(float(one == axis) for one in range(3)))
    one = Joint("j", kind, 2, 0.1)
    assert one.pose(0.3) == Frame(Rotation.Rot2(unit, 0.7))
    assert one.twist(1.5) == Twist(Vector(), unit * 3.0)
    assert (one.getName(), one.getType(), one.getTypeName()) == ("j", kind, kind.name)
    assert (one.JointAxis(), one.JointOrigin()) == (unit, Vector())


@pytest.mark.parametrize(("kind", "axis"), [(Joint.TransX, 0), (Joint.TransY, 1), (Joint.TransZ, 2)])
def test_a_sliding_joint_slides_along_its_axis(kind: JointKind, axis: int) -> None:
    unit = Vector(*(float(one == axis) for one in range(3)))
    one = Joint(kind, 2, 0.1)
    assert one.pose(0.3) == Frame(unit * 0.7)
    assert one.twist(1.5) == Twist(unit * 3.0, Vector())
    assert one.getName() == "NoName"


def test_joint_axis_has_an_origin_and_length_one() -> None:
    one = Joint("j", Vector(1, 0, 0), Vector(0, 0, 5), Joint.RotAxis)
    assert one.pose(pi / 2) == Frame(Rotation.RotZ(pi / 2), Vector(1, 0, 0))
    assert one.twist(1.0) == Twist(Vector(), Vector(0, 0, 1))
    sliding = Joint(name="s", origin=Vector(1, 0, 0), axis=Vector(0, 2, 0), type=Joint.TransAxis)
    assert sliding.pose(0.5) == Frame(Vector(1, 0.5, 0))
    assert (sliding.getName(), sliding.JointAxis()) == ("s", Vector(0, 1, 0))


def test_a_fixed_joint_does_not_move() -> None:
    one = Joint("f", Joint.Fixed)
    assert (one.pose(3.0), one.twist(2.0)) == (Frame(), Twist())
    assert Joint().getType() is Joint.Fixed
    assert Joint(one).getName() == "f"


def test_segment_pose_at_zero_is_its_tip() -> None:
    tip = Frame(Rotation.RotX(0.2), Vector(1, 0, 0))
    one = Segment("s", Joint("j", Joint.RotZ, 1, 0.5), tip)
    assert one.getFrameToTip() == tip
    assert one.pose(0.3) == Frame(Rotation.RotZ(0.3)) * tip
    moved = one.twist(0.3, 2.0)
    assert moved.rot == Vector(0, 0, 2)
    assert moved.vel == Vector(0, 0, 2) * (Rotation.RotZ(0.3) * Vector(1, 0, 0))
    assert (Segment(one).getName(), Segment(one).getJoint().getName()) == ("s", "j")
    assert Segment(joint=Joint("k", Joint.RotX)).getName() == "NoName"
    with pytest.raises(UnsupportedApiError):
        one.getInertia()


def test_chains_count_their_segments_and_the_joints_that_move() -> None:
    one = arm()
    both = Chain(one)
    both.addChain(one)
    assert (one.getNrOfSegments(), one.getNrOfJoints()) == (4, 3)
    assert (both.getNrOfSegments(), both.getNrOfJoints()) == (8, 6)
    assert both.getSegment(4) is one.getSegment(0)


def link(name: str, kind: JointKind = Joint.RotZ) -> Segment:
    return Segment(name, Joint(f"{name}_joint", kind), Frame(Vector(1, 0, 0)))


def test_tree_takes_segments_with_new_names() -> None:
    tree = Tree("base")
    assert tree.addSegment(link("a"), "base")
    assert tree.addSegment(link("b", Joint.Fixed), "a")
    assert tree.addSegment(link("c"), "a")
    assert not tree.addSegment(link("d"), "nowhere")
    assert not tree.addSegment(link("a"), "base")
    assert not tree.addSegment(link("base"), "a")
    assert (tree.getNrOfSegments(), tree.getNrOfJoints()) == (3, 2)
    assert [one.getName() for one in tree.getChain("base", "b").segments] == ["a", "b"]
    assert [one.getName() for one in tree.getChain("a", "c").segments] == ["c"]
    assert tree.getChain("c", "c").segments == []
    for root, tip in (("b", "c"), ("c", "a"), ("base", "nowhere")):
        with pytest.raises(UnsupportedApiError):
            tree.getChain(root, tip)


def test_tree_takes_the_segments_of_a_chain() -> None:
    chain, tree = Chain(), Tree()
    for name in ("a", "b"):
        chain.addSegment(link(name))
    assert not tree.addChain(chain, "nowhere")
    assert tree.addChain(chain, "root")
    assert [one.getName() for one in tree.getChain("root", "b").segments] == ["a", "b"]
    assert not tree.addChain(chain, "b")


def test_segment_pose_is_the_product_of_earlier_poses() -> None:
    chain, values, pose = arm(), [0.4, -0.5, 0.2], Frame()
    solver = ChainFkSolverPos_recursive(chain)
    parts = [chain.getSegment(place) for place in range(4)]
    expected, used = Frame(), iter(values)
    assert solver.JntToCart(joints(*values), pose, 0) == 0
    assert pose == Frame()
    for count, part in enumerate(parts, 1):
        expected = expected * part.pose(0.0 if part.getJoint().getType() is Joint.Fixed else next(used))
        assert solver.JntToCart(joints(*values), pose, count) == 0
        assert pose == expected
    assert solver.JntToCart(joints(*values), pose) == 0
    assert pose == expected
    assert solver.JntToCart(joints(*values), pose, 5) == -6
    assert (solver.getError(), pose) == (-6, Frame())


@pytest.mark.parametrize("count", [1, 2, 3, 4, -1])
def test_the_jacobian_is_the_derivative_of_the_pose(count: int) -> None:
    chain, values, jacobian = arm(), np.array([0.4, -0.5, 0.2]), Jacobian(3)
    solver, forward, step = ChainJntToJacSolver(chain), ChainFkSolverPos_recursive(chain), 1e-6
    assert solver.JntToJac(joints(*values), jacobian, count) == 0
    here = Frame()
    forward.JntToCart(joints(*values), here, count)
    for place in range(3):
        then, moved = Frame(), values.copy()
        moved[place] += step
        forward.JntToCart(joints(*moved), then, count)
        assert numbers(jacobian.getColumn(place)) == pytest.approx(
            numbers(kdl.diff(here, then, step)), abs=1e-5
        )


def test_mismatched_sizes_are_refused() -> None:
    chain, pose = arm(), Frame()
    forward, speeds = ChainFkSolverPos_recursive(chain), ChainIkSolverVel_pinv(chain)
    short, right = joints(0.0), JntArray(3)
    jacobian = ChainJntToJacSolver(chain)
    assert jacobian.JntToJac(short, Jacobian(3)) == -4
    assert jacobian.JntToJac(right, Jacobian(2)) == -4
    assert jacobian.JntToJac(right, Jacobian(3), 9) == -6
    for one, other in ((short, right), (right, short)):
        assert speeds.CartToJnt(one, MOTION, other) == -4
        assert ChainIkSolverPos_NR(chain, forward, speeds).CartToJnt(one, pose, other) == -4
        assert ChainIkSolverPos_LMA(chain).CartToJnt(one, pose, other) == -4
    assert [speeds.strError(code) for code in (0, -1, -5, -6, 7)] == [
        "No error",
        "Failed to converge",
        "The maximum number of iterations is exceeded",
        "The requested index is out of range",
        "UNKNOWN ERROR",
    ]


def test_joint_speeds_approximate_the_twist_as_well_as_possible() -> None:
    chain, values, speeds, jacobian = arm(), joints(0.4, -0.5, 0.2), JntArray(3), Jacobian(3)
    ChainJntToJacSolver(chain).JntToJac(values, jacobian)
    twist = Twist(
        Vector(*(jacobian.data @ [0.1, -0.2, 0.3])[:3]), Vector(*(jacobian.data @ [0.1, -0.2, 0.3])[3:])
    )
    assert ChainIkSolverVel_pinv(chain).CartToJnt(values, twist, speeds) == 0
    assert speeds.data.tolist() == near(0.1, -0.2, 0.3)
    ChainIkSolverVel_pinv(chain, eps=inf).CartToJnt(values, twist, speeds)
    assert speeds.data.tolist() == [0.0, 0.0, 0.0]


def test_solver_returns_its_iterations_at_the_limit() -> None:
    chain, pose, found = arm(), Frame(), JntArray(3)
    forward, speeds = ChainFkSolverPos_recursive(chain), ChainIkSolverVel_pinv(chain)
    forward.JntToCart(joints(0.4, -0.5, 0.2), pose)
    assert ChainIkSolverPos_NR(chain, forward, speeds, 1).CartToJnt(joints(0.3, -0.4, 0.1), pose, found) == -5
    assert ChainIkSolverPos_NR(chain, forward, speeds, 1).CartToJnt(joints(0.4, -0.5, 0.2), pose, found) == 0
    assert ChainIkSolverPos_LMA(chain, maxiter=1).CartToJnt(joints(0.3, -0.4, 0.1), pose, found) == -1
    assert ChainIkSolverPos_LMA(chain).CartToJnt(joints(0.4, -0.5, 0.2), pose, found) == 0
    assert found.data.tolist() == [0.4, -0.5, 0.2]


ROBOT = """<robot name="r"><link name="base"/><link name="arm"/><link name="hand"/><link name="eye"/>
  <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><origin xyz="1 2 3" rpy="0 0 0.5"/>
    </joint>
  <joint name="grip" type="prismatic"><parent link="arm"/><child link="hand"/><axis xyz="0 1 0"/>
    <limit effort="1" velocity="1"/></joint>
  <joint name="weld" type="fixed"><parent link="arm"/><child link="eye"/><origin xyz="0 0 1"/></joint></robot>"""


def test_description_becomes_a_tree_of_joints() -> None:
    ok, tree = treeFromString(ROBOT)  # type: ignore[arg-type]
    assert (ok, tree.getNrOfSegments(), tree.getNrOfJoints()) == (True, 3, 2)
    turn, grip = tree.getChain("base", "hand").segments
    assert turn.getJoint().getType() is Joint.RotAxis
    assert turn.getJoint().JointAxis() == Rotation.RotZ(0.5) * Vector(1, 0, 0)  # x is the default axis
    assert turn.getJoint().JointOrigin() == Vector(1, 2, 3)
    assert turn.getFrameToTip() == Frame(Rotation.RotZ(0.5), Vector(1, 2, 3))
    assert (grip.getJoint().getType(), grip.getJoint().JointAxis()) == (Joint.TransAxis, Vector(0, 1, 0))
    (weld,) = tree.getChain("arm", "eye").segments
    assert (weld.getJoint().getType(), weld.getFrameToTip().p) == (Joint.Fixed, Vector(0, 0, 1))
    assert sqrt(kdl.dot(A, A)) == pytest.approx(A.Norm())
