"""The margins of a test: how far each direction may change without breaking the guarantee.

They are stored in a small file below `.tarl/margins`, intended to be committed.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from pytest_tarl.errors import FixtureError
from pytest_tarl.finite_numbers import finite_number
from pytest_tarl.spaces import Choice, nominal, value_of
from pytest_tarl.stressing.findings import CONFIDENCE, Curve, Stress

FORMAT_VERSION = 1  # 1: first version
DIGITS = 6  # significant digits of a value


@dataclass(frozen=True, slots=True)
class Margin:
    """The margin of one side of a range, or of an option.

    The guarantee was shown to hold up to `holds_to` and to fail at `fails_at`; either is None if nothing was shown.
    Values of a range are numbers. For an option, 0 is the nominal option and 1 the option itself.
    """

    name: str  # name of a direction; an option includes its value, as in camera='down'
    nominal: float
    end: float
    holds_to: float | None
    fails_at: float | None

    def share(self, value: float) -> float:
        """Return the position of a value between nominal (0) and the end (1)."""
        return (value - self.nominal) / (self.end - self.nominal)


@dataclass(frozen=True, slots=True)
class Margins:
    """The margins of a test in a space; `confidence` is the confidence of each interval."""

    test: str
    drift: str
    success: float
    loss: float
    confidence: float
    sides: tuple[Margin, ...]

    @property
    def title(self) -> str:
        """Return the test with its drift, in pytest's notation `test[drift]`."""
        return f"{self.test}[{self.drift}]"


def margins(stress: Stress) -> Margins:
    """Return the margins that a stress run found."""
    given = stress.guarantee
    sides = tuple(_margin(curve) for curve in stress.curves)
    return Margins(stress.test, stress.drift, _short(given.rate), _short(given.tolerance), CONFIDENCE, sides)


def text(found: Margins) -> str:
    """Return the content of the file; equal margins give equal bytes."""
    document = {
        "format": FORMAT_VERSION,
        "test": found.test,
        "drift": found.drift,
        "guarantee": {"success": found.success, "loss": found.loss},
        "confidence": found.confidence,
        "directions": [
            {
                "name": one.name,
                "nominal": one.nominal,
                "end": one.end,
                "holds_to": one.holds_to,
                "fails_at": one.fails_at,
            }
            for one in found.sides
        ],
    }
    return f"{json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)}\n"


def read(content: bytes, where: str) -> Margins:
    """Parse the content of a margins file.

    Raise FixtureError if the file is not a margins file; `where` names the file.
    """
    try:
        document = json.loads(content)
        if document["format"] != FORMAT_VERSION:
            raise ValueError(f"format {document['format']!r} instead of {FORMAT_VERSION}")
        given = document["guarantee"]
        return Margins(
            _text(document["test"]),
            _text(document["drift"]),
            _number(given["success"]),
            _number(given["loss"]),
            _number(document["confidence"]),
            tuple(_side(one) for one in document["directions"]),
        )
    except (ValueError, LookupError, TypeError, AttributeError, OverflowError, RecursionError) as problem:
        raise FixtureError(
            f"{where}: not a file of margins ({problem}). Run pytest --tarl-stress again."
        ) from None


def _margin(curve: Curve) -> Margin:
    ray, boundary = curve.ray, curve.boundary
    name = ray.names[0]
    extent = ray.space.extents[name]
    held = curve.held if boundary is None else boundary.near
    if isinstance(extent, Choice):
        option = f"{name}={value_of(extent, ray.farthest[name])!r}"
        return Margin(option, 0.0, 1.0, _ended(held), _ended(curve.confirmed))

    def value(t: float | None) -> float | None:
        return None if t is None else _short(ray.value(t))

    return Margin(
        name, _short(nominal(extent)), _short(ray.farthest[name]), value(held), value(curve.confirmed)
    )


def _ended(t: float | None) -> float | None:
    return None if t is None else 1.0


def _short(number: float) -> float:
    return float(f"{number:.{DIGITS}g}")


def _side(one: Any) -> Margin:
    found = Margin(
        _text(one["name"]),
        _number(one["nominal"]),
        _number(one["end"]),
        *(None if one[key] is None else _number(one[key]) for key in ("holds_to", "fails_at")),
    )
    if found.nominal == found.end:
        raise ValueError(f"direction {found.name!r} has no extent")
    return found


def _number(value: Any) -> float:
    number = finite_number(value)
    if number is None:
        raise ValueError(f"{value!r} is not a number")
    return number


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{value!r} is not a string")
    return value
