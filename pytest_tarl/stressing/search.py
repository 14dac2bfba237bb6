"""Stress one test in one space: all single directions, then their combinations."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from pytest_tarl.designation import Designation
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.options import Options
from pytest_tarl.rollout import Rollout
from pytest_tarl.spaces import Space
from pytest_tarl.stressing.boundary import COARSE, bisect, confirm, sweep
from pytest_tarl.stressing.combinations import Combined, Together
from pytest_tarl.stressing.evaluating import BudgetSpentError, Evaluator, Progress
from pytest_tarl.stressing.findings import FAR_RISK, Curve, Sobol, Statements, Stress, confirmed
from pytest_tarl.stressing.guarantee import guarantee, unlike_recorded
from pytest_tarl.stressing.holding import hold
from pytest_tarl.stressing.rays import Ray, rays
from pytest_tarl.stressing.sobol_indices import sobol
from pytest_tarl.stressing.statements import Source, statements


@dataclass(frozen=True, slots=True)
class Risks:
    """The risks of the claims of a run: of each direction and of the nominal drift, and of all combinations."""

    each: float
    combinations: float


def divided(alpha: float, directions: int) -> Risks:
    """Return alpha divided among the claims; combinations get half, since the nearest failure is mostly one of them."""
    return Risks(min(alpha / 2 / (directions + 1), FAR_RISK), alpha / 2)


@dataclass(frozen=True)
class Request:
    """The test and space to stress, and the settings."""

    rollout: Rollout
    fixture: Fixture
    designation: Designation
    options: Options
    drift: str
    progress: Progress
    source: Source | None = None  # to find the statements of failures; without it, none are recorded


def stress(request: Request, *, combined: bool = True) -> Stress:
    """Find the boundary in each direction and in their combinations; Ctrl-C or the budget end the search early.

    Without `combined`, only single directions are searched.

    Each claim that the guarantee fails is confirmed on fresh seeds; all of them together are wrong with a probability
    of at most alpha. Raise RecordingError if the test itself is broken.
    """
    space: Any = request.designation.drifts[request.drift].value
    evaluator = _evaluator(request, space)
    must_hold = {
        name: limits for name, limits in request.designation.must_hold.items() if name in space.extents
    }
    curves = [Curve(ray) for ray in rays(space, must_hold)]
    risks = divided(request.options.alpha, len(curves))
    together = Together(risks.combinations, curves)
    ended = explore(evaluator, together, risks.each, combined=combined)
    indices, ended = variances(evaluator, ended) if combined else (None, ended)
    executed, ended = _executed(request, evaluator, together, ended)
    return Stress(
        test=request.fixture.test,
        drift=request.drift,
        seed=request.options.seed,
        space=space,
        guarantee=evaluator.guarantee,
        budget=evaluator.budget,
        seconds=evaluator.seconds,
        episodes=evaluator.spent,
        curves=tuple(curves),
        combinations=tuple(together.found),
        expected=tuple(together.expected),
        must_hold=must_hold,
        tried=together.tried,
        margin_map=together.margin_map,
        sobol=indices,
        statements=executed,
        ended=ended,
    )


def along(request: Request, ray: Ray) -> Curve:
    """Return the evidence along one ray, with the budget of a whole run; Ctrl-C ends it."""
    space: Any = request.designation.drifts[request.drift].value
    curve = Curve(ray)
    evaluator = _evaluator(request, space)
    with suppress(BudgetSpentError):
        along_rays([curve], evaluator, min(request.options.alpha, FAR_RISK))
        near_ends([curve], evaluator)
    return curve


def explore(evaluator: Evaluator, together: Together, share: float, *, combined: bool = True) -> str:
    """Fill the curves and the combinations of `together`, each curve at the risk `share`; return why it ended early.

    With several directions, the nearest failing drift comes first, since it needs least; the budget has a share for it.
    """
    curves = together.curves
    several = Combined(evaluator, together) if combined and len(evaluator.space.extents) > 1 else None
    try:
        if _nominal_fails(evaluator, share):
            return "nominal"
        if several is not None:
            several.begin()
        along_rays(curves, evaluator, share)
        near_ends([curve for curve in curves if curve.failing], evaluator)
        if several is not None:
            several.end()
        near_ends([curve for curve in curves if not curve.failing], evaluator)
    except BudgetSpentError:
        return "budget"
    except KeyboardInterrupt:
        return "interrupted"
    finally:
        if several is not None:
            several.draw()
    return "budget" if evaluator.short else ""


def variances(evaluator: Evaluator, ended: str) -> tuple[Sobol | None, str]:
    """Return the Sobol indices by the rest of the budget, after a search that `ended` so, and how the run ended."""
    if ended not in ("", "budget"):
        return None, ended
    try:
        return sobol(evaluator), ended
    except BudgetSpentError:
        return None, "budget"
    except KeyboardInterrupt:
        return None, "interrupted"


def _executed(
    request: Request, evaluator: Evaluator, together: Together, ended: str
) -> tuple[Statements | None, str]:
    """Return the statements of failures, and how the run ended; Ctrl-C before leaves them out."""
    if ended == "interrupted" or request.source is None:
        return None, ended
    failures = sorted(
        [*confirmed(together.curves), *together.found], key=lambda one: (one.distance, one.names)
    )
    try:
        return statements(request.source, evaluator, together.curves, failures), ended
    except KeyboardInterrupt:
        return None, "interrupted"


def _evaluator(request: Request, space: Space) -> Evaluator:
    given = guarantee(request.fixture, request.designation)
    options = request.options
    return Evaluator(
        request.rollout,
        space,
        request.drift,
        given,
        options.seed,
        options.stress_budget,
        request.progress,
        seconds=options.stress_seconds,
    )


def _nominal_fails(evaluator: Evaluator, risk: float) -> bool:
    """Return whether the guarantee fails in the nominal world, which then differs from the recorded one."""
    outcomes = evaluator.common(evaluator.space.nominal, COARSE)
    return unlike_recorded(evaluator.guarantee, outcomes, risk)


def along_rays(curves: Sequence[Curve], evaluator: Evaluator, share: float) -> None:
    """Find the boundary along each ray; each is confirmed at a risk of `share`. Raise BudgetSpentError."""
    for curve in curves:
        sweep(curve, evaluator)
    for curve in curves:
        bisect(curve, evaluator)
        confirm(curve, evaluator, share)


def near_ends(curves: Sequence[Curve], evaluator: Evaluator) -> None:
    """Show how far the guarantee holds along each ray. Raise BudgetSpentError."""
    for curve in curves:
        hold(curve, evaluator)
