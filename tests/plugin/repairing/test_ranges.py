"""Drifts with a range: each episode draws a size, and a repair must hold over the whole range."""

from __future__ import annotations

import re
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.drifts import Drift, sizes
from pytest_tarl.model import Sizes
from pytest_tarl.repairing.ranges import STRATA, spread_seeds
from pytest_tarl.repairing.request import spread
from tests.plugin.tank import ONLINE, RECORD, changed, result
from tests.slow import slow

REPAIR = (*ONLINE, "--tarl-repair")
BURST = """\
        if tarl_drift and tarl_drift > 0.2 and valve and valve.data > 4.0:
            tarl.reward(-40.0)
            pytest.fail("the pipe of a wide pump has burst")
        tarl.reward("""


@pytest.fixture
def ranged(tank: pytest.Pytester) -> pytest.Pytester:
    """A tank whose pump is clogged to a varying degree."""
    changed(tank, "test_tank", "from pytest_tarl import Sensor", "from pytest_tarl import Drift, Sensor")
    changed(tank, "test_tank", '{"clogged": 0.25}', '{"clogged": Drift.range(0.1, 0.3)}')
    return tank


def test_repair_works_over_the_whole_range(
    ranged: pytest.Pytester,
) -> None:
    changed(ranged, "test_tank", "    draws = ", "    print('SIZE', tarl_drift)\n    draws = ")
    ranged.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    done = ranged.runpytest(*REPAIR)
    found = result(ranged)
    assert found["repair"]["accepted"]
    assert [(round(one["low"], 3), round(one["high"], 3)) for one in found["sizes"]] == [
        (0.1, 0.167),
        (0.167, 0.233),
        (0.233, 0.3),
    ]
    for one in found["sizes"]:
        assert one["repaired"] > one["online"] + 1
    told = " ".join(done.stdout.str().split())
    assert re.search(r"sizes sizes 0.1 to 0.167: -\d+\.\d+ → -\d+\.\d+ repaired", told)
    (page,) = ranged.path.glob(".tarl/report/*.html")
    text = page.read_text()
    assert text.count('<circle class="on"') >= 12
    assert text.count('<circle class="after"') >= 24


def test_dictionary_parts_have_their_own_ranges(ranged: pytest.Pytester) -> None:
    changed(
        ranged,
        "test_tank",
        "Drift.range(0.1, 0.3)",
        '{"pump": Drift.range(0.1, 0.3), "start": Drift.range(0.0, 0.2)}',
    )
    changed(
        ranged,
        "test_tank",
        "1.0 if tarl_drift is None else tarl_drift",
        "1.0 if tarl_drift is None else tarl_drift['pump']",
    )
    ranged.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    ranged.runpytest(*ONLINE)
    found = result(ranged)
    assert {one["part"] for one in found["sizes"]} == {"pump", "start"}
    assert all(one["repaired"] is None for one in found["sizes"])


@slow
def test_repair_that_fits_part_of_the_range_is_refused(ranged: pytest.Pytester) -> None:
    changed(ranged, "test_tank", "Drift.range(0.1, 0.3)", "Drift.range(0.1, 0.3, permanent=True)")
    changed(ranged, "test_tank", "        tarl.reward(", BURST)
    ranged.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    done = ranged.runpytest(*REPAIR, "--tarl-budget=100")
    told = " ".join(done.stdout.str().split())
    assert not result(ranged)["repair"]["accepted"]
    assert "it works for sizes from" in told or "a part of the drift's range" in told


@slow
@pytest.mark.usefixtures("quick_acceptance")
def test_repair_does_not_depend_on_the_number_of_workers(ranged: pytest.Pytester) -> None:
    ranged.runpytest(*RECORD)
    ranged.runpytest(*REPAIR)
    first = result(ranged)
    ranged.runpytest(*REPAIR, "--tarl-workers=2")
    assert result(ranged) == first


@given(st.lists(st.floats(0, 1), min_size=1, max_size=40))
def test_first_pairs_span_the_drift_sizes(sizes: list[float]) -> None:
    order = list(spread([(size, at) for at, size in enumerate(sizes)]))
    assert sorted(order) == list(range(len(sizes)))
    if len(sizes) >= 7:  # positions of the first pairs: the median, the quarters, the eighths
        ranks = sorted(
            sorted(range(len(sizes)), key=lambda at: (sizes[at], at)).index(at) for at in order[:7]
        )
        assert max(later - earlier for earlier, later in pairwise(ranks)) <= len(sizes) // 4 + 1


PARTS = {"": Drift.range(0.1, 0.6)}, {"a": Drift.range(-1, 1), "b": Drift.range(0, 9), "c": Drift.range(2, 3)}


@pytest.mark.parametrize("parts", PARTS)
def test_every_four_seeds_span_the_range(parts: dict[str, Drift]) -> None:
    value = Drift(parts) if len(parts) > 1 else parts[""]
    spans = {part: one.value for part, one in parts.items()}
    order: Any = SimpleNamespace(
        world=value,
        drift="mud",
        options=SimpleNamespace(seed=3),
        comparison=SimpleNamespace(
            sizes={part: Sizes(part, one.low, one.high) for part, one in spans.items()}
        ),
    )
    chosen = spread_seeds(order, "acceptance 1", 48)
    assert len(set(chosen)) == 48
    assert chosen[:8] == spread_seeds(order, "acceptance 1", 8)
    assert not set(chosen) & set(spread_seeds(order, "acceptance 2", 48))
    for at in range(0, 48, STRATA):
        shares = [
            [
                (drawn[part] - one.low) / (one.high - one.low)
                for drawn in (sizes(value, "mud", seed) for seed in chosen[at : at + STRATA])
            ]
            for part, one in list(spans.items())[:2]
        ]
        if len(shares) == 1:
            assert [int(share * 4) for share in shares[0]] == [0, 1, 2, 3]
        else:
            assert {(one < 0.5, two < 0.5) for one, two in zip(*shares, strict=True)} == {
                (first, second) for first in (True, False) for second in (True, False)
            }


@given(st.floats(-1e3, 1e3), st.floats(1e-3, 1e3))
def test_the_parts_of_a_range_cover_the_whole_range(low: float, width: float) -> None:
    bands = Sizes("", low, low + width).bands
    assert bands[0].low == low
    assert bands[-1].high == low + width
    assert all(one.high == other.low for one, other in pairwise(bands))
