"""Remarks for the reviewer of a repair: jumps at thresholds, and unusually large changes."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing import reviewing
from pytest_tarl.repairing.reviewing import jumps, large
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from pytest_tarl.sensors import Sensor
from tests.plugin.searching.test_search import operand


def numeric(name: str, low: float, high: float) -> Conjunct:
    return Conjunct(Sensor(name, topic=f"/{name}", field="data", low=0, high=10, bins=5), low, high)


WET = Conjunct(Sensor("wet", topic="/wet", field="data"), 1, 1)
GAIN, OFFSET, EAGER = operand(3, "2.0", 2.0), operand(4, "0.0", 0.0), operand(5, "True", True)
UNKNOWN = replace(operand(6, "self.kp", 1.0), value=None, definition=None)
NAMED = replace(operand(7, "LIMIT", 4.0), definition=operand(1, "4.0", 4.0).span)


@pytest.mark.parametrize(
    ("mutations", "expected"),
    [
        ([Mutation(GAIN, 3.0)], "2.0 from 2 to 3 (× 1.5)"),
        ([Mutation(OFFSET, 0.25)], "0.0 from 0 to 0.25"),
        ([Mutation(UNKNOWN, 1.25)], "self.kp × 1.25"),
        ([Mutation(EAGER, False)], "True × 0"),
        ([Mutation(NAMED, 0.5)], "LIMIT from 4 to 2 (× 0.5)"),
        ([Mutation(GAIN, 3.0), Mutation(OFFSET, -1.0)], "2.0 from 2 to 3 (× 1.5), 0.0 from 0 to -1"),
        ([Mutation(GAIN, 0.1 * 3)], "2.0 from 2 to 0.3 (× 0.15)"),
    ],
)
def test_jump_at_a_threshold_is_described(mutations: list[Mutation], expected: str) -> None:
    guard = Guard((numeric("depth", 2.0, math.inf), WET, numeric("speed", -math.inf, 4.0)))
    told = f"jump at the threshold of depth and speed: {expected}"
    assert jumps(Candidate(tuple(mutations), guard)) == [told]


def test_a_condition_without_a_threshold_has_no_jump() -> None:
    for guard in (ALWAYS, Guard((WET,))):
        assert jumps(Candidate((Mutation(GAIN, 3.0),), guard)) == []
    form: Any = SimpleNamespace(parameter="", defaults=())
    structural = Mutation(GAIN, True, form=form)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(reviewing, "effective_value", lambda _: 1.0)
        assert jumps(Candidate((structural,), Guard((numeric("depth", 2.0, math.inf),)))) == []


@pytest.mark.parametrize(
    ("mutations", "expected"),
    [
        ([Mutation(GAIN, 16.0)], "2.0 changes by a factor of 8"),
        ([Mutation(GAIN, 15.9)], ""),
        ([Mutation(GAIN, 0.25)], "2.0 changes by a factor of 0.125"),
        ([Mutation(GAIN, 0.26)], ""),
        ([Mutation(GAIN, -16.0)], "2.0 changes by a factor of -8"),
        ([Mutation(NAMED, 0.1)], "LIMIT changes by a factor of 0.1"),
        ([Mutation(UNKNOWN, 9.0)], "self.kp changes by a factor of 9"),
        ([Mutation(OFFSET, 100.0)], ""),
        ([Mutation(EAGER, False)], ""),
        (
            [Mutation(GAIN, 20.0), Mutation(NAMED, 2.0), Mutation(UNKNOWN, 0.1)],
            "2.0 changes by a factor of 10, self.kp changes by a factor of 0.1",
        ),
    ],
)
def test_eightfold_change_of_a_constant_is_pointed_out(mutations: list[Mutation], expected: str) -> None:
    told = [one.partition(": ")[0] for one in large(Candidate(tuple(mutations), ALWAYS))]
    assert told == ([expected] if expected else [])


def test_a_structural_change_has_no_factor() -> None:
    form: Any = SimpleNamespace(parameter="gain", defaults=())
    assert large(Candidate((Mutation(GAIN, 100.0, form=form),), ALWAYS)) == []
