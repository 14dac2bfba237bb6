"""The lines about failures that were kept from earlier stress runs."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.stressing import delivering
from pytest_tarl.stressing.kept import EPISODES


@pytest.mark.parametrize("fails", [[], [True], [False, True, True]])
def test_each_kept_failure_says_whether_it_still_fails(
    fails: list[bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = [SimpleNamespace(point=n, fails=one, passed=n, loss=n + 0.25) for n, one in enumerate(fails)]
    monkeypatch.setattr(delivering.kept, "replayed", lambda *_: found)
    monkeypatch.setattr(delivering.words, "of_point", lambda _, point: f"mud {point}")
    monkeypatch.setattr(delivering, "guarantee", lambda *_: None)
    request: Any = SimpleNamespace(
        designation=SimpleNamespace(drifts={"mud": SimpleNamespace(value="space")}),
        drift="mud",
        fixture=None,
        rollout=None,
        options=SimpleNamespace(seed=0),
    )
    memory: Any = SimpleNamespace(read=lambda space: [space])
    assert delivering._replayed(request, memory) == tuple(
        f"  {'' if n else 'kept':10} mud {n} {'still fails' if one else 'holds now'}: "
        f"{n} of {EPISODES} episodes pass, and the mean loss is {n + 0.25:.3g}."
        for n, one in enumerate(fails)
    )
