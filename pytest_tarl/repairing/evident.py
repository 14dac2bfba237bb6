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
    """Yield the operands of at most `CHANGES` changes with the strongest symptoms, strongest first.

    Equally strong symptoms are ordered by the cost of the template. Each template is tried at up to `PLACES`
    expressions. If a value is already wrong where it is received, expressions next to the subscription come first;
    otherwise, expressions next to the publish call come first. Arguments of the publish call come last, because a
    change of a named value is easier to read. If a symptom shows along two axes, both are changed. Symptoms weaker than
    `least` are left out.
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
    """Map each publish call to the statements that compute its values: the call itself has no recorded value."""
    found: dict[SiteId, list[str]] = {}
    for flow in order.analysis.flows:
        if len(flow.steps) > 1:
            found.setdefault(flow.steps[-1].site, []).append(str(flow.steps[-2].site))
    return found
