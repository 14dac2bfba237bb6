"""Statements that a change lets a mission enter: it is then further on its way than the unrepaired one.

A climber whose flippers are too low never leaves the floor. With higher flippers it climbs a step, slides down again
and earns less than before. Its reward shows nothing, but the mission runs statements that only the designed mission
ran so far: what stops it now is among their constants.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.repairing.mission_pairs import Recorded
from pytest_tarl.repairing.request import Order
from tarl_lint.model import Operand


def entered(order: Order, pairs: Sequence[Recorded], changed: Trace) -> list[Operand]:
    """Return the constants of statements that a changed mission runs, and else only designed missions, in its order.

    `pairs` are the recorded missions without the change, those of the changed mission's seed among them.
    """
    designed = {number for one, _ in pairs for number in np.unique(one.site).tolist()}
    drifted = {number for _, one in pairs for number in np.unique(one.site).tolist()}
    numbers, first = np.unique(changed.site, return_index=True)
    order_of = sorted(zip(first.tolist(), numbers.tolist(), strict=True))
    new = [number for _, number in order_of if number in designed - drifted]
    places = plan(order.analysis).places
    sites = {str(step.site): step.site for step in order.analysis.sites}
    found = [sites[places[one].id] for one in new if places[one].id in sites]
    return list(dict.fromkeys(operand for site in found for operand in order.analysis.operands(site)))
