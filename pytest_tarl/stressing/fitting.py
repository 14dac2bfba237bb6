"""Fit the model of the search to an evaluator's episodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import sqrt
from statistics import fmean

from pytest_tarl.spaces import Point
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.loss_noise import (
    cut_off,
    nominal_variance,
    standard_error,
    typical_variance,
    variance_near,
)
from pytest_tarl.stressing.prediction import Prediction, Sample, Shown


def fitted(
    evaluator: Evaluator,
    coordinates: Coordinates,
    known: Sequence[Point],
    shown: Callable[[float], Shown],
    before: Prediction | None = None,
) -> Prediction:
    """Return a model fitted to those drifts in `known` that `coordinates` cover.

    `shown` gets the standard deviation of a loss at the boundary, and returns what fresh episodes can show. If the
    drifts have options that are not nominal, the model starts from the loss measured under these options alone.
    `before` is the previous model of the same search, if there is one.
    """
    unique = {tuple(point.values()): point for point in known if coordinates.covers(point)}
    points = list(unique.values())
    measured = [evaluator.losses(point) for point in points]
    within = [cut_off(losses) for losses, _ in measured]
    typical = typical_variance(within)
    samples = [
        Sample(
            coordinates.vector(point),
            fmean(losses),
            standard_error(cut, typical),
            failed,
            evaluator.sources(point),
            cut.tolist(),
        )
        for point, (losses, failed), cut in zip(points, measured, within, strict=True)
    ]
    able = shown(sqrt(variance_near(1.0, within, typical)))
    paired = nominal_variance(evaluator.guarantee, typical)
    counts = [
        (coordinates.vector(point), failed, episodes)
        for point, failed, episodes in evaluator.counts
        if coordinates.covers(point)
    ]
    origin = next((one.loss for one in samples if not one.vector.any()), 0.0) if coordinates.options else 0.0
    return Prediction(
        coordinates, evaluator.guarantee, samples, able, typical, paired, counts, origin, before
    )
