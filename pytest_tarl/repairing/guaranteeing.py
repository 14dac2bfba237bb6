"""Guarantees for a repaired program, from fresh episodes that neither the search nor the acceptance has used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pytest_tarl import seeds
from pytest_tarl.learning.bounds import Range
from pytest_tarl.learning.guarantees import stated
from pytest_tarl.model import Guarantee
from pytest_tarl.repairing.accepting import Accepted
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.searching.accept import Outcome


def guaranteed(mutants: Mutants, accepted: Accepted) -> tuple[Mapping[str, Guarantee], int]:
    """Return bounds for the drifted and the designed world, and the number of episodes run.

    If the repair changes nothing in the designed world, the bounds from the recording apply there. If the drift is
    permanent, there are no bounds for the designed world.
    """
    order = mutants.order
    count = order.options.episodes or order.options.ONLINE_EPISODES
    fresh = seeds.episode_seeds(order.options.seed, "stated", count)
    found = {"repaired": _stated(mutants, accepted, fresh, order.drift)}
    if order.permanent:
        return found, count
    if accepted.acceptance.nominal:
        found["nominal_repaired"] = _stated(mutants, accepted, fresh, None)
        return found, 2 * count
    if order.fixture.stated is not None:
        found["nominal_repaired"] = order.fixture.stated
    return found, count


def _stated(mutants: Mutants, accepted: Accepted, fresh: Sequence[int], drift: str | None) -> Guarantee:
    order = mutants.order
    mutants.foresee([(accepted.candidate, seed) for seed in fresh], drift)
    outcomes = []
    for done, seed in enumerate(fresh):
        order.progress(done, len(fresh), "bounds of the repair")
        outcomes.append(mutants.run(accepted.candidate, seed, drift))
    totals = [one.total for one in outcomes]
    inside = (
        order.declared is not None and order.declared[0] <= min(totals) <= max(totals) <= order.declared[1]
    )
    recorded = order.fixture.stated
    return stated(
        [one.passed for one in outcomes],
        totals,
        confidence=recorded.success.confidence if recorded else None,
        declared=Range(*order.declared) if order.declared is not None and inside else None,
        varied=_vary(outcomes),
    )


def _vary(outcomes: Sequence[Outcome]) -> bool:
    return len({(one.total, one.passed) for one in outcomes}) > 1
