"""A recording of few episodes says which loss they can show."""

import numpy as np

from pytest_tarl.recording import detectable


def test_few_episodes_show_only_large_losses() -> None:
    totals = np.random.default_rng(1).normal(0.0, 1.0, 20)
    (note,) = detectable(totals)
    assert note.startswith("20 episodes: a comparison with as many shows a loss of 0.")
    assert note.endswith("for a loss half as large, record and compare 80")
    (scaled,) = detectable(1000.0 * totals)
    assert scaled != note


def test_the_note_says_that_two_episodes_show_nothing_and_is_absent_for_many_or_equal_ones() -> None:
    (note,) = detectable(np.array([1.0, 2.0]))
    assert (
        note == "2 episodes are too few: a comparison with as many cannot show any loss. Record at least 4."
    )
    assert not detectable(np.arange(30.0))
    assert not detectable(np.ones(20))
