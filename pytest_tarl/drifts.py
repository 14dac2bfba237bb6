"""Values of drift scenarios: a plain value, a range, options, a dictionary or a space. Episodes draw from ranges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pytest_tarl import seeds, spaces
from pytest_tarl.errors import SettingsError
from pytest_tarl.schedules import Profile, profile
from pytest_tarl.spaces import Choice, Fault, Point, Space, Span

_FIRST = object()  # default of Drift.choice: the first option is nominal


@dataclass(frozen=True)
class Drift:
    """The value of a drift scenario, or of one key of it if it is a dictionary.

    `permanent` means that the world has changed for good, so a repair need not work in the old world.
    """

    value: Any
    permanent: bool = False

    @classmethod
    def range(
        cls, low: float, high: float, *, nominal: float | None = None, permanent: bool = False
    ) -> Drift:
        """Return a drift whose size varies between episodes. In a space, the range needs a nominal value.

        Raise SettingsError if the range is invalid.
        """
        return cls(spaces.span(f"Drift.range({low!r}, {high!r})", low, high, nominal), permanent)

    @classmethod
    def step(cls, low: float, high: float, *, nominal: float, at: float) -> Drift:
        """Return a drift that starts at time `at` (s); the test gets it as a function of time.

        Raise SettingsError if the range or the time is invalid.
        """
        return cls._over_time("step", low, high, nominal, profile("step", at))

    @classmethod
    def ramp(cls, low: float, high: float, *, nominal: float, at: float, over: float) -> Drift:
        """Return a drift that grows for `over` seconds from time `at` on; the test gets it as a function of time.

        Raise SettingsError if the range, the time or the duration is invalid.
        """
        return cls._over_time("ramp", low, high, nominal, profile("ramp", at, over))

    @classmethod
    def burst(cls, low: float, high: float, *, nominal: float, at: float, lasts: float) -> Drift:
        """Return a drift that starts at time `at` and lasts `lasts` seconds; the test gets it as a function of time.

        Raise SettingsError if the range, the time or the duration is invalid.
        """
        return cls._over_time("burst", low, high, nominal, profile("burst", at, lasts))

    @classmethod
    def _over_time(cls, shape: str, low: float, high: float, nominal: float, course: Profile) -> Drift:
        if nominal is None:
            raise SettingsError(f"Drift.{shape}: give nominal=…, the value before and without the drift.")
        return cls(spaces.span(f"Drift.{shape}({low!r}, {high!r})", low, high, nominal, course))

    @classmethod
    def choice(cls, *options: Any, nominal: Any = _FIRST, permanent: bool = False) -> Drift:
        """Return a drift that takes one of the options in each episode; by default, the first one is nominal.

        Raise SettingsError if there are fewer than two options, or the nominal value is not one of them.
        """
        usual = options[0] if options and nominal is _FIRST else nominal
        return cls(spaces.choice(options, usual), permanent)

    @classmethod
    def space(cls, **directions: Drift | Fault) -> Drift:
        """Return a drift with several directions: ranges with a nominal value, choices or faults.

        Raise SettingsError for any other direction, or a range without a nominal value.
        """
        parts = {name: one.value if isinstance(one, Drift) else one for name, one in directions.items()}
        lasting = [name for name, one in directions.items() if isinstance(one, Drift) and one.permanent]
        if lasting:
            raise SettingsError(
                f"Drift.space: {lasting[0]!r} is permanent, but a space has no single world that the design could "
                "adopt: remove permanent=True, or declare the changed value as a drift of its own."
            )
        return cls(spaces.space(parts))

    @property
    def spans(self) -> Mapping[str, Span]:
        """Return the ranges by dictionary key; if the whole value is a range, the key is ""."""
        return dict(_spans(self.value, ""))


def drift(where: str, name: str, value: Any) -> Drift:
    """Return a marker's scenario as a Drift.

    Raise SettingsError if parts of the scenario contradict each other.
    """
    whole = value if isinstance(value, Drift) else Drift(value)
    if isinstance(whole.value, Drift):
        raise SettingsError(f"{where}: the drift {name!r} is a Drift inside a Drift: remove one of them.")
    if isinstance(whole.value, Space) and whole.permanent:
        raise SettingsError(
            f"{where}: the drift {name!r} is a space, which cannot be permanent: declare the changed value as a drift "
            "of its own."
        )
    parts = list(_parts(whole.value))
    if any(isinstance(inner.value, Space) for _, inner in parts):
        raise SettingsError(
            f"{where}: the drift {name!r} has a Drift.space inside a dictionary: make the space the whole drift."
        )
    lasting = [part for part, inner in parts if inner.permanent]
    passing = [part for part, inner in parts if not inner.permanent]
    if lasting and passing and not whole.permanent:
        raise SettingsError(
            f"{where}: in the drift {name!r}, {lasting[0]!r} is permanent and {passing[0]!r} is not. All parts of a "
            "scenario must agree on `permanent`: split it into two scenarios."
        )
    return Drift(whole.value, whole.permanent or bool(lasting))


def drawn(whole: Drift, name: str, seed: int, point: Point | None = None) -> Any:
    """Return the value of scenario `name` in the episode with this seed; ranges are replaced by drawn numbers.

    A space takes the values of `point`; without one, those of a drawn point.
    """
    if isinstance(whole.value, Space):
        return whole.value.world(drawn_point(whole.value, name, seed) if point is None else point)
    return _plain(whole.value, name, seed)


def drawn_point(space: Space, name: str, seed: int) -> Point:
    """Return the point that the episode with this seed draws from the space of scenario `name`."""
    return {part: _number(extent, _stream(name, part), seed) for part, extent in space.extents.items()}


def sizes(whole: Drift, name: str, seed: int) -> Mapping[str, float]:
    """Return the numbers that the episode with this seed draws from the ranges, by dictionary key."""
    return {part: _draw(span, _stream(name, part), seed) for part, span in whole.spans.items()}


def combined(values: Sequence[Any]) -> Any:
    """Combine several drift values: dictionaries are merged; otherwise the last value wins."""
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
    elif isinstance(value, Space):
        yield from _spans(value.extents, part)
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _spans(inner, _stream(part, str(key)))


def _plain(value: Any, stream: str, seed: int) -> Any:
    if isinstance(value, Drift):
        return _plain(value.value, stream, seed)
    if isinstance(value, Span | Choice):
        return spaces.world_value(value, _number(value, stream, seed))
    if isinstance(value, Mapping):
        return {key: _plain(inner, _stream(stream, str(key)), seed) for key, inner in value.items()}
    return value


def _number(extent: Span | Choice, stream: str, seed: int) -> float:
    if isinstance(extent, Span):
        return _draw(extent, stream, seed)
    count = len(extent.options)
    return float(min(int(count * seeds.uniform(seed, f"drift {stream}")), count - 1))


def _draw(span: Span, stream: str, seed: int) -> float:
    return span.low + (span.high - span.low) * seeds.uniform(seed, f"drift {stream}")


def _stream(outer: str, part: str) -> str:
    return f"{outer}.{part}" if outer and part else outer or part
