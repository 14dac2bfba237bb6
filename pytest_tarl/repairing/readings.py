"""Correct sensor readings that are wrong from the start, by an offset or a factor.

Both missions of a pair begin in the same state, and when the first message arrives, no command has had an effect yet.
If the first value of a statement then differs by the same amount or factor in all pairs, the sensor is wrong. For
example, a lidar is bent, or a scale has lost its zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.templates import Template, templates
from pytest_tarl.repairing.mission_pairs import Recorded, series
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.template_forms import forms
from pytest_tarl.repairing.template_places import spots
from pytest_tarl.symptoms.series import Series

OFFSET, GAIN = "offset", "gain"  # templates that correct a reading
MOST = 2  # maximum number of readings that are corrected
FIRST = 2  # number of steps at the start in which a reading cannot yet depend on commands
AGREE = 0.1  # maximum difference between the changes of the mission pairs, as a share of the change
LEAST = 0.02  # minimum change of a reading, as a share of the size of its first value


@dataclass(frozen=True)
class Correction:
    """The template that corrects a reading, and the value of its parameter."""

    template: str
    value: float


def corrections(order: Order, recorded: Sequence[Recorded]) -> list[Mutation]:
    """Return corrections of the readings whose first values differ. Readings near the subscription come first."""
    wrong = _wrong(order, recorded)
    known = {one.name: one for one in templates(order.root)}
    found: dict[str, Mutation] = {}
    for spot in sorted(spots(order), key=lambda one: -one.away) if wrong else ():
        site = str(spot.site)
        correction = wrong.get(site)
        if correction is None or site in found or correction.template not in known:
            continue
        made: Template = known[correction.template]
        for (operand, form), *_ in forms(order, made, [spot]):
            start = dict(form.defaults)[form.parameter]
            if start:
                found[site] = Mutation(operand, correction.value / start, form=form)
    return list(found.values())[:MOST]


def _wrong(order: Order, recorded: Sequence[Recorded]) -> Mapping[str, Correction]:
    """Return the corrections of the statements whose first values differ, by site id."""
    found: dict[str, Correction] = {}
    for number, place in enumerate(plan(order.analysis).places):
        firsts = [
            (first_value(series(one, number)), first_value(series(other, number))) for one, other in recorded
        ]
        known = [(one, other) for one, other in firsts if one is not None and other is not None]
        if len(known) == len(recorded) > 1 and place.role != "publish":
            correction = _correction(known)
            found |= {place.id: correction} if correction is not None else {}
    return found


def first_value(values: Series) -> float | None:
    """Return the first value if it comes before any command can have had an effect, else None."""
    early = values.values.size and values.step[0] < FIRST
    return float(values.values[0]) if early else None


def _correction(firsts: Sequence[tuple[float, float]]) -> Correction | None:
    """Return a correction by an offset or by a factor, whichever fits the (designed, drifted) values better."""
    size = max(abs(designed) for designed, _ in firsts)
    offsets = [designed - drifted for designed, drifted in firsts]
    explained: list[tuple[float, Correction | None]] = []
    if min(map(abs, offsets)) > LEAST * size:
        explained.append((spread(offsets), Correction(OFFSET, _rounded(offsets))))
        factors = [designed / drifted for designed, drifted in firsts if drifted]
        if len(factors) == len(firsts) and min(factors) > 0.0:
            explained.append((spread([one - 1.0 for one in factors]), Correction(GAIN, _rounded(factors))))
    least, best = min(explained, key=lambda one: one[0], default=(1.0, None))
    return best if least <= AGREE else None


def spread(changes: Sequence[float]) -> float:
    """Return the range of the changes as a share of their mean, or 1 if the mean is 0."""
    mean = sum(changes) / len(changes)
    return (max(changes) - min(changes)) / abs(mean) if mean else 1.0


def _rounded(values: Sequence[float]) -> float:
    return float(f"{sum(values) / len(values):.3g}")
