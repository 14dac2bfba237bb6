"""`tf.transformations` against scipy's rotations and against the geometry that each matrix describes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.ros import transformations as tf

TURNS = Rotation.random(24, random_state=20261126)
AXES = [f"{frame}{a}{b}{c}" for frame in "sr" for a in "xyz" for b in "xyz" for c in "xyz" if b not in (a, c)]
POINT, NORMAL = np.array([1.0, -2.0, 0.5]), np.array([2.0, 1.0, -2.0])  # |NORMAL| = 3
BESIDE = POINT + np.array([1.0, 0.0, 1.0])  # POINT and a step perpendicular to NORMAL


def same_rotation(one: Sequence[float], other: Sequence[float]) -> bool:
    return bool(np.allclose(one, other, atol=1e-9) or np.allclose(one, -np.asarray(other), atol=1e-9))


def moved(matrix: Any, point: Sequence[float]) -> Any:
    """Return a point after a 4×4 matrix, divided by its last coordinate."""
    x, y, z, w = np.asarray(matrix) @ [*point, 1.0]
    return np.array([x, y, z]) / w


@pytest.mark.parametrize("axes", AXES)
def test_angles_give_the_rotation_of_scipy(axes: str) -> None:
    """scipy writes fixed axes in lower case, moving axes in upper case."""
    order = axes[1:] if axes[0] == "s" else axes[1:].upper()
    for angles in ((0.3, -0.8, 1.9), (-2.5, 1.1, 0.4), (0.0, 0.6, 0.0)):
        turn = Rotation.from_euler(order, angles)
        assert same_rotation(tf.quaternion_from_euler(*angles, axes), turn.as_quat())
        assert tf.euler_matrix(*angles, axes)[:3, :3] == pytest.approx(turn.as_matrix())
        if axes[1] != axes[3]:  # the middle angle lies between -π/2 and π/2
            assert tf.euler_from_matrix(turn.as_matrix(), axes) == pytest.approx(turn.as_euler(order))


def test_matrices_and_quaternions_equal_the_results_of_scipy() -> None:
    for turn in TURNS:
        matrix = tf.quaternion_matrix(turn.as_quat())
        assert matrix[:3, :3] == pytest.approx(turn.as_matrix())
        assert matrix[3].tolist() == matrix[:, 3].tolist() == [0, 0, 0, 1]
        assert tf.quaternion_matrix(3 * turn.as_quat()) == pytest.approx(matrix)
        assert same_rotation(tf.quaternion_from_matrix(turn.as_matrix()), turn.as_quat())
        assert tf.euler_from_quaternion(turn.as_quat()) == pytest.approx(turn.as_euler("xyz"))
        vector = turn.as_rotvec()
        assert same_rotation(tf.quaternion_about_axis(np.linalg.norm(vector), 5 * vector), turn.as_quat())


@pytest.mark.parametrize("axis", range(3))
def test_half_turn_quaternion_is_its_axis(axis: int) -> None:
    unit = np.identity(3)[axis]
    assert tf.quaternion_from_matrix(Rotation.from_rotvec(math.pi * unit).as_matrix()) == pytest.approx(
        [*unit, 0.0], abs=1e-9
    )


def test_small_rotation_has_a_positive_w() -> None:
    """As in tf: nodes read angles as 2 atan2(z, w)."""
    for angle in (0.4, 1.2, 1.7, 2.0, -1.7, -2.0):
        found = tf.quaternion_from_matrix(tf.euler_matrix(0.0, 0.0, angle))
        assert 2 * math.atan2(found[2], found[3]) == pytest.approx(angle)


def test_rotation_products_equal_scipys() -> None:
    for first, second in pairwise(TURNS):
        product = tf.quaternion_multiply(first.as_quat(), second.as_quat())
        assert same_rotation(product, (first * second).as_quat())
        assert same_rotation(tf.quaternion_inverse(first.as_quat()), first.inv().as_quat())
        assert tf.quaternion_multiply(2 * first.as_quat(), tf.quaternion_inverse(2 * first.as_quat())) == (
            pytest.approx([0, 0, 0, 1], abs=1e-12)
        )
    assert tf.quaternion_conjugate([1, 2, 3, 4]).tolist() == [-1, -2, -3, 4]


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 0.9, 1.0])
def test_interpolation_gives_the_numbers_of_scipy(share: float) -> None:
    for number in range(10):
        between = Slerp([0, 1], TURNS[[number, number + 1]])([share])[0]
        start, end = TURNS[number].as_quat(), TURNS[number + 1].as_quat()
        assert same_rotation(tf.quaternion_slerp(2 * start, 3 * end, share), between.as_quat())


@pytest.mark.parametrize("options", [{"spin": 1}, {"shortestpath": False}])
def test_interpolation_along_the_longer_arc_is_refused(options: dict[str, Any]) -> None:
    with pytest.raises(UnsupportedApiError, match=r"quaternion_slerp.* is not in the in-process ROS yet"):
        tf.quaternion_slerp([0, 0, 0, 1], [0, 0, 1, 0], 0.5, **options)


def test_rotations_without_a_direction_are_the_identity() -> None:
    assert tf.euler_from_quaternion([0, 0, 0, 0]) == (0, 0, 0)
    assert tf.quaternion_about_axis(0.0, [0, 0, 0]).tolist() == [0, 0, 0, 1]
    assert tf.quaternion_matrix([0, 0, 0, 0]).tolist() == np.identity(4).tolist()


@pytest.mark.parametrize("axes", ["xyz", "sxy", "sxyw", "txyz", "sxyzx"])
def test_unknown_axes_raise_a_key_error(axes: str) -> None:
    with pytest.raises(KeyError, match=axes):
        tf.quaternion_from_euler(0, 0, 0, axes)


def test_rotation_about_a_point_keeps_it() -> None:
    matrix = tf.rotation_matrix(math.pi / 2, [0, 0, 1], [1, 2, 3])
    assert moved(matrix, [1, 2, 3]) == pytest.approx([1, 2, 3])
    assert moved(matrix, [2, 2, 3]) == pytest.approx([1, 3, 3])
    angle, axis, point = tf.rotation_from_matrix(matrix)
    assert (angle * axis[2], axis[:2].tolist()) == (pytest.approx(math.pi / 2), pytest.approx([0, 0]))
    assert moved(matrix, point[:3]) == pytest.approx(point[:3])


def test_rotations_of_every_axis_and_angle_are_read_back() -> None:
    for turn in TURNS:
        matrix = np.identity(4)
        matrix[:3, :3] = turn.as_matrix()
        angle, axis, _ = tf.rotation_from_matrix(matrix)
        assert Rotation.from_rotvec(angle * axis).as_matrix() == pytest.approx(turn.as_matrix())


def test_matrices_are_composed_inverted_and_read() -> None:
    first, second = tf.translation_matrix([1, 2, 3]), tf.rotation_matrix(math.pi / 2, [0, 0, 1])
    both = tf.concatenate_matrices(first, second)
    assert moved(both, [1, 0, 0]) == pytest.approx([1, 3, 3])
    assert tf.translation_from_matrix(both).tolist() == [1, 2, 3]
    assert tf.inverse_matrix(both) @ both == pytest.approx(np.identity(4))
    assert tf.concatenate_matrices() == pytest.approx(tf.identity_matrix())
    assert tf.unit_vector([3, 0, -4]).tolist() == [0.6, 0, -0.8]
    assert tf.vector_norm([2, -3, 6]) == 7


def test_a_reflection_mirrors_points_in_the_plane() -> None:
    matrix = tf.reflection_matrix(POINT, NORMAL)
    assert moved(matrix, POINT) == pytest.approx(POINT)
    assert moved(matrix, POINT + NORMAL) == pytest.approx(POINT - NORMAL)
    assert moved(matrix, BESIDE) == pytest.approx(BESIDE)
    point, normal = tf.reflection_from_matrix(matrix)
    assert abs(normal @ NORMAL) == pytest.approx(3)
    assert moved(matrix, point[:3]) == pytest.approx(point[:3])
    with pytest.raises(ValueError, match="eigenvalue -1"):
        tf.reflection_from_matrix(np.identity(4))


def test_a_scaling_multiplies_distances_from_its_origin() -> None:
    assert moved(tf.scale_matrix(-2.0), [1, 2, 3]).tolist() == [-2, -4, -6]
    about = tf.scale_matrix(3.0, POINT)
    assert moved(about, POINT + np.ones(3)) == pytest.approx(POINT + 3)
    along = tf.scale_matrix(3.0, POINT, NORMAL)
    assert moved(along, POINT + NORMAL) == pytest.approx(POINT + 3 * NORMAL)
    assert moved(along, BESIDE) == pytest.approx(BESIDE)
    for matrix in (about, along):
        factor, origin, direction = tf.scale_from_matrix(matrix)
        assert factor == pytest.approx(3)
        assert tf.scale_matrix(factor, origin, direction) == pytest.approx(matrix)
    assert tf.scale_from_matrix(about)[2] is None


def test_a_projection_moves_points_into_the_plane() -> None:
    unit = NORMAL / 3
    for direction in (NORMAL, np.array([1.0, 0.5, 0.25])):
        given_direction = None if direction is NORMAL else direction
        matrix = tf.projection_matrix(POINT, NORMAL, given_direction)
        for start in ([4.0, 5.0, 6.0], [-1.0, 0.0, 2.0]):
            end = moved(matrix, start)
            assert (end - POINT) @ unit == pytest.approx(0)
            assert np.cross(end - start, direction) == pytest.approx([0, 0, 0], abs=1e-9)


@pytest.mark.parametrize("pseudo", [False, True])
def test_projection_keeps_points_on_the_line_of_sight(pseudo: bool) -> None:
    eye, unit = np.array([5.0, 6.0, -7.0]), NORMAL / 3
    matrix = tf.projection_matrix(POINT, NORMAL, perspective=eye, pseudo=pseudo)
    start = np.array([2.0, 0.0, 1.0])
    end = moved(matrix, start)
    if pseudo:  # relative depth is kept: not in the plane, but on the normal above the projection
        flat = moved(tf.projection_matrix(POINT, NORMAL, perspective=eye), start)
        assert np.cross(end - flat, unit) == pytest.approx([0, 0, 0], abs=1e-9)
        assert np.linalg.norm(end - flat) > 0.01
        assert moved(matrix, POINT) == pytest.approx(POINT)
    else:
        assert (end - POINT) @ unit == pytest.approx(0)
        assert np.cross(end - eye, start - eye) == pytest.approx([0, 0, 0], abs=1e-9)


@pytest.mark.parametrize("perspective", [False, True])
def test_clip_matrix_maps_the_frustum_to_a_cube(perspective: bool) -> None:
    left, right, bottom, top, near, far = -1.0, 3.0, -2.0, 5.0, 2.0, 6.0
    matrix = tf.clip_matrix(left, right, bottom, top, near, far, perspective)
    for depth, z in ((near, -1.0), (far, 1.0)):
        grown = depth / near if perspective else 1.0  # a frustum is wider at its far end
        for x_given, x in ((left, -1.0), (right, 1.0)):
            for y_given, y in ((bottom, -1.0), (top, 1.0)):
                corner = np.array([x_given * grown, y_given * grown, depth])
                assert moved(matrix, corner) == pytest.approx([x, y, z])


@pytest.mark.parametrize(
    "sides", [(1, 1, 0, 1, 1, 2), (0, 1, 1, 1, 1, 2), (0, 1, 0, 1, 2, 2), (2, 1, 0, 1, 1, 2)]
)
def test_an_empty_frustum_is_refused(sides: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="invalid frustrum"):
        tf.clip_matrix(*sides)


def test_a_perspective_frustum_begins_in_front_of_the_eye() -> None:
    with pytest.raises(ValueError, match="near <= 0"):
        tf.clip_matrix(0, 1, 0, 1, 0.0, 2, perspective=True)
    assert tf.clip_matrix(0, 1, 0, 1, 0.0, 2)[2, 2] == 1


def test_shear_moves_points_by_their_height() -> None:
    matrix = tf.shear_matrix(math.radians(30), [1, 0, 1], POINT, NORMAL)
    unit, along = NORMAL / 3, np.array([1, 0, 1]) / math.sqrt(2)
    assert moved(matrix, BESIDE) == pytest.approx(BESIDE)
    assert moved(matrix, POINT + 2 * unit) == pytest.approx(
        POINT + 2 * unit + 2 * math.tan(math.pi / 6) * along
    )
    with pytest.raises(ValueError, match="not orthogonal"):
        tf.shear_matrix(1.0, [1, 0, 0], POINT, NORMAL)


vectors = st.tuples(*[st.floats(-2, 2)] * 3)
sizes = st.tuples(*[st.floats(0.3, 3)] * 3)
turns = st.tuples(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3, 3))


@settings(max_examples=20)
@given(sizes, vectors, turns, vectors, st.tuples(*[st.floats(-0.1, 0.1)] * 3))
def test_decomposed_matrices_have_the_parts_they_were_composed_of(
    scale: Any, shear: Any, angles: Any, shift: Any, perspective: Any
) -> None:
    matrix = tf.compose_matrix(scale, shear, angles, shift)
    for found, part in zip(tf.decompose_matrix(2 * matrix), (scale, shear, angles, shift), strict=False):
        assert found == pytest.approx(part, abs=1e-6)
    mirrored = tf.compose_matrix([-part for part in scale], shear, angles, shift)
    assert tf.decompose_matrix(mirrored)[0] == pytest.approx([-part for part in scale], abs=1e-6)
    bent = tf.compose_matrix(scale, shear, angles, shift, [*perspective, 1.0])
    if abs(bent[3, 3]) > 1e-3:
        assert tf.compose_matrix(*tf.decompose_matrix(bent)) == pytest.approx(bent, abs=1e-6)


def test_composed_matrix_applies_parts_from_the_right() -> None:
    assert moved(tf.compose_matrix(scale=[2, 3, 4]), [1, 1, 1]).tolist() == [2, 3, 4]
    assert moved(tf.compose_matrix(shear=[1, 2, 4]), [1, 1, 1]).tolist() == [4, 5, 1]
    assert moved(tf.compose_matrix(shear=[1, 2, 4], scale=[2, 3, 4]), [1, 1, 1]).tolist() == [13, 19, 4]
    quarter = [0, 0, math.pi / 2]
    assert moved(tf.compose_matrix([2, 1, 1], None, quarter, [5, 0, 0]), [1, 0, 0]) == pytest.approx(
        [5, 2, 0]
    )
    assert moved(tf.compose_matrix(perspective=[0, 0, 1, 1]), [2, 4, 3]) == pytest.approx([0.5, 1, 0.75])


def test_singular_matrices_cannot_be_decomposed() -> None:
    with pytest.raises(ValueError, match="zero"):
        tf.decompose_matrix(np.diag([1.0, 1, 1, 0]))
    with pytest.raises(ValueError, match="singular"):
        tf.decompose_matrix(np.diag([1.0, 1, 0, 1]))


def test_cells_of_crystals_become_orthogonal() -> None:
    """The columns of the transposed matrix are the edges: their lengths and angles are the given ones."""
    lengths, angles = (5.0, 6.0, 7.0), (80.0, 95.0, 110.0)
    edges = tf.orthogonalization_matrix(lengths, angles)[:3, :3].T
    assert np.linalg.norm(edges, axis=1) == pytest.approx(lengths)
    for angle, one, other in zip(
        angles, (edges[1], edges[0], edges[0]), (edges[2], edges[2], edges[1]), strict=True
    ):
        assert one @ other / np.linalg.norm(one) / np.linalg.norm(other) == pytest.approx(
            math.cos(math.radians(angle))
        )
    assert tf.orthogonalization_matrix((1, 1, 1), (90, 90, 90)) == pytest.approx(np.identity(4))


@pytest.mark.parametrize("scaling", [False, True])
def test_the_superimposition_matrix_moves_points_onto_their_targets(scaling: bool) -> None:
    points = np.random.default_rng(5).normal(size=(3, 7)) * [[1], [2], [3]] + [[1], [2], [3]]
    factor = 2.5 if scaling else 1.0
    matrix = tf.translation_matrix([1, -2, 3]) @ tf.euler_matrix(0.3, 0.2, -1.0) @ tf.scale_matrix(factor)
    targets = (matrix @ np.vstack([points, np.ones(7)]))[:3]
    assert tf.superimposition_matrix(points, targets, scaling=scaling) == pytest.approx(matrix)
    mirrored = tf.superimposition_matrix(points, points * [[-1], [1], [1]])
    assert np.linalg.det(mirrored[:3, :3]) == pytest.approx(
        1
    )  # a rotation also where a mirror would fit better


def test_random_rotations_are_determined_by_three_numbers() -> None:
    found = tf.random_quaternion([0.36, 0.25, 0.5])
    assert found == pytest.approx([0.8, 0.0, 0.0, -0.6])
    assert tf.random_rotation_matrix([0.36, 0.25, 0.5]) == pytest.approx(tf.quaternion_matrix(found))
    assert np.linalg.norm(tf.random_quaternion()) == pytest.approx(1)
    assert tf.random_vector(4).shape == (4,)
    assert ((tf.random_vector(100) >= 0) & (tf.random_vector(100) < 1)).all()


def test_proportional_transforms_are_the_same() -> None:
    matrix = tf.euler_matrix(0.1, 0.2, 0.3)
    assert tf.is_same_transform(matrix, -2 * matrix)
    assert not tf.is_same_transform(matrix, tf.euler_matrix(0.1, 0.2, 0.31))
