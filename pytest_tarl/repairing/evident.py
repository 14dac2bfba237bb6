"""Choose the structural changes that symptoms indicate, and the expressions at which to try them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import PAIR, SENT_BY_SENSOR, Template
from pytest_tarl.repairing.mission_pairs import Signs
from pytest_tarl.repairing.request import Order
from pytest_tarl.repairing.template_forms import forms
from pytest_tarl.repairing.template_places import Spot, axis_twin
from pytest_tarl.symptoms.symptoms import RECEIVED
from tarl_lint.model import Operand, SiteId

STRONG = 0.5  # minimum strength of a symptom that indicates a template
PLACES = 3  # maximum number of expressions for each template
CHANGES = 8  # maximum number of changes, each a template at an expression


def evident(
    order: Order, known: Sequence[Template], among: Sequence[Spot], signs: Signs, least: float = STRONG
) -> Iterator[tuple[Operand, Form]]:
    """Yield the operands of the `CHANGES` with the strongest symptoms, the strongest first.

    Equal strengths are ordered by the cost of the template. Each template has `PLACES`. If the value is wrong where it
    is received, the places next to the subscription come first; otherwise, the places next to the publish call come
    first. The arguments of the publish call come last, since a named value reads better. What shows a symptom along two
    axes is changed for both. Symptoms weaker than `least` are left out.
    """
    before = _before_sending(order)
    found: list[tuple[float, int, list[tuple[Operand, Form]]]] = []
    for template in known:
        if not template.symptoms or template.on == SENT_BY_SENSOR:
            continue
        told = {spot: _strength(spot, template, signs, before) for spot in among}
        strong = [spot for spot in among if told[spot] >= least]
        if not strong:
            continue
        received = any(one in RECEIVED for one in template.symptoms)
        strong.sort(
            key=lambda spot: (str(spot.site) not in signs.strengths, -spot.away if received else spot.away)
        )
        if template.on == PAIR:
            found += [(told[strong[0]], template.cost, each) for each in forms(order, template, strong)]
            continue
        fitting = [
            (spot, each)
            for at, spot in enumerate(strong)
            if axis_twin(spot, strong[at + 1 :]) is None
            for each in forms(order, template, [spot], strong[:at])
            if each
        ]
        found += [(told[spot], template.cost, each) for spot, each in fitting[:PLACES]]
    found.sort(key=lambda one: (-round(one[0], 1), one[1]))
    for _, _, each in found[:CHANGES]:
        yield from each


def _strength(spot: Spot, template: Template, signs: Signs, before: Mapping[SiteId, Sequence[str]]) -> float:
    sites = [str(spot.site)] if str(spot.site) in signs.strengths else before.get(spot.site, ())
    return max((signs.strength(site, template.symptoms) for site in sites), default=0.0)


def _before_sending(order: Order) -> dict[SiteId, list[str]]:
    """Return the statements whose values a publish call receives; the recording has no values of the call itself."""
    found: dict[SiteId, list[str]] = {}
    for flow in order.analysis.flows:
        if len(flow.steps) > 1:
            found.setdefault(flow.steps[-1].site, []).append(str(flow.steps[-2].site))
    return found
