"""Drifts whose size varies: seeds from each part of the range, and the parts in which a repair holds."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import Band
from pytest_tarl.repairing import ranges
from pytest_tarl.repairing.ranges import (
    Ranged,
    _stratum,
    bands_in_words,
    fits_a_part,
    over_the_range,
    spread_seeds,
)
from pytest_tarl.searching.accept import TOO_LITTLE


def order(*parts: str, drawn: Any = None, bands: tuple[Band, ...] = ()) -> Any:
    sizes = {part: SimpleNamespace(low=1.0, high=5.0, bands=bands) for part in parts}
    return SimpleNamespace(
        comparison=SimpleNamespace(sizes=sizes),
        options=SimpleNamespace(seed=3),
        reference=SimpleNamespace(margin=1.0),
        goal=SimpleNamespace(reached=lambda run, _: run),
        drawn=drawn or {},
    )


@pytest.fixture(autouse=True)
def _sizes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the order say which sizes a seed draws; by default, a number from 1 to 5 in each part."""

    def drawn(given: Any, seed: int) -> Any:
        usual = {part: 1.0 + (seed // 7**at % 97) / 97 * 4 for at, part in enumerate(given.comparison.sizes)}
        return given.drawn.get(seed, usual)

    monkeypatch.setattr(ranges, "_drawn", drawn)


@pytest.mark.parametrize(
    ("size", "stratum"), [(1.0, 0), (1.99, 0), (2.0, 1), (3.0, 2), (3.99, 2), (4.0, 3), (5.0, 3)]
)
def test_a_single_range_is_divided_into_four_quarters(size: float, stratum: int) -> None:
    assert _stratum(order("", drawn={0: {"": size}}), 0) == stratum


@pytest.mark.parametrize(
    ("one", "two", "stratum"), [(1.0, 1.0, 0), (2.9, 3.0, 1), (3.0, 2.9, 2), (5.0, 5.0, 3), (2.0, 4.0, 1)]
)
def test_with_two_ranges_each_is_divided_into_two_halves(one: float, two: float, stratum: int) -> None:
    given = order("a", "b", "c", drawn={0: {"a": one, "b": two, "c": 1.0}})
    assert _stratum(given, 0) == stratum


@pytest.mark.parametrize("parts", [("",), ("a", "b")])
@pytest.mark.parametrize("most", [4, 10, 12])
def test_each_block_of_seeds_contains_every_stratum_once(parts: tuple[str, ...], most: int) -> None:
    given = order(*parts)
    found = spread_seeds(given, "accept", most)
    assert len(found) == len(set(found)) == most
    strata = [_stratum(given, seed) for seed in found]
    assert strata == [at % 4 for at in range(most)]


LOW, HIGH = Band("", 1.0, 3.0), Band("", 3.0, 5.0)


def acceptance(losses: dict[int, float], *, accepted: bool = True, reason: str = "") -> Any:
    """Return an acceptance test on seeds with these losses."""
    from pytest_tarl.searching.accept import Acceptance

    values: dict[str, Any] = dict.fromkeys(Acceptance.__dataclass_fields__)
    values |= {
        "accepted": accepted,
        "reason": reason,
        "seeds": tuple(losses),
        "designed": (10.0,) * len(losses),
        "drifted": tuple(SimpleNamespace(total=10.0 - loss) for loss in losses.values()),
    }
    return Acceptance(**values)


DRAWN = {1: {"": 1.0}, 2: {"": 2.0}, 3: {"": 4.0}, 4: {"": 5.0}}


@pytest.mark.parametrize(
    ("losses", "accepted", "reason", "held", "lost", "outcome"),
    [
        ({1: 0.0, 2: 2.0, 3: 0.5, 4: 0.0}, True, "", (LOW, HIGH), (), (True, "")),
        ({1: 0.0, 2: 0.0, 3: 3.0, 4: 0.0}, True, "", (LOW,), (HIGH,), (False, "not over the whole range")),
        ({1: 0.0, 2: 0.0}, True, "", (LOW,), (HIGH,), (False, "not over the whole range")),
        ({1: 9.0, 3: 9.0}, False, "failed", (), (LOW, HIGH), (False, "failed")),
        ({1: 0.0, 3: 9.0}, False, "failed", (LOW,), (HIGH,), (False, "failed")),
        ({1: 0.0, 3: 9.0}, False, TOO_LITTLE[0], (LOW,), (HIGH,), (False, "not over the whole range")),
        ({1: 9.0, 3: 9.0}, False, TOO_LITTLE[0], (), (LOW, HIGH), (False, TOO_LITTLE[0])),
    ],
)
def test_repair_must_hold_in_each_stratum(
    losses: Any, accepted: bool, reason: str, held: Any, lost: Any, outcome: Any
) -> None:
    given = order("", drawn=DRAWN, bands=(LOW, HIGH))
    given.comparison.sizes[""].bands = (LOW, HIGH)
    drawn_of = {**DRAWN}

    def test(seeds: Any) -> Any:
        assert len(seeds) == 8
        return acceptance(losses, accepted=accepted, reason=reason)

    given.drawn = drawn_of
    found, ranged = over_the_range(given, "accept", 8, test)
    assert (found.accepted, found.reason) == outcome
    assert ranged == Ranged(tuple(losses), held, lost)


def test_a_single_size_is_tested_on_consecutive_seeds() -> None:
    seen: list[Any] = []
    found, ranged = over_the_range(order(), "accept", 5, lambda seeds: seen.append(seeds) or "found")  # type: ignore[func-returns-value, return-value]
    assert (found, ranged, len(seen[0])) == ("found", Ranged(), 5)


@pytest.mark.parametrize(
    ("runs", "said"),
    [
        ({1: True, 2: True, 3: False, 4: False}, "it works for sizes from 1 to 2, but not for 4 to 5"),
        ({1: False, 2: False, 3: True, 4: True}, "it works for sizes from 4 to 5, but not for 1 to 2"),
        ({1: True, 2: False, 3: True}, ""),
        ({1: True, 4: False}, ""),
        ({1: True, 2: True}, ""),
        ({1: False, 2: False}, ""),
    ],
)
def test_repair_for_one_end_is_described(runs: Any, said: str) -> None:
    assert fits_a_part(order("", drawn=DRAWN), runs) == said


def test_description_names_a_named_part_of_the_drift() -> None:
    drawn = {seed: {"mud": one[""]} for seed, one in DRAWN.items()}
    said = fits_a_part(order("mud", drawn=drawn), {1: True, 2: True, 3: False})  # type: ignore[dict-item]
    assert said == "it works for sizes of mud from 1 to 2, but not for 4 to 4"


def test_intervals_of_drift_sizes_are_described_in_words() -> None:
    assert bands_in_words(Ranged((), (LOW,), (HIGH,))) == f"it works for {LOW}, but not for {HIGH}"
    assert (
        bands_in_words(Ranged((), (), (LOW, HIGH))) == f"it works in no part of the range ({LOW} and {HIGH})"
    )
