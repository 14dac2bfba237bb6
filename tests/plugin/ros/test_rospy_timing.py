"""rospy's rates, timers and sleeps: the virtual times at which each of them wakes."""

from __future__ import annotations

from typing import Any

import pytest

from tests.plugin.ros.conftest import Start

HEAD = "import rospy\nrospy.init_node('n')\nlog = []\n"


def run(start: Start, code: str, seconds: float = 10.0) -> Any:
    """Run a node; return the numbers that it logged."""
    ros = start(HEAD + code)
    ros.step(seconds)
    return ros.namespace["log"]  # type: ignore[attr-defined]


LOOP = """
rate = rospy.Rate(2)
for spent in {spent}:
    rospy.sleep(spent)
    log.append((rate.remaining().to_sec(), rate.last_time.to_sec()))
    rate.sleep()
    log[-1] += (rospy.get_time(),)
"""


@pytest.mark.parametrize(
    ("spent", "expected"),
    [
        ([0.2, 0.3], [(0.3, 0.0, 0.5), (0.2, 0.5, 1.0)]),
        ([0.5, 0.1], [(0.0, 0.0, 0.5), (0.4, 0.5, 1.0)]),
        ([0.7, 0.1], [(-0.2, 0.0, 0.7), (0.2, 0.5, 1.0)]),  # late: the phase is kept
        ([1.5, 0.1], [(-1.0, 0.0, 1.5), (-0.6, 0.5, 1.6)]),  # two cycles late: caught up
        ([1.6, 0.1], [(-1.1, 0.0, 1.6), (0.4, 1.6, 2.1)]),  # later: a new phase
    ],
)
def test_rate_keeps_its_phase_for_up_to_two_cycles(
    start: Start, spent: list[float], expected: list[tuple[float, ...]]
) -> None:
    assert run(start, LOOP.format(spent=spent)) == [pytest.approx(one, abs=1e-6) for one in expected]


def test_the_length_of_a_cycle_is_known(start: Start) -> None:
    assert run(start, "log.append(rospy.Rate(8).sleep_dur.to_sec())") == [0.125]


EVENTS = """
def told(event):
    log.append(tuple(None if one is None else one.to_sec() for one in (
        event.last_expected, event.last_real, event.current_expected, event.current_real)) + (event.last_duration,))
    rospy.sleep(spent.pop(0) if spent else 0)
"""


def test_timer_reports_planned_and_actual_times(start: Start) -> None:
    code = f"spent = [0.2, 1.5]\n{EVENTS}timer = rospy.Timer(rospy.Duration(1.0), told)\nrospy.spin()"
    assert run(start, code, 4.5) == [
        (None, None, 1.0, 1.0, None),
        (1.0, 1.0, 2.0, 2.0, pytest.approx(0.2)),
        (2.0, 2.0, 3.0, 3.5, pytest.approx(1.5)),  # late, because the callback was busy
        (3.0, 3.5, 4.0, 4.0, pytest.approx(0.0)),
    ]


def test_late_timer_starts_anew(start: Start) -> None:
    code = f"spent = [3.5]\n{EVENTS}rospy.Timer(rospy.Duration(1.0), told)\nrospy.spin()"
    times = [(planned, real) for _, _, planned, real, _ in run(start, code, 6.6)]
    assert times == [(1.0, 1.0), (4.5, 4.5), (5.5, 5.5), (6.5, 6.5)]


def test_timer_fires_once_or_until_shutdown(start: Start) -> None:
    log = run(start, """
once = rospy.Timer(rospy.Duration(1.0), lambda event: log.append("once"), oneshot=True)
often = rospy.Timer(rospy.Duration(1.0), lambda event: log.append("often"))
log.append((once.is_alive(), often.is_alive()))
rospy.sleep(3.5)
often.shutdown()
log.append((once.is_alive(), often.is_alive()))
rospy.sleep(3.0)
log.append("end")
""")  # fmt: skip
    assert log == [(True, True), "once", "often", "often", "often", (False, False), "end"]


def test_joining_a_timer_waits_for_its_end(start: Start) -> None:
    log = run(start, """
timer = rospy.Timer(rospy.Duration(2.0), lambda event: None)
timer.join(3.0)
log.append(rospy.get_time())
once = rospy.Timer(rospy.Duration(2.0), lambda event: None, oneshot=True)
once.join()
log.append((once.is_alive(), rospy.get_time() >= 5.0))
once.join(1.0)
log.append(rospy.get_time() < 8.0)
""")  # fmt: skip
    assert log == [3.0, (False, True), True]


@pytest.mark.parametrize("period", [0.0, -1.0])
def test_a_timer_needs_a_positive_period(start: Start, period: float) -> None:
    log = run(start, f"""
try:
    rospy.Timer(rospy.Duration({period}), print)
except ValueError as error:
    log.append(str(error))
""")  # fmt: skip
    assert log == [f"a timer needs a period above zero, not {period} s"]


def test_negative_sleeps_return_immediately(start: Start) -> None:
    log = run(start, """
for span in (0.5, rospy.Duration(0.25), 0, -1.0, rospy.Duration(-1), 2):
    rospy.sleep(span)
    log.append(rospy.get_time())
rospy.rostime.wallsleep(1.0)
rospy.rostime.wallsleep(-1.0)
log.append(rospy.rostime.wallclock())
log.append((rospy.get_rostime(), rospy.Time.now().to_sec(), rospy.Time.from_seconds(1.5).to_nsec()))
log.append((rospy.rostime.is_wallclock(), rospy.rostime.is_rostime_initialized()))
log.append([repr(one) for one in (rospy.Time(1, 5), rospy.Duration(1, 5))])
""")  # fmt: skip
    assert log[:6] == [0.5, 0.75, 0.75, 0.75, 0.75, 2.75]
    assert log[6] == 3.75
    assert (log[7][0].to_sec(), *log[7][1:]) == (3.75, 3.75, 1_500_000_000)
    assert log[8:] == [(False, True), ["rospy.Time[1000000005]", "rospy.Duration[1000000005]"]]
