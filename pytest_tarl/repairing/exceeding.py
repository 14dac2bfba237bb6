"""Note repairs that earn more than the designed program: they change more than the drift did."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pytest_tarl.learning.bounds import loss_between
from pytest_tarl.model import Comparison
from pytest_tarl.report.amounts import amount
from pytest_tarl.report.words import designed_world, world_name

CONFIDENCE = 0.95


def exceeding(comparison: Comparison, totals: Mapping[str, Sequence[float]]) -> list[str]:
    """Return a note if an accepted repair earns clearly more (by more than the tolerance) than designed.

    Such a repair often uses something that the reward does not punish, such as a higher speed. `totals` holds the
    rewards of all episodes under the keys `offline`, `repaired` and `nominal_repaired`.
    """
    designed = totals["offline"]
    places = {
        "nominal_repaired": f"in the {designed_world(comparison)}",
        "repaired": f"in {world_name(comparison)}",
    }
    for world, place in places.items():
        # loss of the unrepaired program in the designed world
        low = loss_between(totals[world], designed, CONFIDENCE).low
        if low > comparison.verdict.tolerance:
            earned, before = (sum(one) / len(one) for one in (totals[world], designed))
            told = (
                f"{place} the repaired node earns {amount(earned)}, more than the {amount(before)} of the recording: "
                "the repair does more than undo the drift. If this is not wanted, let the reward penalise "
                "the excess, such as a high speed or force."
            )
            return [told]
    return []
