"""Convert an episode's messages and observations to sensor bins and signal values."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pytest_tarl.errors import RecordingError, SettingsError
from pytest_tarl.formulas.marker_arguments import Requirements
from pytest_tarl.formulas.running_episode import EpisodeFormulas
from pytest_tarl.formulas.signals import Signal
from pytest_tarl.sensors import Cell, Sensor, reading

if TYPE_CHECKING:
    from pytest_tarl.instrumentation.recorder import Recorder


class Situation:
    """The current bins of the sensors, which form a cell; each new cell is passed to the recorder."""

    def __init__(
        self,
        sensors: Sequence[Sensor],
        requirements: Requirements,
        formulas: EpisodeFormulas,
        recorder: Recorder,
    ) -> None:
        self.topics: dict[str, str] = {}  # topic with a message → message type
        self.values: dict[str, list[float]] = {}  # values of sensors whose bins are learned
        self.known = False  # whether all sensors have ever had a value at the same time
        self._sensors = sensors
        self._requirements = requirements
        self._formulas = formulas
        self._recorder = recorder
        self._bins: dict[str, int | None] = {}

    @property
    def begun(self) -> bool:
        """Return whether any sensor has received a value."""
        return bool(self._bins)

    @property
    def subscribed(self) -> tuple[str, ...]:
        """Return the topics that sensors and signals read."""
        named = [sensor.topic for sensor in self._sensors]
        named += [signal.topic for signal in self._requirements.signals]
        return tuple(dict.fromkeys(topic for topic in named if topic is not None))

    def hear(self, topic: str, message: Any) -> None:
        """Read sensors and signals from a delivered message."""
        changed = False
        for sensor in self._sensors:
            if sensor.topic is not None and _same(sensor.topic, topic):
                self._read(sensor, _value(sensor, message))
                self.topics[sensor.topic] = _type_name(message)
                changed = True
        for signal in self._requirements.signals:
            if signal.topic is not None and _same(signal.topic, topic):
                self._formulas.give(signal.name, _value(signal, message))
                self.topics[signal.topic] = _type_name(message)
        if changed:
            self._latch()

    def observe(self, values: Mapping[str, Any]) -> None:
        """Set sensors and signals by name. Raise SettingsError for a name that is neither."""
        declared = {sensor.name: sensor for sensor in self._sensors}
        signals = {signal.name for signal in self._requirements.signals}
        for name, value in values.items():
            if name in declared:
                self._read(declared[name], value)
            elif name in signals:
                self._formulas.give(name, value)
            else:
                self._check_unused(name, [*declared, *sorted(signals)])
        if declared.keys() & values.keys():
            self._latch()

    def problem(self) -> RecordingError | None:
        """Return the error for an episode without a usable cell, or None."""
        silent = [sensor for sensor in self._sensors if sensor.name not in self._bins]
        if silent:
            return RecordingError(_silence(silent[0]))
        if not self.known:
            return RecordingError(
                f"Sensor {next(name for name, value in self._bins.items() if value is None)!r} was NaN whenever the "
                "others had values: check the values that the world gives it."
            )
        return None

    def _check_unused(self, name: str, known: Sequence[str]) -> None:
        """Raise SettingsError if a name is probably misspelt.

        A test with formulas may observe additional names. A name counts as misspelt if it resembles a declared one that
        the test never observes.
        """
        said = self._requirements.said
        close = difflib.get_close_matches(name, known, 1)
        if self._requirements.followed and name in said.observed and (not close or close[0] in said.observed):
            return
        hint = f"; did you mean {close[0]!r}?" if close else f"; the marker declares {', '.join(known)}."
        raise SettingsError(f"tarl.observe: no such sensor or signal: {name!r}{hint}")

    def _read(self, sensor: Sensor, value: Any) -> None:
        if not sensor.categories:
            self._formulas.give(sensor.name, value)
        self._bins[sensor.name] = sensor.bin(value)
        if sensor.to_learn:
            self.values.setdefault(sensor.name, []).append(float(value))

    def _latch(self) -> None:
        bins = [self._bins.get(sensor.name) for sensor in self._sensors]
        known = [value for value in bins if value is not None]
        cell: Cell | None = tuple(known) if len(known) == len(bins) else None
        self.known = self.known or cell is not None
        self._recorder.latch(cell)


def _same(first: str, second: str) -> bool:
    """Compare topic names, ignoring a leading slash."""
    return first.lstrip("/") == second.lstrip("/")


def _type_name(message: Any) -> str:
    """Return the ROS 2 type name of a message, such as `std_msgs/msg/Bool`; empty for other objects."""
    kind = type(message)
    package = kind.__module__.split(".")[0]
    return f"{package}/msg/{kind.__name__}" if hasattr(kind, "__slots__") or hasattr(kind, "_type") else ""


def _value(sensor: Sensor | Signal, message: Any) -> Any:
    if callable(sensor.field):
        return sensor.field(message)
    try:
        return reading(message, sensor.field or "")
    except (AttributeError, IndexError, KeyError, TypeError) as problem:
        raise SettingsError(
            f"{type(sensor).__name__} {sensor.name!r}: a message on {sensor.topic} ({type(message).__name__}) has no "
            f"field {sensor.field!r}. Correct the field in the marker."
        ) from problem


def _silence(sensor: Sensor) -> str:
    if sensor.topic is None:
        return f"Sensor {sensor.name!r} was never observed: call tarl.observe({sensor.name}=…) in each step."
    return (
        f"Sensor {sensor.name!r} received no message on {sensor.topic}: publish it with "
        f"tarl.bus.publish({sensor.topic!r}, …), report its delivery with tarl.message({sensor.topic!r}, message), "
        "or correct the topic in the marker."
    )
