"""Stress-test one test in one space: first all single directions, then their combinations."""

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
from pytest_tarl.stressing.failing_statements import Source, statements
from pytest_tarl.stressing.findings import FAR_RISK, Curve, Sobol, Statements, Stress, confirmed
from pytest_tarl.stressing.guarantee import guarantee, unlike_recorded
from pytest_tarl.stressing.holding import hold
from pytest_tarl.stressing.rays import Ray, rays
from pytest_tarl.stressing.sobol_indices import sobol


@dataclass(frozen=True, slots=True)
class Risks:
    """The error probabilities for the claims of a run.

    `each` is the risk of one claim: about the nominal drift, or about one direction. `combinations` is the risk of all
    claims about combinations together.
    """

    each: float
    combinations: float


def divided(alpha: float, directions: int) -> Risks:
    """Divide alpha among the claims; combinations get half, because the nearest failure is usually one."""
    return Risks(min(alpha / 2 / (directions + 1), FAR_RISK), alpha / 2)


@dataclass(frozen=True)
class Request:
    """The test and the space to stress, with the settings."""

    rollout: Rollout
    fixture: Fixture
    designation: Designation
    options: Options
    drift: str
    progress: Progress
    source: Source | None = None  # statements to record in failing episodes, if any


def stress(request: Request, *, combined: bool = True) -> Stress:
    """Find the boundary in each direction and, with `combined`, failing combinations of directions.

    A failure is reported only if fresh seeds confirm it. The probability that any such report is wrong is at most
    alpha. If Ctrl-C is pressed or the budget is spent, return the results so far. Raise RecordingError if the test
    itself is broken.
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
    """Return the evidence along one ray, which may use the whole budget. Raise KeyboardInterrupt on Ctrl-C."""
    space: Any = request.designation.drifts[request.drift].value
    curve = Curve(ray)
    evaluator = _evaluator(request, space)
    with suppress(BudgetSpentError):
        along_rays([curve], evaluator, min(request.options.alpha, FAR_RISK))
        near_ends([curve], evaluator)
    return curve


def explore(evaluator: Evaluator, together: Together, share: float, *, combined: bool = True) -> str:
    """Fill the curves and combinations of `together`; return why the search ended early, or an empty text.

    `share` is the error probability for each curve. With several directions, the search starts with the nearest failing
    drift, within a share of the budget, because this takes the fewest episodes.
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
    """Compute Sobol indices with the rest of the budget; return them and why the run ended.

    `ended` is the reason why the search ended. There are no indices if it was interrupted or the nominal drift fails.
    """
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
    """Find the statements that ran only in failures; return them and why the run ended.

    There are none if the search was interrupted.
    """
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
    """Return whether the guarantee fails at the nominal drift, which means that the world is not the recorded one."""
    outcomes = evaluator.common(evaluator.space.nominal, COARSE)
    return unlike_recorded(evaluator.guarantee, outcomes, risk)


def along_rays(curves: Sequence[Curve], evaluator: Evaluator, share: float) -> None:
    """Find and confirm the boundary along each ray, each with error probability `share`.

    Raise BudgetSpentError.
    """
    for curve in curves:
        sweep(curve, evaluator)
    for curve in curves:
        bisect(curve, evaluator)
        confirm(curve, evaluator, share)


def near_ends(curves: Sequence[Curve], evaluator: Evaluator) -> None:
    """Show along each ray how far the guarantee holds. Raise BudgetSpentError."""
    for curve in curves:
        hold(curve, evaluator)
