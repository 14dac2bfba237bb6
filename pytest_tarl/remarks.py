"""What a comparison remarks beside its verdict: what was lost, what is new, what the reward does not say."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pytest_tarl import seeds
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.learning import judgements
from pytest_tarl.learning.drift import Difference
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.marginal import apart
from pytest_tarl.learning.permutation import permuted_loss
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import SitePlace, Verdict
from pytest_tarl.options import Options
from pytest_tarl.searching.accept import PASS_RATE_LOSS
from pytest_tarl.sensors import Sensor

MOST_NAMED = 3  # lost sites that a note names


def of_comparison(
    fixture: Fixture, plan: Plan, offline: Sample, online: Sample, difference: Difference, options: Options
) -> tuple[str, ...]:
    """Return what is to be said of two samples that were compared, over the same cells."""
    return (
        *unheard_of(offline, online, difference, fixture.sensors),
        *lost_sites(fixture, plan),
        *failing(offline, online, difference.verdict, options),
        *other_formulas(offline, online),
    )


def early(online: Sample, planned: int) -> tuple[str, ...]:
    """Tell that not all episodes were needed."""
    if online.episodes == planned:
        return ()
    return (
        f"stopped after {online.episodes} of {planned} episodes: the verdict was certain (--tarl-looks 1 runs all).",
    )


def lost_sites(fixture: Fixture, plan: Plan) -> tuple[str, ...]:
    """Tell which recorded sites the node no longer has; their slices are lost, verdict and region are not."""
    present = {place.id for place in plan.places}
    gone: dict[str, SitePlace] = {}
    for one in fixture.lists:
        gone.update({site.id: site for site in one.sites if site.id not in present})
    if not gone:
        return ()
    named = [f"{site.path}:{site.line} `{site.code}`" for site in gone.values()][:MOST_NAMED]
    more = f" and {len(gone) - MOST_NAMED} more" if len(gone) > MOST_NAMED else ""
    return (
        (
            f"the node was edited since the recording: the slices of {', '.join(named)}{more} are lost; verdict and "
            "region stand. Record again with --tarl-record once the change is meant to stay."
        ),
        *_moved(fixture, plan),
    )


def _moved(fixture: Fixture, plan: Plan) -> tuple[str, ...]:
    """Tell which recorded sites stand on another line: they keep their slices."""
    now = {place.id: place for place in plan.places}
    moved = {
        f"`{site.code}` from line {site.line} to {now[site.id].line}": None
        for one in fixture.lists
        for site in one.sites
        if site.id in now and now[site.id].line != site.line
    }
    if not moved:
        return ()
    named = ", ".join(list(moved)[:MOST_NAMED])
    more = f" and {len(moved) - MOST_NAMED} more" if len(moved) > MOST_NAMED else ""
    return (f"beside that, {named}{more} moved and keep their slices.",)


def failing(offline: Sample, online: Sample, verdict: Verdict, options: Options) -> tuple[str, ...]:
    """Tell when missions fail more often on-line and the reward does not say so."""
    before, after = (world.passed.astype(np.float64) for world in (offline, online))
    draws = seeds.generator(options.seed, "success")
    if verdict.result == "degraded" or before.mean() - after.mean() <= PASS_RATE_LOSS:
        return ()
    if permuted_loss(before, after, draws) >= options.alpha:
        return ()
    return (
        (
            f"missions succeed in {after.mean():.0%} of the on-line episodes and in {before.mean():.0%} off-line, but "
            "no loss of reward was found: a mission that ends early may earn more than one that is carried on. Let "
            "the reward count a failed mission."
        ),
    )


def unheard_of(
    offline: Sample, online: Sample, difference: Difference, sensors: Sequence[Sensor]
) -> Iterator[str]:
    """Say so where (nearly) every on-line situation is new, and what was compared all the same."""
    if difference.verdict.result == "no difference" or not apart(offline, online):
        return
    names = [sensors[d].name for d in difference.region.without]
    if names:
        left = " and ".join(names)
        yield (
            f"no on-line situation was seen off-line, because of {left}: statements cannot be compared in one and the "
            f"same situation. They are compared, and ranked, in situations told without {left}."
        )
    else:
        yield (
            "no on-line situation was seen off-line, whatever sensors are left out: nothing can be compared statement "
            "by statement, so no line is named. Declare sensors whose values occur in both worlds, or record again."
        )


def other_formulas(offline: Sample, online: Sample) -> tuple[str, ...]:
    """Tell which formulas were not required when the test was recorded, and which no mission was long enough for."""
    if online.judgements is None:
        return ()
    recorded = offline.judgements.formulas if offline.judgements is not None else ()
    added = [repr(one) for one in online.judgements.formulas if one not in recorded]
    late = [repr(one) for one in judgements.never_judged(online.judgements)]
    return (
        *(
            (f"not required when the test was recorded: {', '.join(added)}. Record again to compare.",)
            if added
            else ()
        ),
        *((f"no on-line episode was long enough to judge {', '.join(late)}.",) if late else ()),
    )
