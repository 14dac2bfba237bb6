"""Which tests a run with a drift selects."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any
from unittest import TestCase

import pytest

from pytest_tarl import Drift, selecting
from pytest_tarl.design import AS_WRITTEN
from pytest_tarl.errors import SettingsError

SPACE = Drift.space(mud=Drift.range(0.0, 1.0, nominal=1.0))


def item(
    *drifts: str, takes: bool = True, runs: str | None = None, declared: Any = None, kind: type | None = None
) -> Any:
    """Return an item whose marker declares drifts, and whose scenario is `runs`."""
    known = declared if declared is not None else dict.fromkeys(drifts, 0.5)
    marker = SimpleNamespace(kwargs={"drifts": known})
    found = SimpleNamespace(
        drifts=known,
        fixturenames=["tarl", "tarl_drift"] if takes else ["tarl"],
        get_closest_marker=lambda name: marker if name == "tarl" else None,
        cls=kind,
    )
    if runs is not None:
        found.callspec = SimpleNamespace(params={"tarl_drift": runs}, id=runs)
    return found


@pytest.fixture(autouse=True)
def designated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the designation of an item hold its drifts."""
    monkeypatch.setattr(selecting, "designated", lambda one: SimpleNamespace(drifts=one.drifts))


def options(mode: str, drift: str) -> Any:
    return SimpleNamespace(mode=mode, drift=drift)


def test_recordings_select_every_test_that_declares_the_drift() -> None:
    assert selecting.chosen(item("mud", "wind"), options("record", "mud"))
    assert selecting.chosen(item("mud", takes=False), options("record", "mud"))
    assert not selecting.chosen(item("wind"), options("record", "mud"))
    assert selecting.chosen(item("wind"), options("record", AS_WRITTEN))


def test_comparisons_select_the_scenario() -> None:
    assert selecting.chosen(item("mud", runs="mud"), options("online", "mud"))
    assert not selecting.chosen(item("mud", "wind", runs="wind"), options("online", "mud"))
    assert selecting.chosen(item("mud", takes=False), options("online", "mud"))
    assert not selecting.chosen(item("wind", takes=False), options("online", "mud"))
    assert not selecting.chosen(item("mud"), options("online", AS_WRITTEN))


def test_error_for_an_undeclared_drift_names_the_declared() -> None:
    selecting.check_drift([item("wind"), item("mud")], options("online", "mud"))
    selecting.check_drift([], options("online", "mud"))
    selecting.check_drift([item("wind")], options("record", AS_WRITTEN))
    with pytest.raises(pytest.UsageError, match=r"'sand' \(declared: mud, wind\)"):
        selecting.check_drift([item("wind"), item("mud", "wind")], options("record", "sand"))
    with pytest.raises(pytest.UsageError, match=r"declared: none is declared"):
        selecting.check_drift([item()], options("online", "mud"))
    with pytest.raises(pytest.UsageError, match=AS_WRITTEN):
        selecting.check_drift([item("wind")], options("online", AS_WRITTEN))


def test_an_invalid_marker_is_a_usage_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def invalid(_: Any) -> None:
        raise SettingsError("the marker is wrong.")

    monkeypatch.setattr(selecting, "designated", invalid)
    with pytest.raises(pytest.UsageError, match="the marker is wrong"):
        selecting.chosen(item("mud"), options("record", "mud"))
    monkeypatch.setattr(selecting, "designated", lambda _: None)
    assert not selecting.chosen(item("mud"), options("record", "mud"))


def test_stress_selects_spaces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(selecting, "missing_stress", lambda _: None)
    both = {"world": SPACE, "mud": 0.5}
    space, plain = item(declared=both, runs="world"), item(declared=both, runs="mud")
    without, none = item(declared=both, takes=False), item("mud", takes=False)
    unmarked = item()
    unmarked.get_closest_marker = lambda _: None
    broken = item(declared=["mud"])
    every = [space, plain, without, none, broken, unmarked]
    assert selecting.with_space(every) == [space, without, broken]
    assert selecting.with_space([]) == []
    with pytest.raises(pytest.UsageError, match="No test declares a space of drifts"):
        selecting.with_space([plain, none])
    monkeypatch.setattr(selecting, "missing_stress", lambda what: f"{what} needs cma.")
    with pytest.raises(pytest.UsageError, match=r"--tarl-stress needs cma\."):
        selecting.with_space([space])


def test_a_space_is_distinguished_from_other_drifts() -> None:
    assert selecting.is_space(SPACE)
    assert not selecting.is_space(Drift(0.5))
    assert not selecting.is_space(None)


def test_test_case_method_gets_the_fixture_indirectly() -> None:
    class Plain:
        pass

    class Case(TestCase):
        pass

    assert selecting.how_to_take(item()) == "take it as an argument"
    assert selecting.how_to_take(item(kind=Plain)) == "take it as an argument"
    assert "give Case a method with @pytest.fixture(autouse=True)" in selecting.how_to_take(item(kind=Case))
