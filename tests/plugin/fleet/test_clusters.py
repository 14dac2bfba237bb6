"""Robots with similar drifts form a cluster with their common cells; noise alone does not split a cluster."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pytest_tarl.fleet import ingest
from pytest_tarl.fleet.clusters import of
from pytest_tarl.fleet.ingest import Order
from pytest_tarl.fleet.question import Question, answer
from pytest_tarl.fleet.residual_maps import ResidualMap
from tests.plugin.monitoring import missions

CELLS = tuple((n,) for n in range(12))


def maps(seed: int, kinds: list[dict[int, float]], each: int) -> list[ResidualMap]:
    """Draw residual maps of robots; robots of one kind have the same true residuals, with different noise."""
    rng = np.random.default_rng(seed)
    found = []
    for kind, true in enumerate(kinds):
        for n in range(each):
            variance = rng.uniform(0.001, 0.01, len(CELLS))
            mean = rng.normal([true.get(cell, 0.0) for cell in range(len(CELLS))], np.sqrt(variance))
            unseen = rng.random(len(CELLS)) < 0.1
            unseen[list(true)] = False
            mean[unseen] = np.nan
            found.append(ResidualMap(f"k{kind}r{n}", mean, np.where(np.isnan(mean), np.nan, variance)))
    rng.shuffle(found)  # type: ignore[arg-type]
    return found


@pytest.mark.parametrize("seed", range(5))
def test_robots_with_the_same_drift_form_a_cluster(seed: int) -> None:
    kinds = [{3: -1.0, 4: -1.0}, {7: -1.0}, {7: 1.0}]
    found = of(maps(seed, kinds, 6), np.full(len(CELLS), 1e-4), CELLS, 0.05)
    large = [one for one in found.found if len(one.robots) >= 3]
    assert sorted({name[1] for one in large for name in one.robots}) == ["0", "1", "2"]
    for one in found.found:
        assert len({name[1] for name in one.robots}) == 1
    assert len(found.found) <= 4  # six noisy robots of one kind rarely form several clusters
    for one in large:
        kind = kinds[int(one.robots[0][1])]
        told = dict(zip(one.cells, one.residuals, strict=True))
        assert {(cell,) for cell in kind} <= told.keys()
        assert all(told[(cell,)] == pytest.approx(true, abs=0.2) for cell, true in kind.items())


def test_the_order_of_the_robots_does_not_matter() -> None:
    some = maps(3, [{1: -0.5}, {1: -0.5, 5: 0.6}], 5)
    assert of(some, np.zeros(12), CELLS, 0.05) == of(some[::-1], np.zeros(12), CELLS, 0.05)


def test_robots_without_a_clear_cell_join_no_cluster() -> None:
    found = of(maps(1, [{}, {2: -1.5}], 4), np.zeros(12), CELLS, 1e-4)
    assert found.unclear == ("k0r0", "k0r1", "k0r2", "k0r3")
    assert {name for one in found.found for name in one.robots} == {"k1r0", "k1r1", "k1r2", "k1r3"}
    assert of([], np.zeros(12), CELLS, 0.05).found == ()


def test_robots_with_a_common_drift_form_a_cluster(tmp_path: Path) -> None:
    missions.fixture(tmp_path / "test.npz", missions.walks(120, 1))
    logs = []
    for robot in range(4):
        walks = missions.walks(20, 10 + robot) + missions.walks(60, 50 + robot, float(robot < 2))
        logs.append(missions.log(tmp_path / f"r{robot}" / "missions.log", walks, 1e9))
    order = Order(tuple(logs), str(tmp_path / "data"), tmp_path / "test.npz", "{folder}")
    assert not [one.problem for one in ingest.ingest(order) if one.problem]
    found = answer(Question(str(tmp_path / "data"), by=())).clusters
    (cluster,) = found.found
    assert cluster.robots == ("r0", "r1")
    assert {cell[0] for cell in cluster.cells} == {2}
    assert all(one == pytest.approx(-0.8, abs=0.2) for one in cluster.residuals)
