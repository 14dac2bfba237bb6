"""Remarks that accompany a verdict: lost sites, new situations, and failures that do not lower the reward."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.learning import judgements
from pytest_tarl.learning.drift import Difference
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.marginal import apart
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import SitePlace, Verdict
from pytest_tarl.sensors import Sensor

MOST_NAMED = 3  # maximum number of lost sites to name in a note


def of_comparison(
    fixture: Fixture, plan: Plan, offline: Sample, online: Sample, difference: Difference
) -> tuple[str, ...]:
    """Return the remarks on a comparison except `failing`, which comes first; both samples have the same cells."""
    return (
        *unheard_of(offline, online, difference, fixture.sensors),
        *lost_sites(fixture, plan),
        *other_formulas(offline, online),
    )


def early(online: Sample, planned: int) -> tuple[str, ...]:
    """Return a remark if the run stopped early because the verdict was certain."""
    if online.episodes == planned:
        return ()
    return (
        f"stopped after {online.episodes} of {planned} episodes: the verdict was certain (--tarl-looks 1 runs all).",
    )


def lost_sites(fixture: Fixture, plan: Plan) -> tuple[str, ...]:
    """Return a remark on recorded sites that the node no longer has; all others are still compared."""
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
            "region remain valid. To keep the edit, record again with --tarl-record."
        ),
        *_moved(fixture, plan),
    )


def _moved(fixture: Fixture, plan: Plan) -> tuple[str, ...]:
    """Describe recorded sites that moved to another line, and are still compared."""
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
    return (f"{named}{more} moved and keep their slices.",)


def failing(verdict: Verdict) -> tuple[str, ...]:
    """Return a remark if more missions fail in the deployed world, although no loss of reward was found."""
    if not verdict.failures_only:
        return ()
    return (
        (
            "more missions fail, but no loss of reward was found: a mission that ends early may earn more than one "
            "that continues. A repair is searched by its reward, so add a negative reward for a failed mission."
        ),
    )


def unheard_of(
    offline: Sample, online: Sample, difference: Difference, sensors: Sequence[Sensor]
) -> Iterator[str]:
    """Yield a remark if nearly all deployed situations are new; it says what was compared instead."""
    if difference.verdict.result == "no difference" or not apart(offline, online):
        return
    names = [sensors[d].name for d in difference.region.without]
    if names:
        left = " and ".join(names)
        yield (
            f"no deployed situation occurs in the recording, because of {left}. To compare and rank statements, {left} "
            f"is left out of the definition of a situation."
        )
    else:
        yield (
            "no deployed situation occurs in the recording, whatever sensors are left out, so statements cannot be "
            "compared and no line is named. Declare sensors whose values occur in both worlds, or record again."
        )


def other_formulas(offline: Sample, online: Sample) -> tuple[str, ...]:
    """Return remarks on formulas missing from the recording, and on those that every mission was too short for."""
    if online.judgements is None:
        return ()
    recorded = offline.judgements.formulas if offline.judgements is not None else ()
    added = [repr(one) for one in online.judgements.formulas if one not in recorded]
    late = [repr(one) for one in judgements.never_judged(online.judgements)]
    return (
        *(
            (
                (
                    f"these formulas were not required when the test was recorded: {', '.join(added)}. Record again "
                    "to compare."
                ),
            )
            if added
            else ()
        ),
        *((f"no deployed episode was long enough to judge {', '.join(late)}.",) if late else ()),
    )
