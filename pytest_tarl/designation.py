"""A test's marker arguments after checking, as a frozen dataclass; this module does not import pytest."""

from __future__ import annotations

import difflib
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pytest_tarl.drifts import Drift, drift
from pytest_tarl.errors import SettingsError
from pytest_tarl.formulas.marker_arguments import ARGUMENTS, NOTHING_REQUIRED, Requirements, requirements
from pytest_tarl.formulas.said import NOTHING_SAID, Said
from pytest_tarl.options import number_within
from pytest_tarl.promises import must_hold
from pytest_tarl.sensors import Sensor, as_number

MARKER_ARGUMENTS = (
    *("nodes", "sensors", "drifts", "episodes", "min_success", "confidence", "total_range", "tolerance"),
    *("judge", "monitor", "must_hold"),
    *ARGUMENTS,
)


@dataclass(frozen=True)
class Designation:
    """The arguments of `@pytest.mark.tarl`, by which TARL records and compares a simulation test."""

    nodes: tuple[str, ...]
    sensors: tuple[Sensor, ...]
    drifts: Mapping[str, Drift] = field(default_factory=dict)
    episodes: int = 200
    min_success: float = 1.0
    confidence: float | None = None  # confidence required to decide whether min_success holds
    total_range: tuple[float, float] | None = None  # smallest and largest possible total reward of an episode
    tolerance: float | None = None
    # computes the rewards that a log lacks
    judge: Callable[[Mapping[str, Any], Mapping[str, Any]], float] | None = None
    # computes the reward of a mission in a bag; a function, or a class with such a method
    monitor: Callable[[Any], float | Mapping[str, float]] | None = None
    requirements: Requirements = NOTHING_REQUIRED
    must_hold: Mapping[str, tuple[Any, ...]] = field(
        default_factory=dict
    )  # direction of a space → limits of its range, or options, within which the guarantee must hold
    purpose: str = ""  # first paragraph of the test's docstring


def designation(
    where: str, positional: Sequence[Any], arguments: Mapping[str, Any], said: Said = NOTHING_SAID
) -> Designation:
    """Check a marker's arguments and return them; `said` has the formulas and signals in the test's body.

    Raise SettingsError, which names the argument and how to fix it.
    """
    if positional:
        raise SettingsError(
            f"{where}: @pytest.mark.tarl takes named arguments only, such as nodes=[…], sensors=[…]."
        )
    for name in arguments:
        if name not in MARKER_ARGUMENTS:
            close = difflib.get_close_matches(name, MARKER_ARGUMENTS, 1)
            hint = f"did you mean {close[0]!r}?" if close else f"it has {', '.join(MARKER_ARGUMENTS)}."
            raise SettingsError(f"{where}: @pytest.mark.tarl has no argument {name!r}; {hint}")
    sensors = _sensors(where, arguments.get("sensors", ()))
    drifts = _drifts(where, arguments.get("drifts", {}))
    return Designation(
        nodes=_nodes(where, arguments.get("nodes", ())),
        sensors=sensors,
        drifts=drifts,
        episodes=number_within(where, "episodes", arguments.get("episodes", 200), int, 2, 10**6),
        min_success=number_within(where, "min_success", arguments.get("min_success", 1.0), float, 0, 1),
        confidence=_confidence(where, arguments),
        total_range=_total_range(where, arguments.get("total_range")),
        tolerance=_tolerance(where, arguments.get("tolerance")),
        judge=_judge(where, arguments.get("judge")),
        monitor=_monitor(where, arguments.get("monitor")),
        requirements=requirements(where, arguments, sensors, said),
        must_hold=must_hold(where, arguments.get("must_hold", {}), drifts),
    )


def _confidence(where: str, arguments: Mapping[str, Any]) -> float | None:
    value = arguments.get("confidence")
    if value is None:
        return None
    confidence = float(number_within(where, "confidence", value, float, 0.5, 1 - 1e-9))
    if arguments.get("min_success", 1.0) >= 1:
        raise SettingsError(
            f"{where}: confidence={value!r} needs a min_success below 1, because no number of successful "
            "missions proves that every mission succeeds. Set for example min_success=0.99."
        )
    return confidence


def _total_range(where: str, value: Any) -> tuple[float, float] | None:
    if value is None:
        return None
    ends = [as_number(one) for one in value] if isinstance(value, Sequence) else []
    low, high = ends if len(ends) == 2 else (None, None)
    if low is None or high is None or not -math.inf < low < high < math.inf:
        raise SettingsError(
            f"{where}: total_range must be two finite bounds on every episode's total reward, such as "
            f"total_range=(-20, 10), got {value!r}."
        )
    return low, high


def _monitor(where: str, value: Any) -> Any:
    if value is not None and not callable(value):
        raise SettingsError(
            f"{where}: monitor must be a function of the recorded messages, or a class with such a method, got "
            f"{value!r}."
        )
    return value


def _judge(where: str, value: Any) -> Any:
    if value is not None and not callable(value):
        raise SettingsError(
            f"{where}: judge must be a function of two mappings of sensor values, got {value!r}."
        )
    return value


def _nodes(where: str, nodes: Any) -> tuple[str, ...]:
    if (
        isinstance(nodes, str)
        or not isinstance(nodes, Sequence)
        or not nodes
        or not all(isinstance(node, str) for node in nodes)
    ):
        raise SettingsError(
            f'{where}: name the files of the node under test, for example nodes=["my_node.py"] '
            "(relative to the test's folder)."
        )
    return tuple(nodes)


def _sensors(where: str, sensors: Any) -> tuple[Sensor, ...]:
    if not isinstance(sensors, Sequence) or not sensors or not all(isinstance(s, Sensor) for s in sensors):
        raise SettingsError(
            f'{where}: declare the inputs of the node, for example sensors=[Sensor("x", topic="/odom", '
            'field="pose.pose.position.x", low=0, high=10, bins=24)] with `from pytest_tarl import Sensor`.'
        )
    names = [sensor.name for sensor in sensors]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise SettingsError(
            f"{where}: the sensor name {twice[0]!r} is used twice; give each sensor its own name."
        )
    return tuple(sensors)


def _drifts(where: str, drifts: Any) -> Mapping[str, Drift]:
    if not isinstance(drifts, Mapping) or not all(isinstance(name, str) and name for name in drifts):
        raise SettingsError(
            f"{where}: drifts maps names to values of the fixture tarl_drift, for example "
            'drifts={"mud": 0.15}.'
        )
    return {name: drift(where, name, value) for name, value in drifts.items()}


def _tolerance(where: str, value: Any) -> float | None:
    return (
        None
        if value is None
        else float(number_within(where, "tolerance", value, float, 0, sys.float_info.max))
    )
