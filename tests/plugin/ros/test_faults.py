"""The effect of each fault of topics and nodes on the messages, and its dependence on the seed."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl import faults
from pytest_tarl.errors import SettingsError
from pytest_tarl.faults.installing import Faults
from pytest_tarl.faults.message_numbers import altered
from pytest_tarl.ros import Ros, message_type
from pytest_tarl.seeds import generator
from pytest_tarl.spaces import Choice, Fault
from tests.plugin.ros.conftest import Start

Float64 = message_type("std_msgs/Float64")
Int32 = message_type("std_msgs/Int32")
Vector3 = message_type("geometry_msgs/Vector3")
LaserScan = message_type("sensor_msgs/LaserScan")

REPEATER = """
    import rospy
    from std_msgs.msg import Float64

    def callback(message):
        global known
        known += 1
        out.publish(100.0 * known + message.data)

    known = 0
    rospy.init_node("repeater")
    out = rospy.Publisher("out", Float64, queue_size=10)
    rospy.Subscriber("in", Float64, callback)
    rospy.spin()
"""


def through(fault: Fault, size: float, values: Sequence[float], seed: int = 1) -> list[tuple[float, float]]:
    """Return times and values that a subscriber receives if a value is published every 0.1 s."""
    ros = Ros()
    heard: list[tuple[float, float]] = []
    ros.on_delivery(lambda _, message: heard.append((round(ros.now, 6), message.data)))
    fault.install(ros, "f", size, generator(seed, "f"))
    for value in values:
        ros.bus.publish("/in", Float64(data=value))
        ros.step(0.1)
    ros.step(5.0)
    ros.close()
    return heard


def values(fault: Fault, size: float, sent: Sequence[float], seed: int = 1) -> list[float]:
    return [value for _, value in through(fault, size, sent, seed)]


def test_each_fault_of_numbers_changes_the_field_as_defined() -> None:
    assert values(faults.bias("/in", "data", -1, 1), 0.5, [1, 2]) == [1.5, 2.5]
    assert values(faults.scale("/in", "data", 0, 2), 0.5, [1, 2]) == [0.5, 1.0]
    assert values(faults.sign("/in", "data"), 1.0, [1, -2]) == [-1, 2]
    assert values(faults.quantisation("/in", "data", 1), 0.25, [0.3, 0.4, 1.0]) == [0.25, 0.5, 1.0]
    assert np.isinf(values(faults.quantisation("/in", "data", 1), 0.25, [np.inf])).all()


def test_the_standard_deviation_of_noise_is_its_size() -> None:
    found = np.array(values(faults.noise("/in", "data", 1.0), 0.2, [0.0] * 400))
    assert 0.17 < found.std() < 0.23
    assert abs(found.mean()) < 0.05


def test_fault_size_is_the_share_of_messages() -> None:
    sent = [float(i) for i in range(400)]
    kept = values(faults.dropout("/in", 1.0), 0.3, sent)
    assert kept == sorted(kept)
    assert 240 < len(kept) < 320
    assert values(faults.dropout("/in", 1.0), 1.0, sent) == []
    twice = values(faults.duplicates("/in", 1.0), 0.3, sent)
    assert twice == sorted(twice)
    assert 480 < len(twice) < 560


def test_reordered_messages_arrive_after_their_successor() -> None:
    sent = [float(i) for i in range(100)]
    found = values(faults.reordering("/in", 1.0), 0.4, sent)
    assert sorted(found) in (sent, sent[:-1])  # the last message may still wait for a successor
    swaps = sum(a > b for a, b in pairwise(found))
    assert 15 < swaps < 50
    assert values(faults.reordering("/in", 1.0), 1.0, [1, 2, 3, 4]) == [2, 1, 4, 3]


def test_frozen_topic_repeats_for_the_given_time() -> None:
    sent = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert values(faults.freeze("/in", 9.0, at=0.15), 0.2, sent) == [1.0, 2.0, 2.0, 2.0, 5.0, 6.0]
    assert values(faults.freeze("/in", 9.0), 9.0, sent) == [1.0] * 6


def test_late_messages_arrive_in_order_at_their_time() -> None:
    assert through(faults.latency("/in", 1.0), 0.25, [1, 2, 3]) == [(0.25, 1), (0.35, 2), (0.45, 3)]
    found = through(faults.jitter("/in", 1.0), 0.5, [float(i) for i in range(40)])
    assert [value for _, value in found] == [float(i) for i in range(40)]
    delays = [time - 0.1 * value for time, value in found]
    assert min(delays) >= -1e-9
    assert 0.3 < max(delays) <= 0.5 + 1e-9


def test_swapped_axes_exchange_two_fields() -> None:
    ros = Ros()
    heard: list[Any] = []
    ros.on_delivery(lambda _, message: heard.append((message.x, message.y)))
    faults.swapped("/in", "x", "y").install(ros, "f", 1.0, generator(1, "f"))
    ros.bus.publish("/in", Vector3(x=1.0, y=2.0))
    assert heard == [(2.0, 1.0)]


def test_faults_apply_to_received_and_sent_messages(start: Start) -> None:
    ros = start(REPEATER)
    faults.bias("/in", "data", 0, 1).install(ros, "a", 1.0, generator(1, "a"))
    faults.latency("/out", 1.0).install(ros, "b", 0.15, generator(1, "b"))
    heard: list[float] = []
    ros.bus.subscribe("/out", lambda message: heard.append(message.data))
    ros.bus.publish("/in", Float64(data=1.0))
    ros.step(0.1)
    assert (heard, ros.bus.latest("/out")) == ([], None)
    ros.step(0.1)
    assert heard == [102.0]
    assert ros.bus.latest("/out").data == 102.0


def test_a_restarted_node_has_lost_its_state(start: Start) -> None:
    ros = start(REPEATER)
    ((process),) = ros.processes
    heard: list[tuple[float, float]] = []
    ros.bus.subscribe("/out", lambda message: heard.append((round(ros.now, 3), message.data)))
    faults.restart(process.name, 5.0, at=0.25).install(ros, "f", 0.3, generator(1, "f"))
    for _ in range(8):
        ros.bus.publish("/in", Float64(data=1.0))
        ros.step(0.1)
    assert heard == [(0.0, 101.0), (0.1, 201.0), (0.2, 301.0), (0.6, 101.0), (0.7, 201.0)]


@given(st.integers(0, 2**63 - 1), st.floats(0.01, 1.0))
def test_the_seed_determines_all_random_faults(seed: int, size: float) -> None:
    sent = [float(i) for i in range(8)]
    for make in (faults.dropout, faults.duplicates, faults.reordering, faults.jitter):
        fault = make("/in", 1.0)
        assert through(fault, size, sent, seed) == through(fault, size, sent, seed)
    noise = faults.noise("/in", "data", 1.0)
    assert values(noise, size, sent, seed) == values(noise, size, sent, seed) != sent


def test_integer_sequences_stay_integer_when_every_element_changes() -> None:
    scan = LaserScan(ranges=[1.0, 2.0])
    assert list(altered(scan, "ranges", lambda x: x + 1).ranges) == [2.0, 3.0]
    assert list(altered(scan, "ranges.1", lambda x: x + 1).ranges) == [1.0, 3.0]
    assert list(scan.ranges) == [1.0, 2.0]
    assert altered(Int32(data=3), "data", lambda x: x * 0.5).data == 2


@pytest.mark.parametrize("field", ["nothing", "header.frame_id", "ranges.7"])
def test_a_field_without_numbers_is_refused(field: str) -> None:
    ros = Ros()
    faults.bias("/scan", field, 0, 1).install(ros, "f", 1.0, generator(1, "f"))
    with pytest.raises(SettingsError, match=f"has no number '{field}'"):
        ros.bus.publish("/scan", LaserScan(ranges=[1.0]))


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: faults.bias("/a", "data", 1, 0), "the smaller one first"),
        (lambda: faults.bias("/a", "data", 0.1, 0.5), "must include 0"),
        (lambda: faults.scale("/a", "data", 0.1, 0.5), "must include 1"),
        (lambda: faults.noise("/a", "data", 0), "above 0, got 0"),
        (lambda: faults.dropout("/a", 1.5), "at most 1, got 1.5"),
        (lambda: faults.latency("/a", "x"), "above 0, at most 1e.09, got 'x'"),
        (lambda: faults.latency(3, 1.0), "give the topic as text"),  # type: ignore[arg-type]
        (lambda: faults.sign("/a", ""), "give the field as text"),
        (lambda: faults.freeze("/a", 1.0, at=-1), "at must be a moment"),
        (lambda: faults.restart("node", 1.0, at=0), "at must be a moment"),
        (lambda: faults.restart("", 1.0, at=1), "name the node"),
    ],
)
def test_invalid_arguments_are_refused(make: Any, told: str) -> None:
    with pytest.raises(SettingsError, match=told):
        make()


def test_missing_fault_target_is_refused() -> None:
    ros = Ros()
    ros.bus.publish("/level", Float64(data=1.0))
    lost, gone = faults.dropout("/levle", 1.0), faults.restart("kepeer", 1.0, at=1)
    with pytest.raises(SettingsError, match=r"no message was published on /levle; the topics .* are /level"):
        Faults({"link": lost}).check(ros)
    with pytest.raises(SettingsError, match="no node was started as 'kepeer'; the nodes are none"):
        Faults({"crash": gone}).check(ros)
    Faults({"link": lost}, {"link": (lost, 0.5)}).check(ros)


def test_each_fault_has_a_file_and_a_row_in_the_docs() -> None:
    folder = Path(faults.__file__).parent
    table = (folder.parents[1] / "docs" / "faults.md").read_text("utf-8")
    for name in faults.__all__:
        assert (folder / f"{name}.py").exists()
        assert f"| `{name}(" in table
    off = faults.sign("/a", "data").extent
    assert isinstance(off, Choice)
    assert off.options[off.usual] is False
