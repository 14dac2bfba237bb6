"""Races on common seeds, the search by halving, and the full ranking."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.halving import Halving
from pytest_tarl.searching.race import Arm, Race, behind
from pytest_tarl.searching.ranking import Ranking
from pytest_tarl.searching.search import Candidate, Trials
from pytest_tarl.searching.units import units
from tests.plugin.searching.test_search import BIAS, GAIN, GOAL, LIMIT, NEEDED, OPERANDS, PAIRS, run


def arms(*factors: float) -> list[Arm]:
    (unit,) = units([GAIN])
    return [Arm(unit, factor, ALWAYS) for factor in factors]


def test_all_changes_run_on_the_same_seeds() -> None:
    ran: list[tuple[float, int]] = []

    def counted(candidate: Candidate, seed: int) -> object:
        ran.append((float(candidate.mutations[0].value), seed))
        return run(candidate, seed)

    race = Race(mutations, Trials(counted, 100), GOAL)  # type: ignore[arg-type]
    race.run(arms(2.2, 5.0), 2)
    race.run(arms(2.2), 4)
    assert len(ran) == len(set(ran)) == 6
    assert set(race.gains[arms(2.2)[0]]) == {pair.seed for pair in PAIRS[:4]}


def test_paired_gains_cancel_seed_noise() -> None:
    race = Race(mutations, Trials(run, 100), GOAL)
    race.run(arms(2.0), 5)
    assert race.gains[arms(2.0)[0]] == pytest.approx(dict.fromkeys(range(5), 6 * math.log(2.0)))


def test_refinement_adds_factors_in_between() -> None:
    race = Race(mutations, Trials(run, 100), GOAL)
    race.run(arms(1.5, 2.4, 5.0), 1)
    assert [arm.factor for arm in race.around(arms(2.4)[0])] == [round(math.sqrt(1.5 * 2.4), 3), 3.464]
    race.run(arms(2.41), 1)
    assert 2.405 not in [arm.factor for arm in race.around(arms(2.4)[0])]


def test_three_common_seeds_suffice_to_drop_a_change() -> None:
    assert behind({0: 1.0, 1: 1.1, 2: 0.9}, {0: 5.0, 1: 5.2, 2: 4.9})
    assert not behind({0: 1.0, 1: 1.1}, {0: 5.0, 1: 5.2})
    assert not behind({0: 1.0, 1: 9.0, 2: 5.0}, {0: 5.0, 1: 5.2, 2: 4.9})


def test_halving_finds_the_right_value_between_its_initial_factors() -> None:
    trials = Trials(run, 300)
    search = Halving(OPERANDS, mutations, (ALWAYS,), trials, GOAL)
    found = next(search.candidates())
    assert [mutation.operand for mutation in found.mutations] == [GAIN]
    assert float(found.mutations[0].value) / 2.0 == pytest.approx(NEEDED, rel=0.2)
    effects = search.effects()
    assert max(effects, key=lambda site: effects[site][0].effect) == str(GAIN.site)


def test_halving_spends_its_later_rounds_on_changes_that_gain() -> None:
    ran: list[object] = []

    def counted(candidate: Candidate, seed: int) -> object:
        ran.append(candidate.mutations[0].operand)
        return run(candidate, seed)

    hard = replace(GOAL, near=9.99e9)
    list(Halving(OPERANDS, mutations, (ALWAYS,), Trials(counted, 300), hard).candidates())  # type: ignore[arg-type]
    assert ran.count(GAIN) > 2 * ran.count(LIMIT)


def test_full_ranking_reports_its_certainty() -> None:
    ranking = Ranking(OPERANDS, mutations, ALWAYS, Trials(run, 300), GOAL)
    ranking.run()
    assert ranking.whole
    assert set(ranking.effects()) == {str(one.site) for one in (GAIN, BIAS, LIMIT)}
    sure = ranking.certainty(str(GAIN.site))
    assert sure is not None
    assert (sure.gaining, sure.level, sure.ahead) == (1, 0, 0)
    wrong = ranking.certainty(str(LIMIT.site))
    assert wrong is not None
    assert wrong.by is None or wrong.by[1] < 0
    assert ranking.certainty("elsewhere") is None


def test_two_equivalent_sites_cannot_be_distinguished() -> None:
    twin = replace(GAIN, site=replace(GAIN.site, text="y = 2.0"))

    def either(candidate: Candidate, seed: int) -> object:
        as_gain = tuple(replace(m, operand=GAIN) if m.operand == twin else m for m in candidate.mutations)
        return run(replace(candidate, mutations=as_gain), seed)

    ranking = Ranking((GAIN, twin, LIMIT), mutations, ALWAYS, Trials(either, 300), GOAL)  # type: ignore[arg-type]
    ranking.run()
    sure = ranking.certainty(str(GAIN.site))
    assert sure is not None
    assert (sure.gaining, sure.level) == (2, 1)
    assert sure.by == pytest.approx((0.0, 0.0))


def test_a_ranking_whose_budget_ends_is_incomplete() -> None:
    ranking = Ranking(OPERANDS, mutations, ALWAYS, Trials(run, 5), GOAL)
    ranking.run()
    assert not ranking.whole
    assert ranking.effects()


def test_ineffective_constants_run_only_on_the_first_seed() -> None:
    ran: dict[str, set[int]] = {}

    def noted(candidate: Candidate, seed: int) -> object:
        for one in candidate.mutations:
            ran.setdefault(one.operand.code, set()).add(seed)
        return run(candidate, seed)

    Ranking(OPERANDS, mutations, ALWAYS, Trials(noted, 300), GOAL).run()  # type: ignore[arg-type]
    assert ran[LIMIT.code] == {PAIRS[0].seed}
    assert len(ran[GAIN.code]) > 3
