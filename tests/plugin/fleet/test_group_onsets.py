"""The onset of a group comes from a watch over all missions of the group in the order of their times."""

from __future__ import annotations

import pytest

from pytest_tarl.fleet import changed_robots, ingest
from pytest_tarl.fleet.ingest import Order
from pytest_tarl.fleet.question import Question, answer
from tests.plugin.monitoring import missions

ROBOTS, EACH, BEGINS = 10, 30, 20


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return a data set in which a season at one of two sites changes the last missions of its robots a little."""
    folder = tmp_path_factory.mktemp("seasons")
    missions.fixture(folder / "test.npz", missions.walks(120, 1))
    for first, site, season in ((100, "north", 0.0), (200, "south", 0.3)):
        logs = []
        for robot in range(first, first + ROBOTS):
            walks = missions.walks(BEGINS, robot) + missions.walks(EACH - BEGINS, robot + 50, season)
            logs.append(missions.log(folder / f"{site}{robot}.log", walks, 1e9 + robot / 100))
        order = Order(tuple(logs), str(folder / "data"), folder / "test.npz", "{file}", "1", site)
        assert not [one.problem for one in ingest.ingest(order) if one.problem]
    return str(folder / "data")


def test_small_change_is_detected_for_a_whole_site(data: str) -> None:
    found = answer(Question(data, by=("site",)))
    assert {one.name for one in (*found.onsets.drifted, *found.onsets.below)} == {"south"}
    assert found.meets("changed")
    assert not found.meets("robot")
    evidence = found.onsets.every[1].status.world  # type: ignore[union-attr]
    assert evidence.since is not None
    assert evidence.since.time == pytest.approx(1e9 + BEGINS, abs=4)  # one mission per robot and second


def test_group_of_one_has_the_evidence_of_its_robot(data: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(changed_robots, "PORTION", 7)
    found = answer(Question(data, by=("robot",), robot="south203"))
    assert found.onsets.every == found.robots.every
