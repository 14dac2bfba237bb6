"""Instants, durations and coordinate frames, with values worked out by hand."""

from __future__ import annotations

import math
import pickle
from typing import Any

import pytest

from pytest_tarl.ros import transforms as frames
from pytest_tarl.ros.messages.times import Duration, Time
from pytest_tarl.ros.transforms import Rigid, TransformTree
from tests.plugin.ros.test_transforms import transform


def test_instants_are_kept_in_whole_seconds_and_nanoseconds() -> None:
    assert [(t.secs, t.nsecs) for t in (Time(1, 2_500_000_000), Time(1.25), Time(2, -1), Duration(-0.25))] == [
        (3, 500_000_000), (1, 250_000_000), (1, 999_999_999), (-1, 750_000_000)
    ]  # fmt: skip
    assert (Time.from_sec(2.5).to_nsec(), Duration.from_sec(-2.5).to_sec()) == (2_500_000_000, -2.5)
    changed = Duration()
    changed.set(1, 3_200_000_000)
    assert (changed.secs, changed.nsecs) == (1, 3_200_000_000)
    changed.canon()
    assert (changed.secs, changed.nsecs) == (4, 200_000_000)
    with pytest.raises(ValueError, match="nsecs cannot be set"):
        Time(1.5, 1)
    with pytest.raises(TypeError, match="must be positive"):
        Time(-1)
    assert (str(Time(1, 5)), repr(Duration(1, 5))) == ("1000000005", "genpy.Duration[1000000005]")


def test_instants_and_durations_are_added_and_subtracted() -> None:
    assert Time(3, 1) - Time(1, 2) == Duration(1, 999_999_999)
    assert Time(3, 1) - Duration(1, 2) == Time(1, 999_999_999)
    assert Time(3, 1) + Duration(1, 999_999_999) == Duration(1, 999_999_999) + Time(3, 1) == Time(5)
    assert Duration(1, 5) + Duration(2, 6) == Duration(3, 11)
    assert Duration(1, 5) - Duration(2, 6) == -Duration(1, 1)
    assert (abs(Duration(-1, 0)), abs(Duration(1))) == (Duration(1), Duration(1))
    for wrong in (
        lambda: Time(1) + Time(1),
        lambda: Time(1) - 1,
        lambda: Duration(1) - Time(1),
        lambda: Duration(1) + 1,
    ):
        with pytest.raises(TypeError):
            wrong()


def test_durations_are_multiplied_and_divided() -> None:
    length = Duration(7, 500_000_000)
    assert (length * 2, 2 * length, length * 0.5) == (Duration(15), Duration(15), Duration(3, 750_000_000))
    assert (length / 2, length / Duration(3), length // 2) == (Duration(3, 750_000_000), 2.5, Duration(3))
    assert (length // Duration(2), length % Duration(2)) == (3, Duration(1, 500_000_000))
    assert divmod(length, Duration(2)) == (3, Duration(1, 500_000_000))
    for wrong in (lambda: length % 2, lambda: divmod(length, 2), lambda: length * "2", lambda: length / "2"):
        with pytest.raises(TypeError):
            wrong()


def test_instants_are_ordered_hashed_and_pickled_by_their_value() -> None:
    early, late = Time(1, 999_999_999), Time(2)
    assert early < late
    assert early <= late
    assert early <= Time(1, 999_999_999)
    assert late > early
    assert late >= early
    assert late >= Time(2)
    for order in (early > late, early >= late, late < early, late <= early, late < Time(2), late > Time(2)):
        assert order is False
    assert early != late
    assert Time(1) != Duration(1)
    assert len({Time(1), Time(0, 10**9), Time(2)}) == 2
    assert pickle.loads(pickle.dumps(early)) == early
    assert [bool(one) for one in (Time(), Time(1), Time(0, 1))] == [False, True, True]
    assert [one.is_zero() for one in (Time(), Time(1), Time(0, 1))] == [True, False, False]
    with pytest.raises(TypeError):
        _ = Time(1) < Duration(2)


def put(
    tree: TransformTree, parent: str, child: str, seconds: float, x: float, yaw: float = 0.0, **how: Any
) -> None:
    """Add a transform; static if it has no time of its own."""
    message = transform(parent, child, seconds, x, yaw)
    tree.add(message, round(seconds * 1e9), static=how.pop("static", False), **how)


def test_poses_follow_the_tree_up_and_down() -> None:
    tree = TransformTree()
    put(tree, "map", "odom", 1.0, 10.0)
    put(tree, "odom", "base", 1.0, 2.0, math.pi / 2)
    put(tree, "base", "laser", 0.0, 0.5, static=True)
    put(tree, "map", "other", 1.0, 1.0)
    pose, time = tree.look_up("map", "laser", 0)
    assert (pose.apply((1.0, 0.0, 0.0)), time) == (pytest.approx((12.0, 1.5, 0.0)), 10**9)
    back, _ = tree.look_up("laser", "map", 0)
    assert back.apply((12.0, 1.5, 0.0)) == pytest.approx((1.0, 0.0, 0.0))
    assert tree.look_up("other", "odom", 10**9)[0].translation == pytest.approx((9.0, 0.0, 0.0))
    assert tree.look_up("base", "base", 0) == (Rigid(), 0)
    assert tree.look_up("base", "laser", 5) == (Rigid((0.5, 0.0, 0.0)), 5)


def test_latest_common_time_is_the_oldest_transform_on_the_way() -> None:
    tree = TransformTree()
    for seconds in (1.0, 2.0, 3.0):
        put(tree, "map", "odom", seconds, seconds)
    for seconds in (1.0, 2.0):
        put(tree, "odom", "base", seconds, 10 * seconds)
    pose, time = tree.look_up("map", "base", 0)
    assert (pose.translation[0], time) == (22.0, 2 * 10**9)


def test_poses_between_two_instants_are_interpolated() -> None:
    tree = TransformTree()
    put(tree, "map", "base", 4.0, 8.0, 1.2)
    put(tree, "map", "base", 2.0, 4.0, 0.4)  # messages may arrive late
    pose, _ = tree.look_up("map", "base", int(2.5e9))
    assert pose.translation[0] == pytest.approx(5.0)
    assert 2 * math.atan2(pose.rotation[2], pose.rotation[3]) == pytest.approx(0.6)
    assert tree.look_up("map", "base", int(2e9))[0].translation[0] == 4.0
    for seconds, words in ((1.0, "past.*1.000000 but the earliest data is at time 2.0"),
                           (4.5, "future.*4.500000 but the latest data is at time 4.0")):  # fmt: skip
        with pytest.raises(frames.ExtrapolationException, match=words):
            tree.look_up("map", "base", round(seconds * 1e9))


def test_poses_older_than_the_cache_are_forgotten() -> None:
    tree = TransformTree(cache=2 * 10**9)
    for seconds in (1.0, 2.0, 3.0, 4.0):
        put(tree, "map", "base", seconds, seconds)
    assert tree.edges["base"].times == [2 * 10**9, 3 * 10**9, 4 * 10**9]
    assert set(tree.edges["base"].poses) == set(tree.edges["base"].times)


def test_a_second_pose_at_an_instant_replaces_the_first() -> None:
    tree = TransformTree()
    for x in (1.0, 2.0):
        put(tree, "map", "base", 1.0, x, authority=f"node {x:g}")
    assert (tree.edges["base"].times, tree.look_up("map", "base", 0)[0].translation[0]) == ([10**9], 2.0)
    assert tree.authorities == {"base": "node 2"}
    put(tree, "map", "laser", 5.0, 1.0, static=True)
    put(tree, "map", "laser", 3.0, 2.0, static=True)
    assert tree.look_up("map", "laser", 10**9)[0].translation[0] == 2.0


@pytest.mark.parametrize("static", [False, True])
def test_frame_leaves_its_former_parent(static: bool) -> None:
    tree = TransformTree()
    put(tree, "map", "base", 1.0, 1.0)
    put(tree, "odom", "base", 2.0, 2.0, static=static)
    assert tree.look_up("odom", "base", 2 * 10**9)[0].translation[0] == 2.0
    with pytest.raises(frames.LookupException, match='"map" passed'):
        tree.look_up("map", "base", 0)


def test_invalid_transforms_are_refused() -> None:
    def add(parent: str, child: str, w: float = 1.0) -> None:
        message: Any = transform(parent, child, 1.0, 0.0)
        message.transform.rotation.w = w
        TransformTree().add(message, 1, static=False)

    add("/map", "base", 1.009)
    for wrong in (
        ("map", "map"),
        ("", "base"),
        ("map", ""),
        ("map", "/map"),
        ("map", "base", 1.02),
        ("map", "base", 0.98),
    ):
        with pytest.raises(frames.InvalidArgumentException, match="must differ and have names"):
            add(*wrong)


def test_unknown_and_unconnected_frames_are_distinguished() -> None:
    tree = TransformTree()
    put(tree, "map", "base", 1.0, 1.0)
    put(tree, "world", "arm", 1.0, 1.0)
    with pytest.raises(frames.ConnectivityException, match="between 'map' and 'arm'"):
        tree.look_up("map", "arm", 0)
    with pytest.raises(frames.LookupException, match='"nowhere"'):
        tree.look_up("map", "nowhere", 0)
    for name in ("", "/map"):
        with pytest.raises(frames.InvalidArgumentException, match="cannot be empty"):
            tree.look_up(name, "base", 0)


def test_frame_loop_does_not_hang() -> None:
    tree = TransformTree()
    put(tree, "a", "b", 1.0, 1.0)
    put(tree, "b", "a", 1.0, 1.0)
    put(tree, "c", "d", 1.0, 1.0)
    with pytest.raises(frames.ConnectivityException):
        tree.look_up("a", "d", 0)


def test_interpolation_takes_the_shorter_arc() -> None:
    start, end = (
        (0.0, 0.0, 0.0, 1.0),
        (0.0, 0.0, -math.sin(0.5), -math.cos(0.5)),
    )  # 1 rad, with the other sign
    found = frames.slerp(start, end, 0.25)
    assert 2 * math.atan2(found[2], found[3]) == pytest.approx(0.25)
    near = (0.0, 0.0, 1e-8, 1.0)
    assert (frames.slerp(start, near, 0.5), frames.slerp(start, near, 0.6)) == (start, near)
