"""A recording of few episodes says which loss they can show."""

import numpy as np
import pytest

from pytest_tarl.recording import detectable


def test_few_episodes_show_only_large_losses() -> None:
    totals = np.random.default_rng(1).normal(0.0, 1.0, 20)
    (note,) = detectable(totals)
    assert note.startswith("20 episodes: a comparison with the same number shows a loss of 0.")
    assert note.endswith("to show half that loss, record and compare 80")
    (scaled,) = detectable(1000.0 * totals)
    assert scaled != note


def test_many_or_equal_episodes_give_no_note() -> None:
    assert not detectable(np.arange(30.0))
    assert not detectable(np.full(20, 0.1))


def test_note_says_that_three_episodes_show_nothing() -> None:
    shown = "episodes are too few: a comparison with so few episodes cannot show any loss. Record at least 4."
    assert detectable(np.array([1.0, 2.0])) == [f"2 {shown}"]
    assert detectable(np.ones(3)) == [f"3 {shown}"]
    assert "shows a loss of" in detectable(np.arange(4.0))[0]


def test_a_recording_prints_the_note(tank: pytest.Pytester) -> None:
    few = tank.runpytest("--tarl-record", "--tarl-episodes=6")
    few.stdout.re_match_lines(
        [r"  6 episodes: a comparison with the same number shows a loss of [\d.]+ per episode in 80 %"]
    )
    alone = tank.runpytest("--tarl-record", "--tarl-episodes=2")
    alone.stdout.fnmatch_lines(["  2 episodes are too few: *"])
    many = tank.runpytest("--tarl-record", "--tarl-episodes=30")
    many.stdout.no_fnmatch_line("*a comparison with the same number*")
