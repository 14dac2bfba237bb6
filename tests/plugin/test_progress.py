"""The progress line of a run."""

from __future__ import annotations

import pytest

from pytest_tarl.progress import ProgressLine, duration


def shown(times: list[float], *steps: tuple[int, int, str]) -> list[str]:
    lines: list[str] = []
    clock = iter(times)
    line = ProgressLine("t.py::test", lines.append, lambda: next(clock))
    for step in steps:
        line(*step)
    return [text.removeprefix("t.py::test ").rstrip() for text in lines]


def test_progress_appears_at_once() -> None:
    assert shown([0.0, 0.01, 1.0], (0, 200, "off-line"), (1, 200, "off-line"), (20, 200, "off-line")) == [
        "off-line 0/200",
        "off-line 20/200, 20/s, 9 s left",
    ]


def test_new_phase_has_its_own_rate() -> None:
    steps = [(0, 20, "bins"), (19, 20, "bins"), (0, 200, "off-line"), (5, 200, "off-line")]
    assert shown([0.0, 10.0, 10.01, 11.01], *steps)[2:] == [
        "off-line 0/200",
        "off-line 5/200, 5/s, 39 s left",
    ]


def test_progress_is_written_at_most_ten_times_a_second() -> None:
    lines = shown(
        [place / 1000 for place in range(1000)], *((place, 1000, "off-line") for place in range(1000))
    )
    assert len(lines) in (10, 11)


@pytest.mark.parametrize(
    ("seconds", "text"), [(-1, "0 s"), (7.6, "8 s"), (200, "3 min 20 s"), (7500, "2 h 5 min")]
)
def test_durations_are_printed_in_seconds_minutes_or_hours(seconds: float, text: str) -> None:
    assert duration(seconds) == text
