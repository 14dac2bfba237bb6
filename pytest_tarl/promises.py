"""Check the marker's `must_hold`: for each direction of a space, the values for which the guarantee must hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pytest_tarl.drifts import Drift
from pytest_tarl.errors import SettingsError
from pytest_tarl.sensors import as_number
from pytest_tarl.spaces import Choice, Space, Span, nominal


def must_hold(where: str, value: Any, drifts: Mapping[str, Drift]) -> Mapping[str, tuple[Any, ...]]:
    """Return the limits by direction: two numbers for a range, options for a choice.

    Raise SettingsError if no space has the direction, or the limits do not fit it.
    """
    if not isinstance(value, Mapping):
        raise SettingsError(
            f"{where}: must_hold maps directions of a Drift.space to limits, such as "
            f'must_hold={{"mud": (0.4, 1.0)}}, got {value!r}.'
        )
    extents: dict[str, Span | Choice] = {}
    for drift in drifts.values():
        if isinstance(drift.value, Space):
            extents |= drift.value.extents
    return {name: _limits(where, name, limits, extents) for name, limits in value.items()}


def _limits(where: str, name: str, limits: Any, extents: Mapping[str, Span | Choice]) -> tuple[Any, ...]:
    if name not in extents:
        known = ", ".join(extents) or "none is declared"
        raise SettingsError(
            f"{where}: must_hold names {name!r}, which is not a direction of a space ({known})."
        )
    extent = extents[name]
    given = tuple(limits) if isinstance(limits, Sequence) and not isinstance(limits, str) else ()
    if isinstance(extent, Choice):
        if not given or any(option not in extent.options for option in given):
            raise SettingsError(
                f"{where}: must_hold of {name!r} must be options of its choice, such as ({extent.options[0]!r},), got "
                f"{limits!r}."
            )
        return given
    low, high = (
        [
            as_number(end if one is None else one)
            for one, end in zip(given, (extent.low, extent.high), strict=True)
        ]
        if len(given) == 2
        else (None, None)
    )
    if low is None or high is None or not extent.low <= low <= nominal(extent) <= high <= extent.high:
        raise SettingsError(
            f"{where}: must_hold of {name!r} must be two numbers from {extent.low:g} to {extent.high:g} around the "
            f"nominal {nominal(extent):g}, or None for an end of the range, got {limits!r}."
        )
    return low, high
