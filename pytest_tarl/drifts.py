"""Values of drift scenarios: a plain value, a range from which each episode draws, or a dictionary of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

from pytest_tarl import seeds
from pytest_tarl.errors import SettingsError


@dataclass(frozen=True, slots=True)
class Span:
    """A closed range of numbers, from which each episode draws uniformly."""

    low: float
    high: float


@dataclass(frozen=True)
class Drift:
    """The value of a drift scenario, or of one part of it in a dictionary.

    `permanent` means that the world has changed for good: a repair need not work in the old world.
    """

    value: Any
    permanent: bool = False

    @classmethod
    def range(cls, low: float, high: float, *, permanent: bool = False) -> Drift:
        """Return a drift whose size varies between episodes. Raise SettingsError for an invalid range."""
        numbers = all(isinstance(end, int | float) and not isinstance(end, bool) for end in (low, high))
        if not numbers or not isfinite(low) or not isfinite(high) or not low < high:
            raise SettingsError(
                f"Drift.range({low!r}, {high!r}): give two finite numbers, the smaller one first."
            )
        return cls(Span(float(low), float(high)), permanent)

    @property
    def spans(self) -> Mapping[str, Span]:
        """Return the ranges by the name of their part, "" for the whole value."""
        return dict(_spans(self.value, ""))


def drift(where: str, name: str, value: Any) -> Drift:
    """Return a scenario of a marker as a Drift. Raise SettingsError if its parts contradict each other."""
    whole = value if isinstance(value, Drift) else Drift(value)
    if isinstance(whole.value, Drift):
        raise SettingsError(f"{where}: the drift {name!r} is a Drift inside a Drift: remove one of them.")
    parts = list(_parts(whole.value))
    lasting = [part for part, inner in parts if inner.permanent]
    passing = [part for part, inner in parts if not inner.permanent]
    if lasting and passing and not whole.permanent:
        raise SettingsError(
            f"{where}: in the drift {name!r}, {lasting[0]!r} is permanent and {passing[0]!r} is not. All parts of a "
            "scenario must agree on `permanent`: split it into two scenarios."
        )
    return Drift(whole.value, whole.permanent or bool(lasting))


def drawn(whole: Drift, name: str, seed: int) -> Any:
    """Return the value of the scenario `name` in a seed's episode: plain values, one drawn from every range."""
    return _plain(whole.value, name, seed)


def sizes(whole: Drift, name: str, seed: int) -> Mapping[str, float]:
    """Return the number that a seed's episode draws from each range, by the name of its part."""
    return {part: _draw(span, _stream(name, part), seed) for part, span in whole.spans.items()}


def combined(values: Sequence[Any]) -> Any:
    """Combine several drift values: merge dictionaries; otherwise the last value wins."""
    if all(isinstance(value, Mapping) for value in values):
        return {key: part for value in values for key, part in value.items()} if values else None
    return values[-1]


def _parts(value: Any) -> Iterator[tuple[str, Drift]]:
    if isinstance(value, Mapping):
        for key, part in value.items():
            yield str(key), part if isinstance(part, Drift) else Drift(part)


def _spans(value: Any, part: str) -> Iterator[tuple[str, Span]]:
    if isinstance(value, Drift):
        yield from _spans(value.value, part)
    elif isinstance(value, Span):
        yield part, value
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _spans(inner, _stream(part, str(key)))


def _plain(value: Any, stream: str, seed: int) -> Any:
    if isinstance(value, Drift):
        return _plain(value.value, stream, seed)
    if isinstance(value, Span):
        return _draw(value, stream, seed)
    if isinstance(value, Mapping):
        return {key: _plain(inner, _stream(stream, str(key)), seed) for key, inner in value.items()}
    return value


def _draw(span: Span, stream: str, seed: int) -> float:
    return span.low + (span.high - span.low) * seeds.uniform(seed, f"drift {stream}")


def _stream(outer: str, part: str) -> str:
    return f"{outer}.{part}" if outer and part else outer or part
