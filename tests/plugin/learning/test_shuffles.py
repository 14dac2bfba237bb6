"""Shuffled sums and shifts equal the plain computation, group by group."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from pytest_tarl.learning import permutation
from pytest_tarl.learning import shifts as shifting
from pytest_tarl.learning.permutation import (
    least_p_value,
    max_statistic,
    observed_sum,
    permuted_loss,
    shuffled_sums,
)
from pytest_tarl.seeds import generator


class Tied:
    """A generator that repeats few numbers, so that rows are tied."""

    def __init__(self, seed: int) -> None:
        self.rng = generator(seed, "tied")

    def random(self, shape: tuple[int, int]) -> np.ndarray:
        return self.rng.integers(0, 3, shape) / 4


@pytest.mark.parametrize("kind", ["distinct", "tied"])
def test_each_shuffle_sums_the_rows_of_the_group(kind: str) -> None:
    for seed, (rows, first) in enumerate([(12, 5), (400, 399), (400, 1), (40, 3)]):
        draws = Tied(seed) if kind == "tied" else generator(seed, "draws")
        values = np.stack([np.ones(rows), np.arange(rows, dtype=float)], axis=1)
        sums = np.concatenate([*shuffled_sums(values, first, draws, 150)])  # type: ignore[arg-type]
        assert sums.shape == (150, 2)
        assert (sums[:, 0] == first).all()
        assert observed_sum(values, first)[1] == first * (first - 1) / 2
        if kind == "distinct":
            drawn = generator(seed, "draws").random((150, rows))
            expected = [np.argsort(one)[:first].sum() for one in drawn]
            assert sums[:, 1].tolist() == expected


def test_p_values_equal_those_of_all_shuffles() -> None:
    for seed in range(4):
        rng = generator(seed, "table")
        one, other = rng.normal(0.0, 1.0, 30), rng.normal(-0.4, 1.0, 20)
        pooled = np.concatenate((other, one))
        drawn = np.argsort(generator(seed, "labels").random((999, 50)), axis=1)[:, :20]
        sums = np.append(other.sum(), pooled[drawn].sum(axis=1))
        p_value = float((sums <= sums[0] + 1e-9).mean())
        assert permuted_loss(one, other, generator(seed, "labels")) == p_value
        columns = np.stack([pooled, rng.normal(size=50)], axis=1)
        standard = (columns - columns.mean(axis=0)) / columns.std(axis=0)
        each = np.abs(np.concatenate((standard[None, :20], standard[drawn])).sum(axis=1))
        largest = int(each[0].argmax())
        corrected = float((each.max(axis=1) >= each[0, largest] - 1e-9).mean())
        found = max_statistic(columns, 20, generator(seed, "labels"))
        assert found[largest] == pytest.approx(corrected)


def test_undecisive_shuffles_do_not_change_small_p_values(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def each(settled: float) -> list[list[float]]:
        monkeypatch.setattr(permutation, "SETTLED", settled)
        found = []
        for seed in range(30):
            rng = generator(seed, "worlds")
            one, other = rng.normal(0.0, 1.0, (40, 3)), rng.normal(-0.1 * (seed % 6), 1.0, (20, 3))
            loss = permuted_loss(one[:, 0], other[:, 0], rng, 4000)
            columns = np.concatenate((other, one))
            found.append([loss, *max_statistic(columns, 20, generator(seed, "labels"), 4000)])
        return found

    sooner, all_of_them = each(permutation.SETTLED), each(2.0)
    left_out = 0
    for few, every in zip(sooner, all_of_them, strict=True):
        if few[0] < 0.2:
            assert few[0] == every[0]
        left_out += few != every
        if min(few[1:]) < 0.2:
            assert few[1:] == every[1:]
    assert 5 < left_out < 30


@pytest.mark.parametrize(("offline", "online"), [(1, 1), (4, 2), (6, 2), (3, 3), (5, 5), (9, 1)])
def test_small_samples_are_compared_in_every_grouping(offline: int, online: int) -> None:
    for seed in range(3):
        rng = generator(seed, "small")
        one, other = rng.normal(0.0, 1.0, offline), rng.normal(-0.7, 1.0, online).round(1)
        pooled = np.concatenate((other, one))
        sums = np.array([pooled[list(rows)].sum() for rows in combinations(range(pooled.size), online)])
        wanted = (sums <= sums[0] + 1e-9).mean()
        for draws in (generator(1, "any"), generator(2, "any")):
            assert permuted_loss(one, other, draws) == pytest.approx(wanted)
            apart = np.abs(sums - sums.mean())
            both_sides = (apart >= apart[0] - 1e-9).mean()
            assert max_statistic(pooled[:, None], online, draws)[0] == pytest.approx(both_sides)


@pytest.mark.parametrize(("offline", "online"), [(6, 2), (2, 6), (9, 3), (30, 1), (11, 4)])
def test_completely_separate_samples_have_the_smallest_possible_p_value(offline: int, online: int) -> None:
    one, other = 10.0 + np.arange(offline), np.arange(online) * 1.0
    p_value = permuted_loss(one, other, generator(0, "apart"))
    assert p_value == pytest.approx(least_p_value(offline, online, permutation.PERMUTATIONS))


@pytest.mark.parametrize(("rows", "chosen"), [(5, 2), (8, 3), (40, 2)])
def test_intervals_of_shifts_enumerate_the_groups_of_small_samples(rows: int, chosen: int) -> None:
    drawn = shifting._drawn(rows, chosen, 999)
    expected = [list(one) for one in combinations(range(rows), chosen)][1:]
    assert drawn.tolist() == expected
    assert len(shifting._drawn(rows, chosen, len(expected) - 1)) == len(expected) - 1


@pytest.mark.parametrize("kind", ["normal", "binary", "skewed", "rounded"])
def test_p_value_is_invariant_under_a_shift(kind: str) -> None:
    rng = generator(3, kind)
    draw = {
        "normal": lambda size: rng.normal(5.0, 1.0, size),
        "binary": lambda size: rng.integers(0, 2, size).astype(float),
        "skewed": lambda size: rng.exponential(1e-3, size),
        "rounded": lambda size: np.rint(rng.normal(0.0, 1.0, size)),
    }[kind]
    before, after = (values - values.mean() for values in (draw(30), draw(20)))
    drawn = shifting._drawn(50, 20, 200)
    rows = np.concatenate((np.arange(20)[None, :], drawn))
    group, whole = (shifting._sums(after, before, some) for some in (rows, np.arange(50)))
    for shift in np.linspace(-1.0, 1.0, 9).tolist():
        for sign in (1.0, -1.0):
            pooled = sign * np.concatenate((after + shift, before))
            statistic = []
            for mine in rows:
                one, rest = pooled[mine], np.delete(pooled, mine)
                scale = np.sqrt(one.var(ddof=1) / one.size + rest.var(ddof=1) / rest.size)
                statistic.append((one.mean() - rest.mean()) / scale)
            expected = float((np.array(statistic) <= statistic[0] + 1e-9).mean())
            assert shifting._studentised_p(group, whole, shift, sign) == expected
