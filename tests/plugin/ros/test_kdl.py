"""PyKDL, tf_conversions, tf2_kdl and kdl_parser_py. The expected values are those of PyKDL 1.5.1 for the same calls."""

from __future__ import annotations

import copy
import importlib.util
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.ros import kdl
from pytest_tarl.ros.kdl import Frame, Rotation, Twist, Vector, Wrench
from tests.plugin.ros.conftest import Start

bare = pytest.mark.skipif(importlib.util.find_spec("PyKDL") is not None, reason="a PyKDL is installed here")
TURN = Rotation.RPY(0.3, -0.4, 2.1)
POSE = Frame(TURN, Vector(1, -2, 0.5))
MOTION = Twist(Vector(0.1, 0.2, 0.3), Vector(-0.4, 0.5, 0.6))
LOAD = Wrench(Vector(1, 2, 3), Vector(4, 5, 6))
ANGLES = st.one_of(st.sampled_from([0.0, math.pi / 2, -math.pi / 2, math.pi]), st.floats(-7, 7))


def near(*values: float) -> object:
    return pytest.approx(values, abs=1e-8)


def arm() -> kdl.Chain:
    """Return a chain with a fixed, a sliding and two turning joints."""
    joint, chain = kdl.Joint, kdl.Chain()
    tilted = Frame(Rotation.RotX(0.3), Vector(0, 0.2, 0))
    oblique = joint("j2", Vector(0.1, 0, 0), Vector(0, 1, 1), joint.RotAxis, 1, 0.2)
    chain.addSegment(kdl.Segment("a", joint("j1", joint.RotZ), Frame(Vector(0.5, 0, 0.1))))
    chain.addSegment(kdl.Segment("b", joint("fixed", joint.Fixed), tilted))
    chain.addSegment(kdl.Segment("c", oblique, Frame(Vector(0.4, 0, 0))))
    chain.addSegment(kdl.Segment("d", joint("j3", joint.TransX), Frame(Vector(0.1, 0, 0))))
    return chain


def joints(*values: float) -> kdl.JntArray:
    array = kdl.JntArray(len(values))
    for place, value in enumerate(values):
        array[place] = value
    return array


def test_frames_rotations_and_twists_give_the_numbers_of_pykdl() -> None:
    assert TURN.GetQuaternion() == near(0.243269224, 0.02930011, 0.855358715, 0.456424207)
    assert TURN.GetEulerZYZ() == near(-0.370303524, 0.495095845, 2.531557615)
    assert TURN.GetRPY() == near(0.3, -0.4, 2.1)
    assert [*TURN.GetRot()] == near(0.599763669, 0.072237423, 2.108828535)
    assert [*(POSE * MOTION)] == near(
        -0.72749665, -0.562453337, -0.217723072, 0.06846589, -0.712012067, 0.508282636
    )
    assert [*(POSE * LOAD)] == near(
        -0.669374105, -0.884036456, 3.573572142, -9.740419592, -4.667832044, 5.975388438
    )
    assert [*POSE.Inverse(MOTION)] == near(
        0.307978698, -1.606485297, 1.042522955, 0.817182866, 0.179119721, 0.264817463
    )
    change = kdl.diff(POSE, Frame.DH(0.3, 0.4, 0.5, 0.6), 0.5)
    assert [*change] == near(-1.504798631, 4.338785484, 0.0, -0.807552991, 0.402942241, -2.914238574)
    moved = kdl.addDelta(TURN, Vector(0.1, 0.2, 0.3), 2)
    assert moved.GetQuaternion() == near(0.429544539, 0.104178446, 0.885269091, 0.144696151)


def test_values_print_compare_and_fail_as_in_pykdl() -> None:
    assert repr(Vector(1, 2, 3)) == "[           1,           2,           3]"
    assert repr(Rotation.RPY(0.1, 0.2, 0.3)).splitlines()[1] == "     0.289629,    0.956425,   -0.036957;"
    assert Vector(1, 2, 3) == Vector(1, 2, 3 + 1e-7)
    assert Vector(1, 2, 3) * Vector(1, 0, 0) == Vector(0, 3, -2)
    short = Vector(1e-7, 0, 0)
    assert (short.Normalize(), short) == (0.0, Vector(1, 0, 0))
    pose = Frame(POSE)
    pose.p[0], pose[1, 3] = 7.0, 8.0
    assert ([*pose.p], [*POSE.p]) == ([7.0, 8.0, 0.5], [1.0, -2.0, 0.5])
    for same in (copy.copy(POSE), copy.deepcopy(POSE), pickle.loads(pickle.dumps(POSE))):
        assert same == POSE
    for wrong in (
        lambda: Vector(1, 2),
        lambda: Vector(1, 2, 3) + 1,
        lambda: MOTION * MOTION,
        lambda: TURN[0],
    ):
        with pytest.raises(TypeError):
            wrong()
    for outside in (lambda: Vector()[3], lambda: Vector()[-1], lambda: Frame()[3, 3], lambda: TURN[0, 3]):
        with pytest.raises(IndexError):
            outside()


@given(ANGLES, ANGLES, ANGLES)
def test_rotations_equal_the_rotations_of_their_parameters(roll: float, pitch: float, yaw: float) -> None:
    turn = Rotation.RPY(roll, pitch, yaw)
    assert kdl.Equal(Rotation.RPY(*turn.GetRPY()), turn, 1e-6)
    assert kdl.Equal(Rotation.EulerZYZ(*turn.GetEulerZYZ()), turn, 1e-5)
    assert kdl.Equal(Rotation.Quaternion(*turn.GetQuaternion()), turn, 1e-6)
    angle, axis = turn.GetRotAngle()
    assert kdl.Equal(Rotation.Rot(axis, angle), turn, 1e-5)
    assert kdl.Equal(turn * turn.Inverse(), Rotation(), 1e-9)


@given(ANGLES, ANGLES, st.floats(-2, 2))
def test_power_is_the_same_in_every_frame(a: float, b: float, x: float) -> None:
    frame = Frame(Rotation.RPY(a, b, x), Vector(x, -x, 1))
    assert kdl.dot(frame * MOTION, frame * LOAD) == pytest.approx(kdl.dot(MOTION, LOAD))
    assert kdl.Equal(kdl.addDelta(POSE, kdl.diff(POSE, frame, 0.5), 0.5), frame, 1e-5)


def test_kinematics_of_a_chain_equal_those_of_pykdl() -> None:
    chain, pose, jacobian = arm(), Frame(), kdl.Jacobian(3)
    values = joints(0.4, -0.5, 0.2)
    assert (chain.getNrOfJoints(), chain.getNrOfSegments()) == (3, 4)
    assert kdl.ChainFkSolverPos_recursive(chain).JntToCart(values, pose) == 0
    assert [*pose.p] == near(1.058816114, 0.388567507, 0.234208631)
    assert pose.M.GetQuaternion() == near(0.171077618, -0.115141038, -0.004818653, 0.978494645)
    assert kdl.ChainJntToJacSolver(chain).JntToJac(values, jacobian) == 0
    expected = [
        [-0.388567507, 1.058816114, 0.0, 0.0, 0.0, 1.0],
        [0.083585303, 0.540981607, -0.245667251, -0.181687243, 0.42973074, 0.884489252],
        [0.973438644, -0.048826162, 0.223681051, 0.0, 0.0, 0.0],
    ]
    assert np.allclose(jacobian.data.T, expected, atol=1e-8)
    solver = kdl.ChainFkSolverPos_recursive(chain)
    assert (solver.JntToCart(joints(0.0), pose), solver.JntToCart(values, pose, 9)) == (-4, -6)
    assert solver.strError(-4) == "The size of the input does not match the internal state"


def test_inverse_kinematics_find_the_joints_of_a_pose() -> None:
    chain, pose, found = arm(), Frame(), kdl.JntArray(3)
    forward, speeds = kdl.ChainFkSolverPos_recursive(chain), kdl.ChainIkSolverVel_pinv(chain)
    forward.JntToCart(joints(0.4, -0.5, 0.2), pose)
    for solver in (
        kdl.ChainIkSolverPos_NR(chain, forward, speeds),
        kdl.ChainIkSolverPos_NR_JL(chain, joints(-1, -1, -1), joints(1, 1, 1), forward, speeds),
        kdl.ChainIkSolverPos_LMA(chain),
    ):
        assert solver.CartToJnt(joints(0.3, -0.4, 0.1), pose, found) == 0
        assert [*found] == pytest.approx([0.4, -0.5, 0.2], abs=1e-3)
    bounded = kdl.ChainIkSolverPos_NR_JL(chain, joints(-1, -1, -1), joints(0.2, 1, 1), forward, speeds)
    assert bounded.CartToJnt(joints(0.1, -0.4, 0.1), pose, found) == -5
    assert found[0] <= 0.2
    far = Frame(Vector(9, 9, 9))
    assert kdl.ChainIkSolverPos_LMA(chain).CartToJnt(joints(0.3, -0.4, 0.1), far, found) == -1


@bare
def test_a_node_converts_between_messages_tf_and_frames(start: Start) -> None:
    ros = start("""
        import PyKDL, rospy, tf2_kdl
        from geometry_msgs.msg import Pose, TransformStamped
        from tf_conversions import posemath as pm, transformations
        import tf_conversions
        rospy.init_node("n")
        publisher = rospy.Publisher("pose", Pose, queue_size=1, latch=True)
        frame = pm.fromTf(((1, 2, 3), transformations.quaternion_from_euler(0, 0, 0.5)))
        publisher.publish(tf_conversions.toMsg(frame * PyKDL.Frame(PyKDL.Vector(1, 0, 0))))
        back = pm.fromMsg(pm.toMsg(frame)) == frame == pm.fromMatrix(pm.toMatrix(frame))
        stamped = TransformStamped()
        stamped.transform.translation.x, stamped.transform.rotation.w = 4.0, 1.0
        moved = list(tf2_kdl.do_transform_vector(PyKDL.Vector(1, 1, 1), stamped)), pm.toTf(frame)[0]
    """)
    assert ros.namespace["back"] is True  # type: ignore[attr-defined]
    assert ros.namespace["moved"] == ([5.0, 1.0, 1.0], (1.0, 2.0, 3.0))  # type: ignore[attr-defined]
    assert ros.bus.latest("/pose").position.x == pytest.approx(1 + math.cos(0.5))


ROBOT = """<robot name="r"><link name="base"/><link name="arm"/><link name="slide"/><link name="tip"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/><axis xyz="1 0 0"/><limit effort="1" velocity="1"/></joint>
  <joint name="push" type="prismatic"><parent link="arm"/><child link="slide"/><axis xyz="0 0 1"/>
    <limit effort="1" velocity="1"/></joint>
  <joint name="weld" type="fixed"><parent link="slide"/><child link="tip"/><origin xyz="0 0 0.5"/></joint></robot>"""


@bare
def test_a_tree_is_made_of_a_robot_description(start: Start) -> None:
    ros = start(f"""
        import PyKDL
        from kdl_parser_py.urdf import treeFromString
        ok, tree = treeFromString({ROBOT!r})
        chain = tree.getChain("base", "tip")
        pose, values = PyKDL.Frame(), PyKDL.JntArray(2)
        values[0], values[1] = 0.5, 0.25
        PyKDL.ChainFkSolverPos_recursive(chain).JntToCart(values, pose)
        found = ok, tree.getNrOfJoints(), chain.getNrOfSegments(), list(pose.p)
    """)
    ok, moving, segments, place = ros.namespace["found"]  # type: ignore[attr-defined]
    assert (ok, moving, segments) == (True, 2, 3)
    assert place == pytest.approx([math.sin(0.5) * 0.75, 0.0, 1 + math.cos(0.5) * 0.75])
