"""Remarks for the reviewer of an accepted repair about what the measured figures do not show."""

from __future__ import annotations

from pytest_tarl.patching.dependencies import undeclared
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.report import amounts
from pytest_tarl.searching.moderate import LARGE
from pytest_tarl.searching.plainness import edges
from pytest_tarl.searching.search import Candidate, effective_value


def remarks(mutants: Mutants, candidate: Candidate) -> list[str]:
    """Return the remarks on an accepted repair."""
    return [*jumps(candidate), *large(candidate), *undeclared(mutants.source(candidate), mutants.order.root)]


def jumps(candidate: Candidate) -> list[str]:
    """Describe by how much constants jump at the thresholds of numeric conditions, if there are such conditions."""
    sensors = edges(candidate.guard)
    if not sensors:
        return []
    moved = []
    for mutation in candidate.mutations:
        value, new = mutation.operand.value, effective_value(mutation)
        if mutation.form is not None:
            continue
        if value is None or isinstance(value, bool):
            moved.append(f"{mutation.operand.code} × {float(mutation.value):g}")
        else:
            times = f" (× {new / value:.3g})" if value else ""
            moved.append(
                f"{mutation.operand.code} from {amounts.expected(float(value)):g} to {amounts.expected(new):g}{times}"
            )
    if not moved:
        return []
    return [f"jump at the threshold of {' and '.join(sensors)}: {', '.join(moved)}"]


def large(candidate: Candidate) -> list[str]:
    """Describe constants that change by at least the factor `LARGE`: in reality, something may limit them."""
    found = []
    for mutation in candidate.mutations:
        value = mutation.operand.value
        if mutation.form is not None or isinstance(value, bool) or isinstance(mutation.value, bool):
            continue
        times = (
            float(mutation.value) if value is None else effective_value(mutation) / value if value else 1.0
        )
        if times and not 1 / LARGE < abs(times) < LARGE:
            found.append(f"{mutation.operand.code} changes by a factor of {times:.3g}")
    if not found:
        return []
    told = (
        f"{', '.join(found)}: check that the simulation contains what limits such a change on the robot, such as "
        "delays, noise and limits of actuators"
    )
    return [told]
