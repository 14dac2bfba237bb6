"""Select the tests of a TARL run by the drifts that their markers declare."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from unittest import TestCase

import pytest

from pytest_tarl.design import AS_WRITTEN
from pytest_tarl.errors import SettingsError
from pytest_tarl.extras import missing_stress
from pytest_tarl.item_episode import designated
from pytest_tarl.options import Options
from pytest_tarl.scenarios import scenario
from pytest_tarl.spaces import Space


def with_space(marked: Sequence[pytest.Item]) -> list[pytest.Item]:
    """Return the items that have a drift space.

    Raise UsageError if there are none, or if a required package is missing.
    """
    sentence = missing_stress("--tarl-stress")
    if sentence is not None:
        raise pytest.UsageError(sentence)
    found = [item for item in marked if _has_space(item)]
    if marked and not found:
        raise pytest.UsageError(
            "No test declares a space of drifts, which --tarl-stress searches: declare one in the marker, such as "
            'drifts={"world": Drift.space(mud=Drift.range(0.05, 1.0, nominal=1.0))}.'
        )
    return found


def chosen(item: pytest.Item, options: Options) -> bool:
    """Return whether `--tarl-drift` selects an item.

    For a recording, it selects every item whose marker declares the drift; for a comparison, every item of that
    scenario. Items that declare the drift but do not use the fixture `tarl_drift` are also selected; their reports say
    so.
    """
    declared = options.drift in _drift_names(item)
    if options.mode == "record":
        return declared or options.drift == AS_WRITTEN
    return scenario(item) == options.drift or (declared and not takes(item, "tarl_drift"))


def check_drift(marked: Sequence[pytest.Item], options: Options) -> None:
    """Raise UsageError if no test declares the drift in `--tarl-drift`."""
    known = sorted({name for item in marked for name in _drift_names(item)})
    backwards = options.mode == "record" and options.drift == AS_WRITTEN
    if marked and options.drift not in known and not backwards:
        names = ", ".join(known) or "none is declared"
        raise pytest.UsageError(
            f"No test declares the drift {options.drift!r} (declared: {names}). Declare it "
            "in the marker: drifts={…}."
        )


def _drift_names(item: pytest.Item) -> list[str]:
    try:
        marked = designated(item)
    except SettingsError as error:
        raise pytest.UsageError(str(error)) from None
    return list(marked.drifts) if marked else []


def is_space(drift: object) -> bool:
    """Return whether a marker's drift is a space."""
    return isinstance(getattr(drift, "value", None), Space)


def _has_space(item: pytest.Item) -> bool:
    """Return whether an item's scenario is a space, or its marker declares one that the item does not use."""
    marker = item.get_closest_marker("tarl")
    drifts = marker.kwargs.get("drifts", {}) if marker is not None else {}
    if not isinstance(drifts, Mapping):
        return True  # running the test will report that the marker is invalid
    if takes(item, "tarl_drift"):
        return is_space(drifts.get(scenario(item)))
    return any(map(is_space, drifts.values()))


def takes(item: pytest.Item, fixture: str) -> bool:
    """Return whether a test uses a fixture."""
    return fixture in getattr(item, "fixturenames", ())


def how_to_take(item: pytest.Function) -> str:
    """Describe how a test requests the fixture: methods of unittest.TestCase cannot have it as an argument."""
    if item.cls is None or not issubclass(item.cls, TestCase):
        return "take it as an argument"
    return (
        f"a method of unittest.TestCase cannot take it as an argument, so give {item.cls.__name__} a method with "
        "@pytest.fixture(autouse=True) that takes it and stores it in self"
    )
