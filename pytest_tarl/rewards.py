"""Check the arguments of `tarl.reward`."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.sensors import as_number

LARGEST = 1e100  # largest magnitude of a reward; flow values have the same limit


def checked_reward(
    total: float | None, parts: Mapping[str, float], *, by_formulas: bool
) -> tuple[float, dict[str, float]]:
    """Return the reward of a step and its named parts; without a total, it is the sum of the parts.

    `by_formulas` means that formulas give the rewards. Raise SettingsError in that case, and if there is neither a
    total nor a part, or a value is not a finite number.
    """
    if total is None and not parts:
        raise SettingsError(
            "tarl.reward needs a number, or parts such as tarl.reward(progress=0.2, clearance=-1)."
        )
    if by_formulas:
        raise SettingsError(
            'The marker has reward="robustness", so the formulas give the reward of each step: remove '
            "tarl.reward from the test, or reward from the marker."
        )
    given = {name: _reward(value) for name, value in parts.items()}
    return _reward(sum(given.values()) if total is None else total), given


def _reward(value: Any) -> float:
    number = as_number(value)
    if number is None or not abs(number) < math.inf:
        raise SettingsError(f"tarl.reward got {reprlib.repr(value)}: rewards must be finite numbers.")
    if abs(number) > LARGEST:
        raise SettingsError(
            f"tarl.reward got {reprlib.repr(value)}: rewards are at most {LARGEST:g} in magnitude, because sums of "
            "their squares overflow. Scale the reward."
        )
    return number
