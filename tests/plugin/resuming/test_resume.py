"""`--tarl-resume` continues an interrupted run: no finished episode is run again, and the result is the same."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed, fixture_file, result

RESUME = "--tarl-resume"
STOPPING = """\
    import os, pathlib, signal
    ran = pathlib.Path(__file__).parent / "ran"
    with ran.open("a") as log:
        log.write(f"{tarl.seed}\\n")
    stop, _, how = os.environ.get("STOP", "").partition(" ")
    if stop and len(ran.read_text().split()) > int(stop):
        pytest.exit("enough") if how == "exit" else os.kill(os.getpid(), getattr(signal, how))
    draws = """


@pytest.fixture
def stopping(tank: pytest.Pytester) -> pytest.Pytester:
    """A tank whose test counts its episodes and stops in the episode that an environment variable names."""
    changed(tank, "test_tank", "    draws = ", STOPPING)
    return tank


def ran(tank: pytest.Pytester) -> int:
    """Return how many episodes have run since the last call."""
    path = tank.path / "ran"
    count = len(path.read_text().split()) if path.exists() else 0
    path.unlink(missing_ok=True)
    return count


def interrupted(tank: pytest.Pytester, how: str, *flags: str) -> str:
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("STOP", how)
        return "\n".join(
            (tank.runpytest if how.endswith("exit") else tank.runpytest_subprocess)(*flags).outlines
        )


def kept(tank: pytest.Pytester) -> list[Path]:
    return list((tank.path / ".tarl" / "unfinished").glob("*"))


def test_a_killed_recording_continues_with_the_same_bytes(stopping: pytest.Pytester) -> None:
    stopping.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    whole = fixture_file(stopping).read_bytes()
    assert ran(stopping) == 17  # the first episode runs twice, to check that it is reproducible
    assert kept(stopping) == []
    fixture_file(stopping).unlink()
    interrupted(stopping, "9 SIGKILL", *RECORD)
    assert ran(stopping) == 10
    found = stopping.runpytest(*RECORD, RESUME)
    found.assert_outcomes(passed=1, deselected=1)
    found.stdout.fnmatch_lines(["*9 finished episodes are kept from the interrupted run."])
    assert ran(stopping) == 7 + 1  # the first kept episode runs again, which is its second run
    assert fixture_file(stopping).read_bytes() == whole
    assert kept(stopping) == []


def test_an_interrupted_comparison_continues_on_workers(stopping: pytest.Pytester) -> None:
    stopping.runpytest(*RECORD)
    stopping.runpytest(*ONLINE, "--tarl-looks=1")
    whole = result(stopping)
    ran(stopping)
    interrupted(stopping, "5 exit", *ONLINE, "--tarl-looks=1")
    assert ran(stopping) == 6
    found = stopping.runpytest(*ONLINE, "--tarl-looks=1", RESUME, "--tarl-workers=2")
    found.assert_outcomes(failed=1, deselected=1)
    assert ran(stopping) == 7 + 1
    assert result(stopping) == whole


def test_tests_that_were_finished_are_not_run_again(stopping: pytest.Pytester) -> None:
    text = (stopping.path / "test_tank.py").read_text()
    stopping.makepyfile(test_tank_again=text)
    told = interrupted(stopping, "20 SIGINT", *RECORD)
    assert (
        "Interrupted in episode 4 of 16: no recording was written. 3 finished episodes are kept: add" in told
    )
    assert len(kept(stopping)) == 2
    ran(stopping)
    found = stopping.runpytest(*RECORD, RESUME)
    found.assert_outcomes(passed=2, deselected=2)
    assert ran(stopping) == 1 + (1 + 13)
    assert kept(stopping) == []


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("node", "keeper.py changed"),
        ("sensors", "test_tank.py changed; the sensors changed"),
        ("seed", "--tarl-seed was 0 and is 5"),
    ],
)
def test_a_run_under_other_conditions_is_not_continued(
    stopping: pytest.Pytester, what: str, said: str
) -> None:
    interrupted(stopping, "3 exit", *RECORD)
    ran(stopping)
    flags = ["--tarl-seed=5"] if what == "seed" else []
    if what == "node":
        changed(stopping, "keeper", "GAIN = 2.0", "GAIN = 2.1")
    elif what == "sensors":
        changed(stopping, "test_tank", "bins=10", "bins=5")
    refused = stopping.runpytest(*RECORD, RESUME, *flags)
    refused.assert_outcomes(failed=1, deselected=1)
    refused.stdout.fnmatch_lines([f"*interrupted run cannot be continued: {said}.*"])
    assert ran(stopping) == 0


def test_a_resumed_run_may_ask_for_more_episodes(stopping: pytest.Pytester) -> None:
    interrupted(stopping, "9 exit", *RECORD)
    ran(stopping)
    stopping.runpytest("--tarl-record", "--tarl-episodes=20", RESUME).assert_outcomes(passed=1, deselected=1)
    assert ran(stopping) == 20 - 9 + 1


def test_resuming_repeats_the_first_episode(stopping: pytest.Pytester) -> None:
    changed(stopping, "test_tank", "pump = float", "pump = float(os.environ.get('PUMP', 1)) * float")
    interrupted(stopping, "9 exit", *RECORD)
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("PUMP", "0.9")
        refused = stopping.runpytest(*RECORD, RESUME)
    refused.assert_outcomes(failed=1, deselected=1)
    refused.stdout.fnmatch_lines(
        ["*The run cannot be continued: its episode with seed * now has another result.*"]
    )
    assert len(kept(stopping)) == 1


def test_message_mentions_kept_episodes(stopping: pytest.Pytester) -> None:
    interrupted(stopping, "9 exit", *RECORD)
    stopping.runpytest(*RECORD).stdout.fnmatch_lines(
        ["*9 finished episodes are kept from an interrupted run*"]
    )
    assert kept(stopping) == []


def test_without_kept_episodes_every_episode_is_run(stopping: pytest.Pytester) -> None:
    found = stopping.runpytest(*RECORD, RESUME)
    found.assert_outcomes(passed=1, deselected=1)
    found.stdout.fnmatch_lines(["*no episodes are kept, so all of them are run."])


@pytest.mark.parametrize("flags", [[], ["--tarl-online", "--tarl-log=a.log"]])
def test_resuming_is_refused_for_episodes_that_are_not_simulated(
    tank: pytest.Pytester, flags: list[str]
) -> None:
    refused = tank.runpytest(RESUME, *flags)
    assert refused.ret == pytest.ExitCode.USAGE_ERROR
    refused.stderr.fnmatch_lines(["*--tarl-resume *"])
