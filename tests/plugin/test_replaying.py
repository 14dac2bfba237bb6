"""Replaying a bag: which messages are latched, and at which time a node receives each message."""

from __future__ import annotations

import pytest

from pytest_tarl.bags.salvage import _transient
from tests.plugin.missions import mission, write_bag
from tests.plugin.tank import RECORD, changed


@pytest.mark.parametrize(
    ("profiles", "latched"),
    [
        ("- history: 3\n  durability: 1\n", True),
        ("- history: keep_last\n  durability: transient_local\n", True),
        ("- history: 1\n  durability: 2\n", False),
        ("- history: keep_last\n  durability: volatile\n", False),
        ("", False),
    ],
)
def test_durability_comes_from_the_bag(profiles: str, latched: bool) -> None:
    assert _transient(profiles) is latched


def test_messages_arrive_at_recorded_times(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    changed(tank, "test_tank", "    drifts={", "    monitor=lambda moment: 0.0,\n    drifts={")
    bag = write_bag(
        tank.path / "uneven.mcap", ((1.3 * time, messages) for time, messages in mission(1.0, 0, steps=5))
    )
    heard = "    with open('heard', 'a') as file:\n        file.write(f'{rospy.get_time()}\\n')\n    level = msg.data"
    changed(tank, "keeper", "    level = msg.data", heard)
    tank.runpytest("--tarl-online", f"--tarl-bag={bag}")
    times = [float(one) for one in (tank.path / "heard").read_text().split()]
    assert [later - times[0] for later in times] == pytest.approx([0.0, 0.13, 0.26, 0.39, 0.52])
