"""Find the statements that a mission reaches only with a change, which shows that it gets further.

For example, a climbing robot whose flippers are too low never leaves the floor. With higher flippers, it climbs a step,
slides down again and earns less than before. The reward shows no progress, but the mission now runs statements that so
far only the designed mission ran. One of the constants of these statements is what stops the mission now.
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
    """Return the constants of the statements that a mission enters only with a change, in the order of execution.

    Designed missions run these statements, but drifted missions without the change do not. `changed` is the mission
    with the change. `pairs` are recorded missions without the change, among them some with the same seed.
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
