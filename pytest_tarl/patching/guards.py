"""Write guards (conditions on sensors) as Python expressions that cannot raise."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.absence import is_checked
from pytest_tarl.patching.bindings import Constant, initial, is_bound
from pytest_tarl.patching.document import Document
from pytest_tarl.patching.expression_texts import rounded
from pytest_tarl.sensors import Sensor
from pytest_tarl.variables import prefixes


@dataclass(frozen=True, slots=True)
class Reading:
    """An expression for a sensor's value; its part `absent` is None before the first message."""

    code: str
    absent: str = ""


def condition(guard: Guard, readings: Mapping[str, Reading], topics: Mapping[str, str]) -> str:
    """Return a guard as Python, or an empty text if it always holds; `readings` maps sensors to expressions."""
    parts: list[str] = []
    for conjunct in guard.conjuncts:
        if not always(conjunct):
            reading = readings[conjunct.sensor.name]
            is_boolean = boolean(conjunct.sensor, topics)
            harmless = reading.absent == reading.code and _rejects_none(conjunct, is_boolean)
            parts += [f"{reading.absent} is not None"] if reading.absent and not harmless else []
            parts.append(_test(conjunct, reading.code, is_boolean))
    return " and ".join(dict.fromkeys(parts))


def always(conjunct: Conjunct) -> bool:
    """Return whether a condition holds for every value."""
    return conjunct.low == -math.inf and conjunct.high == math.inf


def boolean(sensor: Sensor, topics: Mapping[str, str]) -> bool:
    """Return whether a sensor is boolean."""
    plain = not sensor.numeric and not sensor.categories
    return (
        plain and sensor.field == "data" and topics.get(sensor.topic or "", "").rpartition("/")[2] == "Bool"
    )


def held(source: Document, place: ast.AST, expressions: Iterable[str], conjunct: Conjunct) -> Reading | None:
    """Return the first expression that can be evaluated at `place`, or None.

    Expressions are skipped if they may be unbound at `place`, or if their initial value makes the condition true. The
    condition must be false until the first message, so that the original code runs until then.
    """
    for code in expressions:
        chain = prefixes(code)
        if chain and is_bound(source, place, code) and not _starts_true(source, place, chain, conjunct):
            absent = next((each for each in chain if None in initial(source, place, each)[0]), "")
            return Reading(code, "" if is_checked(source, place, absent) else absent)
    return None


def bound(sensor: Sensor, value: float) -> str:
    """Format a bound, rounded to about one hundredth of a bin."""
    if sensor.bins is None or sensor.low is None or sensor.high is None:
        return repr(int(value) if float(value).is_integer() else rounded(value))
    width = sensor.resolution
    return repr(round(float(value), 2 - math.floor(math.log10(width))) + 0.0)


def _starts_true(source: Document, place: ast.AST, chain: tuple[str, ...], conjunct: Conjunct) -> bool:
    """Return whether a condition can hold for a message of zeros."""
    constants = initial(source, place, chain[-1])[0]
    if any(initial(source, place, each)[1] for each in chain):
        constants.add(0.0)
    return any(_satisfied(conjunct, value) for value in constants)


def _satisfied(conjunct: Conjunct, value: Constant) -> bool:
    if isinstance(value, str) or conjunct.sensor.categories:
        return value in _chosen(conjunct)
    if value is None:
        return False
    number = float(value)
    # the interval wraps around the end of the angle's range, as from 3.0 to -3.0
    if conjunct.low > conjunct.high:
        return number >= conjunct.low or number <= conjunct.high
    return conjunct.low <= number <= conjunct.high


def _test(conjunct: Conjunct, code: str, is_boolean: bool) -> str:
    sensor, low, high = conjunct.sensor, conjunct.low, conjunct.high
    if sensor.categories:
        chosen = [_quoted(name) for name in _chosen(conjunct)]
        return f"{code} == {chosen[0]}" if len(chosen) == 1 else f"{code} in ({', '.join(chosen)})"
    if low != high:
        return _interval(sensor, low, high, code)
    if is_boolean:
        return code if low else f"not {code}"
    return f"{code} == {bound(sensor, low)}"


def _interval(sensor: Sensor, low: float, high: float, code: str) -> str:
    """Return the condition `low <= code < high`, with `<=` on both sides if `high` is the end of the range.

    If an angle's interval wraps around the end of the range, the condition is about the difference from `low`.
    """
    if low > high:
        period = (sensor.high or 0.0) - (sensor.low or 0.0)
        turned = f"({code} {'+' if low < 0 else '-'} {bound(sensor, abs(low))}) % {period!r}"
        return f"{turned} < {bound(sensor, high - low + period)}"
    above = "<" if _is_top(sensor, low) else "<="
    below = "<" if sensor.numeric and not _is_top(sensor, high) else "<="
    if high == math.inf:
        return f"{code} {'>' if above == '<' else '>='} {bound(sensor, low)}"
    if low == -math.inf:
        return f"{code} {below} {bound(sensor, high)}"
    return f"{bound(sensor, low)} {above} {code} {below} {bound(sensor, high)}"


def _is_top(sensor: Sensor, value: float) -> bool:
    """Return whether a bound is the upper end of a sensor's range."""
    return sensor.numeric and math.isclose(value, sensor.high or 0.0, rel_tol=1e-9, abs_tol=1e-9)


def _chosen(conjunct: Conjunct) -> tuple[str, ...]:
    names = conjunct.sensor.categories
    first = math.ceil(max(conjunct.low, 0.0))
    last = math.floor(min(conjunct.high, len(names) - 1.0))
    return names[first : last + 1]


def _quoted(text: str) -> str:
    plain = repr(text)
    return f'"{plain[1:-1]}"' if plain[0] == "'" and '"' not in plain else plain


def _rejects_none(conjunct: Conjunct, is_boolean: bool) -> bool:
    """Return whether the condition is False for None and does not raise."""
    equality = bool(conjunct.sensor.categories) or conjunct.low == conjunct.high
    return equality and not (is_boolean and not conjunct.low)
