"""Values of drift scenarios: plain values, ranges, dictionaries, permanent drifts; and the design."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl import Drift
from pytest_tarl.design import AS_WRITTEN, adopted, adopting, replaced, value
from pytest_tarl.drifts import combined, drawn, drift, sizes
from pytest_tarl.errors import SettingsError

plain = st.one_of(
    st.none(), st.booleans(), st.floats(allow_nan=False), st.text(max_size=3), st.lists(st.integers())
)
ranges = st.tuples(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6)).map(lambda ends: (ends[0], ends[0] + ends[1]))
seeds = st.integers(0, 2**63 - 1)


@given(plain, seeds)
def test_a_plain_value_is_passed_to_the_test(given_value: Any, seed: int) -> None:
    assert drawn(drift("t", "mud", given_value), "mud", seed) is given_value
    assert drawn(drift("t", "mud", Drift(given_value, permanent=True)), "mud", seed) is given_value


@given(ranges, seeds)
def test_each_seed_draws_a_value_from_the_range(ends: tuple[float, float], seed: int) -> None:
    mud = drift("t", "mud", Drift.range(*ends))
    found = drawn(mud, "mud", seed)
    assert ends[0] <= found <= ends[1]
    assert found == drawn(mud, "mud", seed)
    assert sizes(mud, "mud", seed) == {"": found}


@given(st.dictionaries(st.text(min_size=1, max_size=3), st.one_of(plain, ranges), max_size=4), seeds)
def test_parts_of_a_dictionary_are_drawn_independently(parts: dict[str, Any], seed: int) -> None:
    made = {name: Drift.range(*part) if isinstance(part, tuple) else part for name, part in parts.items()}
    found = drawn(drift("t", "world", made), "world", seed)
    assert found.keys() == parts.keys()
    for name, part in parts.items():
        alone = drawn(drift("t", "world", {name: made[name]}), "world", seed)[name]
        assert found[name] == alone  # independent of the other parts
        assert part[0] <= found[name] <= part[1] if isinstance(part, tuple) else found[name] is part


def test_draws_cover_the_range() -> None:
    mud = Drift.range(0.1, 0.6)
    found = [drawn(mud, "mud", seed) for seed in range(2000)]
    counts = [sum(0.1 + 0.1 * i <= one < 0.2 + 0.1 * i for one in found) for i in range(5)]
    assert min(counts) > 330
    assert max(counts) < 470


@pytest.mark.parametrize(
    "ends", [(1, 1), (2, 1), (0, float("inf")), (float("nan"), 1), ("0", 1), (False, True), (None, 1)]
)
def test_a_range_needs_two_numbers(ends: tuple[Any, Any]) -> None:
    with pytest.raises(SettingsError, match=r"Drift\.range"):
        Drift.range(*ends)


def test_scenario_parts_are_all_permanent_or_none() -> None:
    lasting = Drift(0.8, permanent=True)
    assert drift("t", "worn", {"left": lasting, "right": lasting}).permanent
    assert drift("t", "worn", Drift({"left": 0.8, "right": 0.7}, permanent=True)).permanent
    assert drift("t", "worn", Drift.range(0.7, 0.9, permanent=True)).permanent
    assert not drift("t", "worn", {"left": Drift(0.8), "right": 0.7}).permanent
    with pytest.raises(SettingsError, match="'left' is permanent and 'right' is not"):
        drift("t", "worn", {"left": lasting, "right": 0.7})
    with pytest.raises(SettingsError, match="a Drift inside a Drift"):
        drift("t", "worn", Drift(lasting))


def test_scenarios_are_merged_if_both_are_dictionaries() -> None:
    assert combined([{"wheel": 0.8}, {"mud": 0.15}]) == {"wheel": 0.8, "mud": 0.15}
    assert combined([0.8, 0.15]) == 0.15
    assert combined([{"wheel": 0.8}, 0.15]) == 0.15


def _drifts(**values: Any) -> dict[str, Drift]:
    return {name: drift("t", name, one) for name, one in values.items()}


def test_scenario_changes_the_recorded_design() -> None:
    drifts = _drifts(worn=Drift({"wheel": 0.8}, permanent=True), mud={"slip": 0.15}, dusk=0.3)
    assert value(drifts, (), None, 1) is None
    assert value(drifts, ("worn",), None, 1) == {"wheel": 0.8}
    assert value(drifts, ("worn",), "mud", 1) == {"wheel": 0.8, "slip": 0.15}
    assert value(drifts, ("worn",), "dusk", 1) == 0.3
    assert (replaced(drifts, ("worn",), "mud"), replaced(drifts, ("worn",), "dusk")) == ("", "worn")
    assert value(drifts, ("worn",), AS_WRITTEN, 1) is None


def test_recording_adds_to_the_design_or_resets_it() -> None:
    drifts = _drifts(worn={"wheel": 0.8}, moved={"camera": 0.1}, dusk=0.3)
    assert adopting((), None, drifts) == ()
    assert adopting(("worn",), None, drifts) == ("worn",)
    assert adopting(("worn",), "moved", drifts) == ("worn", "moved")
    assert adopting(("worn",), "worn", drifts) == ("worn",)
    assert adopting(("worn",), "dusk", drifts) == ("dusk",)
    assert adopting(("worn", "moved"), AS_WRITTEN, drifts) == ()


def test_undeclared_design_is_refused() -> None:
    with pytest.raises(
        SettingsError, match="'worn' as part of the design, but the marker no longer declares it"
    ):
        value(_drifts(mud=0.1), ("worn",), "mud", 1)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 no zip", b"text"])
def test_foreign_file_gives_no_design(tmp_path: Path, content: bytes) -> None:
    assert adopted(tmp_path / "missing.npz") == ()
    (tmp_path / "broken.npz").write_bytes(content)
    assert adopted(tmp_path / "broken.npz") == ()
