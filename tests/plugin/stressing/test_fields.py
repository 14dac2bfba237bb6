"""Hyperparameters are chosen by evidence, and kept while there are not many more drifts."""

from __future__ import annotations

import numpy as np
import pytest

from pytest_tarl.stressing import fields
from pytest_tarl.stressing.fields import GROWN, IRRELEVANT, Counts, Fit, loss_fit, rate_fit
from pytest_tarl.stressing.surrogates import LossField, Matrix, covariance, inverted, variance

USUAL = -4.0
ERRORS = 1e-3


def drifts(count: int) -> Matrix:
    return np.random.default_rng(3).uniform(-1.0, 1.0, (count, 2))


def losses(vectors: Matrix) -> Matrix:
    return 1.5 * np.sin(6.0 * vectors[:, 0])


def fit(count: int, before: Fit[LossField] | None = None) -> Fit[LossField]:
    vectors = drifts(count)
    return loss_fit(vectors, losses(vectors), ERRORS * np.eye(count), before)


def counts(count: int) -> Counts:
    vectors = drifts(count)
    episodes = np.full(count, 8.0)
    failed = np.round(episodes / (1.0 + np.exp(-4.0 * (vectors[:, 0] - 0.3))))
    return Counts(vectors, failed, episodes, USUAL, np.diag(1.0 / episodes))


def test_direction_without_influence_is_scaled_down(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = fit(30)
    assert first.units.tolist() == [1.0, IRRELEVANT]
    assert first.chosen == 30
    monkeypatch.setattr(fields, "relevant", None)  # choosing would fail now
    kept = fit(round(GROWN * 30), first)
    assert (kept.units.tolist(), kept.chosen) == (first.units.tolist(), 30)
    with pytest.raises(TypeError):
        fit(round(GROWN * 30) + 1, first)
    with pytest.raises(TypeError):
        fit(29, first)  # a model of fewer drifts than before


def test_fit_with_old_hyperparameters_equals_a_new_fit() -> None:
    first = rate_fit(counts(50), None, {})
    more = counts(54)
    known = dict(zip(map(tuple, drifts(50).tolist()), first.field.logits.tolist(), strict=True))
    kept = rate_fit(more, first, known)
    scaled = more.vectors * first.units
    cold = more.field(covariance(scaled, scaled), first.field.scale, None, first.luck)
    assert kept.chosen == 50
    assert kept.field.logits == pytest.approx(cold.logits, abs=0.1)
    assert kept.field.evidence == pytest.approx(cold.evidence, abs=0.1)


def test_unknown_logits_start_at_the_usual_logit() -> None:
    two = counts(2)
    (first, _) = two.vectors.tolist()
    assert two.logits({tuple(first): 1.5}).tolist() == [1.5, USUAL]


@pytest.mark.parametrize("size", [1, 48, 49, 131])
def test_a_triangular_matrix_is_inverted(size: int) -> None:
    vectors = np.random.default_rng(size).uniform(-1.0, 1.0, (size, 3))
    lower = np.linalg.cholesky(covariance(vectors, vectors) + 0.01 * np.eye(size))
    found = inverted(lower)
    assert found @ lower == pytest.approx(np.eye(size), abs=1e-8)
    assert (np.triu(found, 1) == 0.0).all() or np.abs(np.triu(found, 1)).max() < 1e-10


def test_predicted_means_do_not_need_deviations() -> None:
    asked = drifts(7) * 0.5
    field = fit(20).field
    cross = covariance(asked, drifts(20))
    assert (field.means(cross) == field.moments(cross, variance(asked))[0]).all()
