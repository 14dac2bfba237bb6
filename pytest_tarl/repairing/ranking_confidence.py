"""Describe how certain the ranking of the sites is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pytest_tarl.model import OperandEffect
from pytest_tarl.repairing.accepting import Accepted
from pytest_tarl.repairing.request import Order
from pytest_tarl.report import amounts
from pytest_tarl.report.guarantee_words import percent
from pytest_tarl.searching.race import CONFIDENCE
from pytest_tarl.searching.ranking import Ranking


def ranking_confidence(
    order: Order,
    effects: Mapping[str, Sequence[OperandEffect]],
    accepted: Accepted | None,
    ranking: Ranking | None,
) -> str:
    """Return a sentence about the evidence for the ranking, or "" if nothing was simulated."""
    if not effects:
        return ""
    sites = len({step.site for step in order.analysis.sites})
    places = (
        list(dict.fromkeys(str(m.operand.site) for m in accepted.candidate.mutations)) if accepted else []
    )
    held = len(accepted.acceptance.drifted) if accepted else 0
    if len(places) > 1:
        first = (
            f"the first {len(places)} lines were repaired together; the repair passed on {held} fresh seeds"
        )
    elif places:
        first = f"the repair of the first line passed on {held} fresh seeds"
    else:
        first = "no accepted repair confirms the first line"
    if ranking is None:
        simulated = f"{len(effects)} of {sites} lines were simulated, most of them in few runs"
        return f"{first}; {simulated} (--tarl-localize=full ranks all)"
    cut = "" if ranking.whole else "; the budget ended before all were ranked"
    return f"{first}; {_raced(ranking, places, effects)}{cut}"


def _raced(ranking: Ranking, places: Sequence[str], effects: Mapping[str, Sequence[OperandEffect]]) -> str:
    first = places[0] if places else max(effects, key=lambda site: max(one.effect for one in effects[site]))
    found = ranking.certainty(first) if len(places) < 2 else None
    if found is None:
        return f"{len(effects)} lines were simulated alone, with every factor"
    told = f"{found.gaining} of {len(effects)} lines with constants gain reward when changed alone"
    if found.by is None:
        return told
    low, high = found.by
    by = f"{amounts.signed(low)} to {amounts.signed(high)} per episode"
    span = f"{by}, about {percent(CONFIDENCE)}, {found.seeds} common seeds"
    if found.ahead:
        more = "one line gains" if found.ahead == 1 else f"{found.ahead} lines gain"
        return f"{told}; {more} more than the first line in the drifted world ({span})"
    if found.level:
        others = "one other" if found.level == 1 else f"{found.level} others"
        return f"{told}; {others} cannot be distinguished from the first line (the next: {span})"
    return f"{told}; the first line gains more than the next ({span})"
