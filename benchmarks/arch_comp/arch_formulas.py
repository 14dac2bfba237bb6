"""The robustness of the formulas of ARCH-COMP's falsification category for three models; below 0 is a violation.

The formulas are those of the reports (ARCH-COMP 2020, EPiC Series in Computing 74, section 3). Robustness is that of
quantitative semantics (Donzé & Maler 2010). Discrete signals are ±1, and the terms of AT6 are scaled to 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from arch_models import AT_STEP, CC_STEP, WT_STEP, Signal

Outputs = Mapping[str, Signal]
Robustness = Callable[[Outputs], float]


def always(values: Signal, low: float, high: float, step: float) -> Signal:
    """Return for each time t the minimum of the signal from t + `low` to t + `high` (s), up to the signal's end."""
    return -eventually(-values, low, high, step)


def eventually(values: Signal, low: float, high: float, step: float) -> Signal:
    """Return for each time t the maximum of the signal from t + `low` to t + `high` (s), up to the signal's end."""
    first, count = round(low / step), round((high - low) / step) + 1
    size = len(values)
    padded = np.concatenate([values[first:], np.full(first + count, -np.inf)])
    width, found = 1, padded
    while 2 * width <= count:  # doubling: found[i] is the maximum of padded[i : i + width]
        found = np.maximum(found[:-width], found[width:])
        width *= 2
    rest = count - width
    whole: Signal = np.maximum(found[: len(found) - rest], found[rest:]) if rest else found
    return whole[:size]


def within(values: Signal, low: float, high: float, step: float) -> float:
    """Return the minimum of the signal from `low` to `high` (s)."""
    return float(values[round(low / step) : round(high / step) + 1].min())


def at1(out: Outputs) -> float:
    """□[0, 20] speed < 120."""
    return within(120.0 - out["speed"], 0.0, 20.0, AT_STEP)


def at2(out: Outputs) -> float:
    """□[0, 10] rpm < 4750."""
    return within(4750.0 - out["rpm"], 0.0, 10.0, AT_STEP)


def at5(gear: int) -> Robustness:
    """□[0, 30] ((gear ≠ g ∧ ◇[0.001, 0.1] gear = g) ⇒ ◇[0.001, 0.1] □[0, 2.5] gear = g)."""

    def robustness(out: Outputs) -> float:
        there = np.where(out["gear"] == gear, 1.0, -1.0)
        begins = np.minimum(-there, eventually(there, AT_STEP, 0.1, AT_STEP))
        stays = eventually(always(there, 0.0, 2.5, AT_STEP), AT_STEP, 0.1, AT_STEP)
        return within(np.maximum(-begins, stays), 0.0, 30.0, AT_STEP)

    return robustness


def at6(seconds: float, speed: float) -> Robustness:
    """□[0, 30] rpm < 3000 ⇒ □[0, t] speed < v."""

    def robustness(out: Outputs) -> float:
        slow = within((speed - out["speed"]) / speed, 0.0, seconds, AT_STEP)
        return max(-within((3000.0 - out["rpm"]) / 3000.0, 0.0, 30.0, AT_STEP), slow)

    return robustness


def at6abc(out: Outputs) -> float:
    """The conjunction of AT6a, AT6b and AT6c."""
    return min(at6(4.0, 35.0)(out), at6(8.0, 50.0)(out), at6(20.0, 65.0)(out))


def _gap(out: Outputs, car: int) -> Signal:
    return out[f"y{car}"] - out[f"y{car - 1}"]


def cc1(out: Outputs) -> float:
    """□[0, 100] y5 - y4 ≤ 40."""
    return within(40.0 - _gap(out, 5), 0.0, 100.0, CC_STEP)


def cc2(out: Outputs) -> float:
    """□[0, 70] ◇[0, 30] y5 - y4 ≥ 15."""
    return within(eventually(_gap(out, 5) - 15.0, 0.0, 30.0, CC_STEP), 0.0, 70.0, CC_STEP)


def cc3(out: Outputs) -> float:
    """□[0, 80] (□[0, 20] y2 - y1 ≤ 20 ∨ ◇[0, 20] y5 - y4 ≥ 40)."""
    near = always(20.0 - _gap(out, 2), 0.0, 20.0, CC_STEP)
    far = eventually(_gap(out, 5) - 40.0, 0.0, 20.0, CC_STEP)
    return within(np.maximum(near, far), 0.0, 80.0, CC_STEP)


def cc4(out: Outputs) -> float:
    """□[0, 65] ◇[0, 30] □[0, 5] y5 - y4 ≥ 8."""
    steady = always(_gap(out, 5) - 8.0, 0.0, 5.0, CC_STEP)
    return within(eventually(steady, 0.0, 30.0, CC_STEP), 0.0, 65.0, CC_STEP)


def cc5(out: Outputs) -> float:
    """□[0, 72] ◇[0, 8] (□[0, 5] y2 - y1 ≥ 9 ⇒ □[5, 20] y5 - y4 ≥ 9)."""
    first = always(_gap(out, 2) - 9.0, 0.0, 5.0, CC_STEP)
    last = always(_gap(out, 5) - 9.0, 5.0, 20.0, CC_STEP)
    return within(eventually(np.maximum(-first, last), 0.0, 8.0, CC_STEP), 0.0, 72.0, CC_STEP)


def ccx(out: Outputs) -> float:
    """□[0, 50] y(i+1) - y(i) > 7.5 for each i."""
    return min(within(_gap(out, car) - 7.5, 0.0, 50.0, CC_STEP) for car in range(2, 6))


def wt1(out: Outputs) -> float:
    """□[30, 630] pitch ≤ 14.2."""
    return within(14.2 - out["pitch"], 30.0, 630.0, WT_STEP)


def wt2(out: Outputs) -> float:
    """□[30, 630] 21000 ≤ torque ≤ 47500."""
    return within(np.minimum(out["torque"] - 21000.0, 47500.0 - out["torque"]), 30.0, 630.0, WT_STEP)


def wt3(out: Outputs) -> float:
    """□[30, 630] rotor ≤ 14.3."""
    return within(14.3 - out["rotor"], 30.0, 630.0, WT_STEP)


def wt4(out: Outputs) -> float:
    """□[30, 630] ◇[0, 5] |pitch - wanted pitch| ≤ 1.6."""
    apart = 1.6 - np.abs(out["pitch"] - out["pitch_wanted"])
    return within(eventually(apart, 0.0, 5.0, WT_STEP), 30.0, 625.0, WT_STEP)


AUTOMATIC_TRANSMISSION: Mapping[str, Robustness] = {
    "AT1": at1,
    "AT2": at2,
    **{f"AT5{gear}": at5(gear) for gear in range(1, 5)},
    "AT6a": at6(4.0, 35.0),
    "AT6b": at6(8.0, 50.0),
    "AT6c": at6(20.0, 65.0),
    "AT6abc": at6abc,
}
CHASING_CARS: Mapping[str, Robustness] = {
    "CC1": cc1,
    "CC2": cc2,
    "CC3": cc3,
    "CC4": cc4,
    "CC5": cc5,
    "CCx": ccx,
}
WIND_TURBINE: Mapping[str, Robustness] = {"WT1": wt1, "WT2": wt2, "WT3": wt3, "WT4": wt4}
