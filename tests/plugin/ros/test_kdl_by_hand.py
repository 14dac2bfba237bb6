"""Geometry and kinematics of PyKDL, worked out apart from it: with numpy, and by hand."""

from __future__ import annotations

import copy
import pickle
from math import cos, pi, sin
from typing import Any

import numpy as np
import pytest

from pytest_tarl.ros import kdl
from pytest_tarl.ros.kdl import Frame, Rotation, Twist, Vector, Wrench
from tests.plugin.ros.kdl_numbers import A, B, near, numbers
from tests.plugin.ros.test_kdl import LOAD, MOTION, POSE, TURN, joints


def matrix(turn: Rotation) -> np.ndarray:
    return np.array([*turn]).reshape(3, 3)


def test_vectors_are_added_scaled_and_crossed() -> None:
    assert numbers(A + B) == [-3.0, 2.5, 9.0]
    assert numbers(A - B) == [5.0, 1.5, -3.0]
    assert numbers(-A) == [-1.0, -2.0, -3.0]
    assert numbers(A * 2) == numbers(2 * A) == [2.0, 4.0, 6.0]
    assert numbers(A / 2) == [0.5, 1.0, 1.5]
    assert numbers(A * B) == np.cross([1, 2, 3], [-4, 0.5, 6]).tolist()
    assert kdl.dot(A, B) == 15.0


def test_vector_is_made_of_numbers_or_a_vector() -> None:
    assert numbers(Vector()) == [0.0, 0.0, 0.0]
    assert numbers(Vector(1, z=3, y=2)) == [1.0, 2.0, 3.0]
    copied = Vector(A)
    copied[0] = 9.0
    assert numbers(A) == [1.0, 2.0, 3.0]
    for wrong in (
        lambda: Vector(1),
        lambda: Vector(1, 2, 3, 4),
        lambda: Vector(1, 2, 3, x=1),
        lambda: Vector(y=1),
    ):
        with pytest.raises(TypeError, match="Vector takes nothing, three numbers or a Vector"):
            wrong()


def test_coordinates_are_read_and_set_by_name_and_number() -> None:
    one = Vector(1, 2, 3)
    assert (one.x(), one.y(), one.z()) == (1.0, 2.0, 3.0)
    assert one.x(7) is None
    one.y(0)
    one[2] = -1
    assert numbers(one) == [7.0, 0.0, -1.0]
    for place in (-1, 3):
        with pytest.raises(IndexError, match="Vector index out of range"):
            one[place] = 1.0


def test_changing_a_sum_does_not_change_its_parts() -> None:
    one = Vector(A)
    same = one
    one += B
    one -= Vector(1, 1, 1)
    assert same is one
    assert numbers(one) == [-4.0, 1.5, 8.0]
    one.ReverseSign()
    assert numbers(one) == [4.0, -1.5, -8.0]


def test_lengths_below_the_tolerance_count_as_zero() -> None:
    assert Vector(3, 4, 12).Norm() == 13.0
    assert Vector(1e-6, 0, 0).Norm() == 1e-6
    assert Vector(9e-7, 9e-7, 0).Norm() == 0.0
    assert Vector(0, -2e-3, 0).Norm(1e-2) == 0.0
    one = Vector(0, 0, -2)
    assert one.Normalize() == 2.0
    assert numbers(one) == [0.0, 0.0, -1.0]
    assert one.Normalize(3.0) == 1.0
    assert numbers(one) == [1.0, 0.0, 0.0]


def test_vectors_are_equal_within_a_millionth() -> None:
    assert Vector(1, 2, 3.0000009) == A
    assert Vector(1, 2, 3.000002) != A
    assert A != [1.0, 2.0, 3.0]
    assert kdl.Equal(A, Vector(1, 2, 3.4), 0.5)
    assert not kdl.Equal(A, Vector(1, 2.5, 3), 0.5)


def test_operands_of_other_types_are_refused() -> None:
    for wrong in (lambda: A + 1, lambda: A - 1, lambda: A * "x", lambda: A / A, lambda: MOTION + LOAD):
        with pytest.raises(TypeError):
            wrong()


@pytest.mark.parametrize(
    "one", [A, MOTION, LOAD, TURN, POSE], ids=["vector", "twist", "wrench", "rotation", "frame"]
)
def test_a_copy_is_equal_and_independent(one: Any) -> None:
    for same in (copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one)), type(one)(one)):
        assert type(same) is type(one)
        assert same == one
        assert same is not one
    place: Any = 0 if isinstance(one, Vector | Twist | Wrench) else (0, 0)
    before, changed = one[place], copy.copy(one)
    changed[place] = before + 5.0
    assert one[place] == before
    assert changed != one


def test_twist_numbers_are_both_velocities() -> None:
    one = Twist(A, B)
    assert numbers(one) == [1.0, 2.0, 3.0, -4.0, 0.5, 6.0]
    assert (one[2], one[3]) == (3.0, -4.0)
    one[1], one[5] = 8.0, 9.0
    assert (numbers(one.vel), numbers(one.rot)) == ([1.0, 8.0, 3.0], [-4.0, 0.5, 9.0])
    for place in (-1, 6):
        with pytest.raises(IndexError, match="Twist index out of range"):
            one[place]
        with pytest.raises(IndexError, match="Twist index out of range"):
            one[place] = 0.0


def test_twists_are_added_scaled_and_reversed() -> None:
    one, other = Twist(A, B), Twist(B, A)
    assert numbers(one + other) == numbers(other + one) == [-3.0, 2.5, 9.0] * 2
    assert numbers(one - other) == [5.0, 1.5, -3.0, -5.0, -1.5, 3.0]
    assert numbers(one * 2) == numbers(2 * one) == [2.0, 4.0, 6.0, -8.0, 1.0, 12.0]
    assert numbers(one / 2) == [0.5, 1.0, 1.5, -2.0, 0.25, 3.0]
    one += other
    one -= Twist(Vector(1, 1, 1), Vector())
    assert numbers(one) == [-4.0, 1.5, 8.0, -3.0, 2.5, 9.0]
    one.ReverseSign()
    assert numbers(one) == [4.0, -1.5, -8.0, 3.0, -2.5, -9.0]
    assert numbers(Twist.Zero()) == [0.0] * 6


def test_moved_reference_point_changes_velocity_or_torque() -> None:
    moved = Vector(0, 1, 0)
    twist = Twist(Vector(1, 0, 0), Vector(0, 0, 2)).RefPoint(moved)
    assert numbers(twist) == [-1.0, 0.0, 0.0, 0.0, 0.0, 2.0]  # ω × r = (-2, 0, 0)
    wrench = Wrench(Vector(1, 0, 0), Vector(0, 0, 2)).RefPoint(moved)
    assert numbers(wrench) == [1.0, 0.0, 0.0, 0.0, 0.0, 3.0]  # f × r = (0, 0, 1)


def test_the_parts_of_a_wrench_are_set_as_copies() -> None:
    force = Vector(1, 2, 3)
    one = Wrench()
    one.force, one.torque = force, B
    force[0] = 9.0
    assert (numbers(one.force), numbers(one.torque)) == ([1.0, 2.0, 3.0], numbers(B))
    with pytest.raises(TypeError, match="Wrench takes nothing, two Vectors or a copy"):
        Wrench(A)
    with pytest.raises(TypeError, match="Twist takes"):
        Twist(Wrench())


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0, pi / 2])
def test_rotation_turns_the_other_two_axes(angle: float) -> None:
    c, s = cos(angle), sin(angle)
    assert numbers(Rotation.RotX(angle)) == near(1, 0, 0, 0, c, -s, 0, s, c)
    assert numbers(Rotation.RotY(angle)) == near(c, 0, s, 0, 1, 0, -s, 0, c)
    assert numbers(Rotation.RotZ(angle)) == near(c, -s, 0, s, c, 0, 0, 0, 1)


def test_angles_are_applied_in_their_order() -> None:
    x, y, z = (matrix(one) for one in (Rotation.RotX(0.1), Rotation.RotY(0.2), Rotation.RotZ(0.3)))
    assert np.allclose(matrix(Rotation.RPY(0.1, 0.2, 0.3)), z @ y @ x)
    assert np.allclose(matrix(Rotation.EulerZYX(0.3, 0.2, 0.1)), z @ y @ x)
    last = matrix(Rotation.RotZ(0.4))
    assert np.allclose(matrix(Rotation.EulerZYZ(0.3, 0.2, 0.4)), z @ y @ last)
    turned = Rotation.RotZ(0.3)
    turned.DoRotY(0.2)
    turned.DoRotX(0.1)
    assert np.allclose(matrix(turned), z @ y @ x)
    turned.DoRotZ(0.4)
    assert np.allclose(matrix(turned), z @ y @ x @ last)


def test_the_angles_of_a_rotation_are_read_back() -> None:
    assert Rotation.RPY(0.1, 0.2, 0.3).GetEulerZYX() == pytest.approx((0.3, 0.2, 0.1))
    assert Rotation.EulerZYZ(0.3, 0.2, 0.4).GetEulerZYZ() == pytest.approx((0.3, 0.2, 0.4))
    assert Rotation.RPY(0.4, pi / 2, 0.1).GetRPY() == pytest.approx((0.0, pi / 2, -0.3))
    assert Rotation.RPY(0.4, -pi / 2, 0.1).GetRPY() == pytest.approx((0.0, -pi / 2, 0.5))
    assert Rotation.RotZ(0.7).GetEulerZYZ() == pytest.approx((0.7, 0.0, 0.0))
    flipped = Rotation.EulerZYZ(0.7, pi, 0.2)
    assert flipped.GetEulerZYZ() == pytest.approx((0.5, pi, 0.0))
    assert kdl.Equal(Rotation.EulerZYZ(*flipped.GetEulerZYZ()), flipped, 1e-9)


@pytest.mark.parametrize(
    "axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, 3), (-2, 1, 1), (1, -3, 1), (1, 1, -4)]
)
@pytest.mark.parametrize("angle", [0.01, 1.5, 2.5, 3.1])
def test_quaternions_and_axes_describe_the_same_rotation(axis: tuple[float, ...], angle: float) -> None:
    unit = np.array(axis) / np.linalg.norm(axis)
    turn = Rotation.Rot(Vector(*axis), angle)
    expected = np.array([*(unit * sin(angle / 2)), cos(angle / 2)])
    if np.trace(matrix(turn)) <= 0.0:  # the component with the largest absolute value is then positive
        expected *= np.sign(unit[np.argmax(np.abs(unit))])
    assert [*turn.GetQuaternion()] == pytest.approx(expected.tolist(), abs=1e-9)
    assert np.allclose(matrix(Rotation.Quaternion(*turn.GetQuaternion())), matrix(turn))
    found, about = turn.GetRotAngle()
    assert found == pytest.approx(angle)
    assert numbers(about) == pytest.approx(unit.tolist())
    assert numbers(turn.GetRot()) == pytest.approx((unit * angle).tolist())


@pytest.mark.parametrize(
    "axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (3, 2, 1), (1, 3, 2), (1, 2, 3), (2, -3, 1)]
)
def test_half_turn_has_an_axis_and_no_real_part(axis: tuple[float, ...]) -> None:
    turn = Rotation.Rot(Vector(*axis), pi)
    angle, about = turn.GetRotAngle()
    assert angle == pytest.approx(pi)
    assert abs(np.dot([*about], axis)) == pytest.approx(float(np.linalg.norm(axis)))
    assert np.allclose(matrix(Rotation.Rot(about, angle)), matrix(turn))
    quaternion = np.array(turn.GetQuaternion())
    assert quaternion[3] == pytest.approx(0.0, abs=1e-9)
    assert abs(quaternion[:3] @ axis) == pytest.approx(float(np.linalg.norm(axis)))


def test_the_identity_has_the_z_axis_as_its_axis() -> None:
    angle, axis = Rotation().GetRotAngle()
    assert (angle, numbers(axis)) == (0.0, [0.0, 0.0, 1.0])
    assert numbers(Rotation.Identity()) == [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0]
    tiny, _ = Rotation.RotX(1e-7).GetRotAngle()
    assert tiny == 0.0


def test_columns_of_a_jacobian_can_be_read_and_set() -> None:
    turn = Rotation(Vector(1, 2, 3), Vector(4, 5, 6), Vector(7, 8, 9))
    assert numbers(turn) == [1.0, 4.0, 7.0, 2.0, 5.0, 8.0, 3.0, 6.0, 9.0]
    assert [numbers(one()) for one in (turn.UnitX, turn.UnitY, turn.UnitZ)] == [
        [1, 2, 3],
        [4, 5, 6],
        [7, 8, 9],
    ]
    assert turn.UnitY(Vector(0, 0, 1)) is None
    assert numbers(turn) == [1.0, 0.0, 7.0, 2.0, 0.0, 8.0, 3.0, 1.0, 9.0]


def test_rotation_is_indexed_by_row_and_column() -> None:
    turn = Rotation(*range(9))
    assert [turn[place] for place in ((0, 2), (1, 0), (2, 1))] == [2.0, 3.0, 7.0]
    turn[1, 2] = -1
    assert numbers(turn)[5] == -1.0
    for place in ((3, 0), (0, 3), (-1, 0), (0, -1)):
        with pytest.raises(IndexError, match="Rotation index out of range"):
            turn[place]
    for wrong in (1, (1,), (1, 2, 3), [1, 2]):
        with pytest.raises(TypeError, match="Rotation takes two indices"):
            turn[wrong]  # type: ignore[index]
    with pytest.raises(TypeError, match="nine numbers, three Vectors or a Rotation"):
        Rotation(1, 2, 3)


def test_the_inverse_undoes_a_rotation() -> None:
    assert np.allclose(matrix(TURN.Inverse()), matrix(TURN).T)
    assert numbers(TURN.Inverse(TURN * A)) == pytest.approx([1, 2, 3])
    assert numbers(TURN.Inverse(TURN * MOTION)) == pytest.approx(numbers(MOTION))
    turn = Rotation(TURN)
    turn.SetInverse()
    assert turn == TURN.Inverse()


def test_rotation_turns_twists_and_wrenches() -> None:
    expected = [*(matrix(TURN) @ numbers(MOTION.vel)), *(matrix(TURN) @ numbers(MOTION.rot))]
    assert numbers(TURN * MOTION) == pytest.approx(expected)
    expected = [*(matrix(TURN) @ numbers(LOAD.force)), *(matrix(TURN) @ numbers(LOAD.torque))]
    assert numbers(TURN * LOAD) == pytest.approx(expected)
    assert np.allclose(matrix(TURN * Rotation.RotX(0.2)), matrix(TURN) @ matrix(Rotation.RotX(0.2)))


def homogeneous(frame: Frame) -> np.ndarray:
    return np.array([[frame[row, column] for column in range(4)] for row in range(3)] + [[0, 0, 0, 1]])


def test_frames_are_multiplied_as_homogeneous_matrices() -> None:
    other = Frame(Rotation.RotX(0.4), Vector(0.5, 0.1, -2))
    assert np.allclose(homogeneous(POSE * other), homogeneous(POSE) @ homogeneous(other))
    assert np.allclose(homogeneous(POSE.Inverse()), np.linalg.inv(homogeneous(POSE)))
    assert numbers(POSE * A) == pytest.approx((homogeneous(POSE) @ [1, 2, 3, 1])[:3].tolist())
    assert numbers(POSE.Inverse(POSE * A)) == pytest.approx([1, 2, 3])


def test_denavit_and_hartenberg_parameters_are_applied_in_their_order() -> None:
    a, alpha, d, theta = 0.3, 0.4, 0.5, 0.6
    turn, tilt = Frame(Rotation.RotZ(theta)), Frame(Rotation.RotX(alpha))
    along, up = Frame(Vector(a, 0, 0)), Frame(Vector(0, 0, d))
    assert Frame.DH(a, alpha, d, theta) == turn * up * along * tilt
    assert Frame.DH_Craig1989(a, alpha, d, theta) == tilt * along * turn * up


def test_frame_is_made_from_a_rotation_or_a_vector() -> None:
    assert Frame() == Frame.Identity() == Frame(Rotation(), Vector())
    assert Frame(TURN).p == Vector()
    assert Rotation() == Frame(A).M
    assert Frame(Frame(TURN, A)) == Frame(TURN, A)
    for wrong in (lambda: Frame(1), lambda: Frame(A, TURN), lambda: Frame(TURN, A, A)):
        with pytest.raises(TypeError, match="Frame takes a Rotation, a Vector, both, or a Frame"):
            wrong()
    assert Frame(TURN) != Frame(TURN, Vector(0, 0, 1e-3))
    assert Frame(TURN, A) != Frame(A)


def test_twist_moves_a_frame_along_its_axes() -> None:
    frame = Frame(Rotation.RotZ(pi / 2), Vector(1, 0, 0))
    frame.Integrate(Twist(Vector(2, 0, 0), Vector(0, 0, 1)), 4)
    assert numbers(frame.p) == near(1.0, 0.5, 0.0)
    assert Rotation.RotZ(pi / 2 + 0.25) == frame.M


def test_differences_are_divided_by_time() -> None:
    assert numbers(kdl.diff(A, B, 2)) == [-2.5, -0.75, 1.5]
    assert numbers(kdl.addDelta(A, Vector(1, 2, 3), 2)) == [3.0, 6.0, 9.0]
    turned = kdl.addDelta(Rotation.RotX(0.2), Vector(0, 0, 0.3), 2)
    assert np.allclose(matrix(turned), matrix(Rotation.RotZ(0.6) * Rotation.RotX(0.2)))
    assert numbers(kdl.diff(Rotation.RotX(0.2), turned, 2)) == near(0.0, 0.0, 0.3)
    assert numbers(kdl.diff(A, B)) == [-5.0, -1.5, 3.0]


def test_values_are_set_to_zero_in_place() -> None:
    for one in (Vector(1, 2, 3), Twist(A, B)):
        kdl.SetToZero(one)
        assert set(one) == {0.0}
    array = joints(1.0, 2.0)
    kdl.SetToZero(array)
    assert array.data.tolist() == [0.0, 0.0]
