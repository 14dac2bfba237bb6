"""Read and check the marker's arguments for formulas."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.formulas.parsing import Formula, formula
from pytest_tarl.formulas.said import NOTHING_SAID, Said
from pytest_tarl.formulas.signals import NANOSECONDS, Signal
from pytest_tarl.options import number_within
from pytest_tarl.sensors import Sensor

ARGUMENTS = ("requires", "signals", "reward", "robustness_cap", "lasts")
CAP = 100.0
LONGEST = 1e9  # upper limit of an episode's length (s)


@dataclass(frozen=True)
class Requirements:
    """The formulas of a test.

    If robustness is the reward, `cap` limits it; otherwise it is None. `lasts` is the maximum length of an episode in
    virtual seconds.
    """

    signals: tuple[Signal, ...] = ()
    formulas: tuple[Formula, ...] = ()
    names: tuple[str, ...] = ()  # numeric sensors and signals, which formulas may use
    rewarding: bool = False
    cap: float = CAP
    # whether an episode must record signals from its start, because formulas may use them
    followed: bool = False
    said: Said = NOTHING_SAID

    @property
    def topics(self) -> frozenset[str]:
        """Return the topics that signals are read from."""
        return frozenset(signal.topic for signal in self.signals if signal.topic is not None)


NOTHING_REQUIRED = Requirements()


def requirements(
    where: str, given: Mapping[str, Any], sensors: Sequence[Sensor], said: Said = NOTHING_SAID
) -> Requirements:
    """Check the marker's arguments for formulas; `said` has the names found in the test's source.

    A formula may use sensors, declared signals, and signals that the test sets with `tarl.observe`. Raise SettingsError
    for invalid arguments.
    """
    declared = _signals(where, given.get("signals", ()), sensors)
    signals = (*declared, *_observed(given.get("requires", ()), said, [*sensors, *declared]))
    names = (*(sensor.name for sensor in sensors if not sensor.categories), *(one.name for one in signals))
    formulas = _formulas(where, given.get("requires", ()), names, sensors, said)
    rewarding = _rewarding(where, given.get("reward"), formulas)
    if "robustness_cap" in given and not rewarding:
        raise SettingsError(f'{where}: robustness_cap needs reward="robustness".')
    cap = number_within(where, "robustness_cap", given.get("robustness_cap", CAP), float, 1e-9, 1e9)
    _check_lasting(where, given.get("lasts"), formulas)
    followed = "requires" in given or "signals" in given or said.requires
    return Requirements(signals, formulas, names, rewarding, cap, followed, said)


def _signals(where: str, given: Any, sensors: Sequence[Sensor]) -> tuple[Signal, ...]:
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise SettingsError(
            f'{where}: signals lists names, or Signal(…) for fields of messages, such as signals=["gap", '
            f'Signal("speed", topic="/odom", field="twist.twist.linear.x")], got {given!r}.'
        )
    signals = tuple(Signal(one) if isinstance(one, str) else one for one in given)
    odd = next((one for one in signals if not isinstance(one, Signal)), None)
    if odd is not None:
        raise SettingsError(f"{where}: signals lists names and Signal(…), got {odd!r}.")
    names = [*(sensor.name for sensor in sensors), *(one.name for one in signals)]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise SettingsError(
            f"{where}: the name {twice!r} is used twice among sensors and signals; give each its own name."
        )
    return signals


def _observed(given: Any, said: Said, declared: Sequence[Sensor | Signal]) -> tuple[Signal, ...]:
    """Return the signals of a formula that the test observes but does not declare."""
    known = {one.name for one in declared}
    texts = " ".join(
        one for one in (*(given if isinstance(given, Sequence) else ()), *said.texts) if isinstance(one, str)
    )
    used = {*re.findall(r"\b[A-Za-z_]\w*", texts)}
    return tuple(
        Signal(name) for name in said.observed if name in used and name not in known and name.isascii()
    )


def _formulas(
    where: str, given: Any, names: tuple[str, ...], sensors: Sequence[Sensor], said: Said
) -> tuple[Formula, ...]:
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise SettingsError(
            f'{where}: requires lists formulas, such as requires=["always (gap > 0.3)"], got {given!r}.'
        )
    for text in given:
        check_texts(where, text, sensors)
    return tuple(dict.fromkeys(formula(where, text, names, said) for text in given))


def check_texts(where: str, text: Any, sensors: Sequence[Sensor]) -> None:
    """Raise SettingsError if a formula uses a sensor with string values."""
    for sensor in sensors:
        if sensor.categories and isinstance(text, str) and re.search(rf"\b{sensor.name}\b", text):
            raise SettingsError(
                f"{where}: the formula {text!r} names {sensor.name!r}, a sensor with string values; formulas compare "
                f"numbers: declare a signal for the condition, such as Signal('is_{sensor.categories[0]}', "
                f"topic=…, field=lambda message: message.data == {sensor.categories[0]!r})."
            )


def _rewarding(where: str, given: Any, formulas: Sequence[Formula]) -> bool:
    if given is None:
        return False
    if given != "robustness":
        raise SettingsError(
            f'{where}: reward must be "robustness", or be omitted in favour of tarl.reward; got {given!r}.'
        )
    if not formulas:
        raise SettingsError(
            f'{where}: reward="robustness" needs at least one formula in requires=[…]: add one.'
        )
    return True


def _check_lasting(where: str, lasts: Any, formulas: Sequence[Formula]) -> None:
    if lasts is None:
        return
    seconds = number_within(where, "lasts", lasts, float, 1e-9, LONGEST)
    for one in formulas:
        from pytest_tarl.formulas.reach import unjudged

        problem = unjudged(one.tree, round(seconds * NANOSECONDS))
        if problem:
            raise SettingsError(
                f"{where}: the formula {one.text!r} can never be judged: {problem}, and no episode lasts longer than "
                f"{seconds:g} s (lasts={lasts!r}). Shorten its bounds."
            )
