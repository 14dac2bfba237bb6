"""Sentences on how certain the ranking is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import OperandEffect
from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.repairing.accepting import Accepted
from pytest_tarl.repairing.ranking_confidence import ranking_confidence
from pytest_tarl.searching.accept import Acceptance, Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.ranking import Certainty, Ranking
from pytest_tarl.searching.search import Candidate, Trials
from tests.plugin.searching.test_search import BIAS, GAIN, GOAL, LIMIT, OPERANDS, run

ORDER: Any = SimpleNamespace(
    analysis=SimpleNamespace(sites=[SimpleNamespace(site=one.site) for one in OPERANDS])
)
EFFECTS = {
    str(one.site): [OperandEffect(one.code, 1.0, 2.0, gain)] for one, gain in ((GAIN, 6.0), (LIMIT, 0.0))
}


def accepted(*operands: Any) -> Accepted:
    held = tuple(Outcome(10.0, True) for _ in range(12))
    candidate = Candidate(tuple(Mutation(one, 2.0) for one in operands), ALWAYS)
    return Accepted(candidate, Acceptance(True, "", held, ()))


def ranked(budget: int) -> Ranking:
    found = Ranking(OPERANDS, mutations, ALWAYS, Trials(run, budget), GOAL)
    found.run()
    return found


def test_missing_ranking_states_the_simulated_lines() -> None:
    told = ranking_confidence(ORDER, EFFECTS, accepted(GAIN), None)
    assert told.startswith(
        "the repair of the first line passed on 12 fresh seeds; 2 of 3 lines were simulated"
    )
    assert "--tarl-localize=full" in told


def test_ranking_states_the_lead_of_the_first_line() -> None:
    told = ranking_confidence(ORDER, ranked(300).effects(), accepted(GAIN), ranked(300))
    assert "1 of 3 lines with constants gain reward when changed alone" in told
    assert "the budget ended" not in told


def test_first_line_is_not_best_if_others_gain_more() -> None:
    assert "one line gains more than the first line in the drifted world (-" in ranking_confidence(
        ORDER, EFFECTS, accepted(BIAS), raced()
    )


def raced() -> Ranking:
    """Return a ranking in which a line without effect ran on as many seeds as the best line."""
    found = ranked(300)
    found.race.run([arm for arm in found.race.gains if arm.unit.operands[0] == BIAS], 8)
    return found


def test_lines_repaired_together_are_reported_together() -> None:
    told = ranking_confidence(ORDER, EFFECTS, accepted(GAIN, LIMIT), ranked(300))
    assert told.startswith(
        "the first 2 lines were repaired together; the repair passed on 12 fresh seeds; 2 lines were simulated alone"
    )


def test_ranking_states_that_it_is_incomplete() -> None:
    told = ranking_confidence(ORDER, EFFECTS, None, ranked(4))
    assert told.startswith("no accepted repair confirms the first line; ")
    assert told.endswith("the budget ended before all were ranked")


def test_without_simulation_the_ranking_has_no_sentence_on_confidence() -> None:
    assert ranking_confidence(ORDER, {}, None, None) == ""


def certain(**changes: Any) -> str:
    """Return the sentence for a ranking with this certainty of its first line."""
    found = Certainty(**{"gaining": 2, "level": 0, "ahead": 0, "by": (-0.5, 1.25), "seeds": 9, **changes})
    ranking: Any = SimpleNamespace(
        whole=True, certainty=lambda site: found if site == str(GAIN.site) else None
    )
    return ranking_confidence(ORDER, EFFECTS, accepted(GAIN), ranking)


HELD = "the repair of the first line passed on 12 fresh seeds"
TOLD = f"{HELD}; 2 of 2 lines with constants gain reward when changed alone"
SPAN = "-0.50 to +1.25 per episode, about 95 %, 9 common seeds"


@pytest.mark.parametrize(
    ("changes", "end"),
    [
        ({}, f"; the first line gains more than the next ({SPAN})"),
        ({"by": None}, ""),
        ({"level": 1}, f"; one other cannot be distinguished from the first line (the next: {SPAN})"),
        ({"level": 3}, f"; 3 others cannot be distinguished from the first line (the next: {SPAN})"),
        ({"ahead": 1}, f"; one line gains more than the first line in the drifted world ({SPAN})"),
        ({"ahead": 2, "level": 1}, f"; 2 lines gain more than the first line in the drifted world ({SPAN})"),
    ],
)
def test_report_counts_the_competitors_of_the_first_line(changes: dict[str, Any], end: str) -> None:
    assert certain(**changes) == TOLD + end


def test_largest_effect_leads_without_a_repair() -> None:
    asked = []
    ranking: Any = SimpleNamespace(whole=False, certainty=asked.append)
    told = ranking_confidence(ORDER, EFFECTS, None, ranking)
    assert asked == [str(GAIN.site)]
    assert told == (
        "no accepted repair confirms the first line; 2 lines were simulated alone, with every factor; the budget ended "
        "before all were ranked"
    )
