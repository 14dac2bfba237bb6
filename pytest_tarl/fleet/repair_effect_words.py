"""Describe the effects of repairs in lines of text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pytest_tarl.fleet.repairs import ALPHA, Effect
from pytest_tarl.model import Bound

WHY = {
    "not comparable": "no missions without a repair at the same site in the same week",
    "too few robots": "an interval needs 4 robots with the repair and 4 without",
}


def lines(effects: Sequence[Effect], accepted: Mapping[str, str]) -> Iterator[str]:
    """Yield one line per repair and group."""
    yield (
        "Repairs, against missions without a repair at the same site in the same week (simultaneous "
        "intervals at "
        f"{100 * (1 - ALPHA):g} %)"
    )
    for one in effects:
        where = f" at {' '.join(one.values)}" if one.values else ""
        yield f"  {one.repair}{where}: {one.verdict}{_amounts(one)}"
    for repair, drift in accepted.items():
        yield f"  {repair} was accepted in simulation for the drift {drift}"


def _amounts(one: Effect) -> str:
    if one.verdict == "not comparable":
        return f" ({WHY[one.verdict]})"
    reward = f", reward {one.reward:+.3g}{_interval(one.reward_bound, 1)}"
    success = f", pass rate {100 * one.success:+.1f} points{_interval(one.success_bound, 100)}"
    why = f" ({WHY[one.verdict]})" if one.verdict in WHY else ""
    return (
        f"{why}{reward}{success}, {one.missions[0]:,} missions of {one.robots[0]:,} robots with it and "
        f"{one.missions[1]:,} of {one.robots[1]:,} without"
    )


def _interval(bound: Bound, unit: float) -> str:
    found = interval(bound, unit)
    return f" ({found})" if found else ""


def interval(bound: Bound, unit: float) -> str:
    """Return an interval in words; empty if it is unknown."""
    known = bound.low > float("-inf")
    return f"{unit * bound.low:+.3g} to {unit * bound.high:+.3g}" if known else ""
