"""Names of tests without their drift scenario."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.scenarios import scenario, without_drift


def item(nodeid: str, ids: str | None = None, **params: Any) -> Any:
    found = SimpleNamespace(nodeid=nodeid)
    if ids is not None:
        found.callspec = SimpleNamespace(params=params, id=ids)
    return found


@pytest.mark.parametrize(
    ("one", "name", "base"),
    [
        (item("t.py::test"), None, "t.py::test"),
        (item("t.py::test[fast]", "fast", speed=2), None, "t.py::test[fast]"),
        (item("t.py::test[mud]", "mud", tarl_drift="mud"), "mud", "t.py::test"),
        (item("t.py::test[online]", "online", tarl_drift=None), None, "t.py::test"),
        (item("t.py::test[mud-fast]", "mud-fast", tarl_drift="mud", speed=2), "mud", "t.py::test[fast]"),
        (item("t.py::test[fast-mud]", "fast-mud", tarl_drift="mud", speed=2), "mud", "t.py::test[fast]"),
        (item("t.py::test[mud-mud]", "mud-mud", tarl_drift="mud", name="mud"), "mud", "t.py::test[mud]"),
        (item("t.py::test[muddy-mud]", "muddy-mud", tarl_drift="mud"), "mud", "t.py::test[muddy]"),
    ],
)
def test_all_scenarios_of_a_test_have_one_recording(one: Any, name: str | None, base: str) -> None:
    assert (scenario(one), without_drift(one)) == (name, base)
