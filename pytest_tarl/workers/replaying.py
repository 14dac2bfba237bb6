"""Replay bags in a worker, with the site numbers of the recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from pytest_tarl.analysed import analysed, instruments
from pytest_tarl.bagged import check
from pytest_tarl.designation import Designation
from pytest_tarl.errors import FixtureError
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.instrumentation.trace import Ints, Trace
from pytest_tarl.repeating import ItemRollout
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending
from pytest_tarl.sensors import binning_digest


@dataclass(frozen=True)
class RenumberedRollout:
    """A rollout that changes site n to `number[n]`, or drops it if that is -1."""

    rollout: ItemRollout
    number: Ints
    workers = 1

    def begin(self, plan: EpisodePlan) -> Pending:
        """Return an episode that runs when its result is requested."""
        return Deferred(self, plan)

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode."""
        run = self.rollout(plan)
        return replace(run, trace=_renumbered(run.trace, self.number))


def replaying(
    item: pytest.Function, marked: Designation, sensors: str, sites: Sequence[str]
) -> RenumberedRollout:
    """Return a rollout that replays bags; `sites` has the ids of the recorded sites, ordered by number.

    `sensors` is the digest of the recorded sensors and bins. Raise FixtureError if the marker's sensors differ,
    SettingsError if the marker cannot judge bags, and AnalysisError if the nodes cannot be analysed.
    """
    check(marked)
    if binning_digest(marked.sensors) != sensors:
        raise FixtureError(
            f"The sensors of {item.nodeid} differ from those of the recording, so no bag can be compared with it.",
            "Record the test again with `pytest --tarl-record`, or name the recording that belongs to it.",
        )
    root = item.config.rootpath
    current = plan(analysed(marked, item.path.parent, root))
    recorded = {site: n for n, site in enumerate(sites)}
    number = np.array([recorded.get(place.id, -1) for place in current.places] or [-1], np.int32)
    return RenumberedRollout(ItemRollout(item, marked, instruments(current, root)), number)


def _renumbered(trace: Trace, number: Ints) -> Trace:
    site = number[trace.site]
    kept = site >= 0
    return replace(
        trace,
        site=site[kept],
        flow=trace.flow[kept],
        event_cell=trace.event_cell[kept],
        event_step=trace.event_step[kept],
        thread=None if trace.thread is None else trace.thread[kept],
    )
