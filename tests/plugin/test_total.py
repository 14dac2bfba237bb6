"""`--tarl-total`: the comparisons of a run share its episodes, and undecided ones get what is left."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.options import options
from tests.plugin.tank import RECORD, changed
from tests.plugin.test_options import FLAGS

DRIFTS = '{"clogged": 0.25, "fine": 1.0}'
THREE = '{"clogged": 0.25, "fine": 1.0, "half": 0.9}'


@pytest.fixture(scope="module")
def record_once() -> dict[str, bytes]:
    return {}


@pytest.fixture
def sharing(tank: pytest.Pytester, record_once: dict[str, bytes]) -> pytest.Pytester:
    """The recorded project with a drift that stops the robot and one that has no effect."""
    changed(tank, "test_tank", '{"clogged": 0.25}', DRIFTS)
    folder = tank.path / ".tarl" / "utility"
    if not record_once:
        tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
        record_once.update({file.name: file.read_bytes() for file in folder.glob("*.npz")})
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in record_once.items():
        (folder / name).write_bytes(content)
    return tank


def results(project: pytest.Pytester) -> dict[str, dict[str, Any]]:
    """Return the results by drift."""
    files = (project.path / ".tarl" / "results").glob("*.json")
    return {str(one["drift"]): one for one in (json.loads(file.read_text("utf-8")) for file in files)}


def ran(project: pytest.Pytester) -> dict[str, int]:
    """Return the number of episodes of each comparison."""
    return {drift: int(one["episodes"]["online"]) for drift, one in results(project).items()}


def test_undecided_comparison_gets_spare_episodes(
    sharing: pytest.Pytester,
) -> None:
    told = sharing.runpytest("--tarl-online", "--tarl-total=80")
    told.assert_outcomes(failed=1, passed=1, deselected=1)
    episodes = ran(sharing)
    assert episodes["clogged"] < 40 < episodes["fine"]
    assert sum(episodes.values()) <= 80
    told.stdout.fnmatch_lines(
        [
            f"*ran {episodes['clogged']} of the 80 episodes for 2 comparisons (an even share is 40):",
            "*decided, so the rest go to the others*",
            f"*ran {episodes['fine']} of the 80 episodes for 2 comparisons (an even share is 40):",
            "*undecided after its last look*",
        ]
    )


def test_shared_comparison_equals_a_separate_one(
    sharing: pytest.Pytester,
) -> None:
    """The command in the output repeats the comparison, with the same episodes and the same loss."""
    sharing.runpytest("--tarl-online", "--tarl-total=80")
    shared = results(sharing)
    for drift, one in shared.items():
        number = one["episodes"]["online"]
        sharing.runpytest(
            "--tarl-online", f"--tarl-drift={drift}", f"--tarl-episodes={number}", "--tarl-looks=1"
        )
        alone = results(sharing)[drift]
        assert alone["episodes"]["online"] == number
        assert alone["verdict"]["loss"] == pytest.approx(one["verdict"]["loss"])


def test_workers_share_the_same_episodes(sharing: pytest.Pytester) -> None:
    kept: list[dict[str, object]] = []
    for workers in ("1", "2"):
        sharing.runpytest("--tarl-online", "--tarl-total=60", f"--tarl-workers={workers}")
        kept.append({drift: (one["verdict"], one["episodes"]) for drift, one in results(sharing).items()})
    assert kept[0] == kept[1]


def test_no_episode_runs_twice(sharing: pytest.Pytester) -> None:
    file = sharing.path / "ran.txt"
    count = f'with open({str(file)!r}, "a") as kept:\n        kept.write("x")\n    draws = tarl.rng("world")'
    changed(sharing, "test_tank", 'draws = tarl.rng("world")', count)
    sharing.runpytest("--tarl-online", "--tarl-total=80")
    assert len(file.read_text()) == sum(ran(sharing).values())
    before = len(file.read_text())
    sharing.runpytest("--tarl-online", "--tarl-total=80", "--tarl-resume")  # no kept episodes: all run again
    assert len(file.read_text()) == 2 * before


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"online": False}, "needs --tarl-online"),
        ({"episodes": 30}, "cannot be used together: the first is the number for all comparisons"),
        ({"repair": True}, "Compare first, then repair"),
        ({"holm": True}, "Holm's method"),
        ({"log": "a.tarl"}, "number of recorded missions is fixed"),
        ({"looks": 1}, "at least two looks"),
        ({"total": 3}, "--tarl-total"),
    ],
)
def test_flags_that_contradict_a_total_are_named(more: dict[str, object], words: str) -> None:
    with pytest.raises(SettingsError, match=re.escape(words)):
        options({**FLAGS, "online": True, "total": 80, **more})


def test_too_small_total_is_refused(
    sharing: pytest.Pytester,
) -> None:
    changed(sharing, "test_tank", DRIFTS, THREE)
    told = sharing.runpytest("--tarl-online", "--tarl-total=12")
    assert told.ret == pytest.ExitCode.USAGE_ERROR
    told.stderr.fnmatch_lines(["*--tarl-total=12 is too small: this run has 3 comparisons*Raise it to *"])


def test_a_shared_total_is_refused_with_xdist(sharing: pytest.Pytester) -> None:
    told = sharing.runpytest("--tarl-online", "--tarl-total=80", "-n2")
    assert told.ret == pytest.ExitCode.USAGE_ERROR
    told.stderr.fnmatch_lines(["*--tarl-total shares episodes over all tests of a run, but with -n*"])


def test_failing_test_takes_no_shared_episodes(sharing: pytest.Pytester) -> None:
    Path(sharing.path / "test_broken.py").write_text(
        (sharing.path / "test_tank.py").read_text().replace("def test_fills", "def test_breaks")
    )
    told = sharing.runpytest("--tarl-online", "--tarl-total=80")
    outcomes = told.parseoutcomes()
    assert outcomes["failed"] == 1
    assert outcomes["passed"] == 1
    assert ran(sharing)["fine"] > 40
