"""The kept episodes of a test in one mode: their file, when they are continued, and what is told."""

from __future__ import annotations

import errno
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.designation import Designation
from pytest_tarl.errors import RecordingError
from pytest_tarl.item_episode import NOTHING
from pytest_tarl.options import Options
from pytest_tarl.resuming import run as run_module
from pytest_tarl.resuming.journal import Journal
from pytest_tarl.resuming.kept_rollout import KeptRollout
from pytest_tarl.resuming.run import ResumableRun, ResumableTest
from pytest_tarl.sensors import Sensor

ROLLOUT: Any = SimpleNamespace(workers=1)


@pytest.fixture
def root(tmp_path: Path) -> Path:
    (tmp_path / "test_it.py").write_text("def test_it(): pass\n")
    (tmp_path / "node.py").write_text("print(1)\n")
    return tmp_path


def item(root: Path, drift: str | None = None, name: str = "test_it") -> Any:
    shown = f"{name}[{drift}]" if drift else name
    spec = SimpleNamespace(params={"tarl_drift": drift}, id=drift)
    return SimpleNamespace(
        nodeid=f"test_it.py::{shown}",
        path=root / "test_it.py",
        config=SimpleNamespace(rootpath=root),
        **({"callspec": spec} if drift else {}),
    )


class Session:
    """Tests of one run of pytest, with what they tell."""

    def __init__(self, root: Path, **options: Any) -> None:
        self.told: list[str] = []
        self.run = ResumableRun()
        self.options = Options(**{"mode": "record", **options})
        self.item = item(root)

    def test(self, of: Any = None, **options: Any) -> ResumableTest:
        chosen = Options(**{**vars(self.options), **options}) if options else self.options
        return self.run.test(of or self.item, Designation(("node.py",), ()), chosen, self.told.append)


def keep(session: Session, count: int = 2) -> ResumableTest:
    """Begin a test and keep this many episodes."""
    test = session.test()
    test.keeping(ROLLOUT, NOTHING, ())
    assert test.journal is not None
    for number in range(count):
        test.journal.keep(bytes([number]) * 32, b"episode")
    return test


def interrupted(root: Path, count: int = 2, **options: Any) -> None:
    session = Session(root, **options)
    keep(session, count)
    session.run.ended(pytest.ExitCode.INTERRUPTED)


def test_file_is_named_after_test_mode_and_drift(root: Path) -> None:
    runs = [
        (item(root), {}),
        (item(root, "mud"), {"mode": "online"}),
        (item(root), {"mode": "online", "drift": "ice"}),
    ]
    names = [Session(root, **options).test(of).path.name for of, options in runs]
    kinds = ("record", "online-mud", "online-ice")
    assert all(f"test-it-{kind}-" in name for kind, name in zip(kinds, names, strict=True))
    path = Session(root).test().path
    assert path.parent == root / ".tarl" / "unfinished"
    assert path.suffix == ".episodes"


@pytest.mark.parametrize("options", [{"log": Path("a.log")}, {"bags": (Path("a.bag"),)}])
def test_recorded_missions_are_not_kept(root: Path, options: Any) -> None:
    test = Session(root, **options).test()
    assert test.keeping(ROLLOUT, NOTHING, ()) is ROLLOUT
    assert test.journal is None


def test_one_test_has_one_journal_for_all_its_rollouts(root: Path) -> None:
    session = Session(root)
    test = session.test()
    first, second = (test.keeping(ROLLOUT, NOTHING, sensors) for sensors in ((), (Sensor("level"),)))
    assert isinstance(first, KeptRollout)
    assert isinstance(second, KeptRollout)
    assert first._journal is second._journal is test.journal
    assert first._scope != second._scope
    assert session.told == []


@pytest.mark.parametrize(
    ("before", "finished", "checked"), [(False, True, False), (True, False, False), (True, True, True)]
)
def test_only_a_finished_test_counts_as_checked(
    root: Path, before: bool, finished: bool, checked: bool
) -> None:
    test = Session(root).test()
    if before:
        test.keeping(ROLLOUT, NOTHING, ())
    test.finished = finished
    rollout = test.keeping(ROLLOUT, NOTHING, ())
    assert isinstance(rollout, KeptRollout)
    assert rollout._checked is checked


@pytest.mark.parametrize(
    ("count", "told"),
    [
        (0, ""),
        (1, "1 finished episode is kept: add --tarl-resume to continue."),
        (2, "2 finished episodes are kept: add --tarl-resume to continue."),
    ],
)
def test_an_interrupted_test_says_how_many_episodes_are_kept(root: Path, count: int, told: str) -> None:
    session = Session(root)
    assert session.test().interrupted() == ""
    test = keep(session, count)
    assert test.interrupted() == told
    test.close()


@pytest.mark.parametrize(
    ("problem", "reason"), [(OSError(errno.ENOSPC, "disk full"), "disk full"), (OSError("odd"), "odd")]
)
def test_interrupted_test_says_what_was_not_kept(root: Path, problem: OSError, reason: str) -> None:
    test = keep(Session(root))
    assert test.journal is not None
    test.journal.problem = problem
    shown = test.path.relative_to(root).as_posix()
    assert test.interrupted() == f"Later episodes were not kept, because {shown} cannot be written: {reason}."
    test.close()


def test_a_run_is_continued_on_request(root: Path) -> None:
    interrupted(root)
    session = Session(root, resume=True)
    test = session.test()
    test.keeping(ROLLOUT, NOTHING, ())
    assert session.told == ["test_it.py::test_it: 2 finished episodes are kept from the interrupted run."]
    assert test.journal is not None
    assert test.journal.episodes == 2
    test.close()


def test_without_the_request_kept_episodes_are_mentioned_and_replaced(root: Path) -> None:
    interrupted(root, 1)
    session = Session(root)
    test = session.test()
    test.keeping(ROLLOUT, NOTHING, ())
    (told,) = session.told
    assert "1 finished episode is kept from an interrupted run and will be replaced" in told
    assert test.journal is not None
    assert test.journal.episodes == 0


def test_episodes_under_other_conditions_are_mentioned_only_on_request(root: Path) -> None:
    interrupted(root)
    other = Session(root, seed=1)
    other.test().keeping(ROLLOUT, NOTHING, ())
    assert other.told == []
    with pytest.raises(RecordingError, match=r"cannot be continued: --tarl-seed was 0 and is 1. Undo"):
        Session(root, seed=1, resume=True).test().keeping(ROLLOUT, NOTHING, ())


def test_message_appears_only_if_resuming_was_requested(root: Path) -> None:
    for resume, count in ((True, 1), (False, 0)):
        session = Session(root, resume=resume)
        session.test().keeping(ROLLOUT, NOTHING, ())
        assert session.told == ["test_it.py::test_it: no episodes are kept, so all of them are run."][:count]


def test_a_file_that_another_run_writes_is_refused(root: Path) -> None:
    pytest.importorskip("fcntl")
    first = keep(Session(root))
    with pytest.raises(RecordingError, match=r"Another run of this test is writing \.tarl/unfinished/"):
        Session(root, resume=True).test().keeping(ROLLOUT, NOTHING, ())
    first.close()


def test_unopenable_file_is_refused_with_advice(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    interrupted(root)

    def denied(_: Journal) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(run_module.Journal, "resume", denied)
    with pytest.raises(
        RecordingError, match=r"continued \(Read-only file system\): make the folder writable"
    ):
        Session(root, resume=True).test().keeping(ROLLOUT, NOTHING, ())


@pytest.mark.parametrize(
    ("status", "finished", "left"),
    [
        (pytest.ExitCode.OK, True, 0),
        (pytest.ExitCode.TESTS_FAILED, True, 0),
        (pytest.ExitCode.OK, False, 1),
        (pytest.ExitCode.INTERRUPTED, True, 1),
        (pytest.ExitCode.INTERNAL_ERROR, True, 1),
        (pytest.ExitCode.USAGE_ERROR, True, 1),
        (pytest.ExitCode.NO_TESTS_COLLECTED, True, 1),
    ],
)
def test_complete_run_removes_finished_episodes(root: Path, status: int, finished: bool, left: int) -> None:
    session = Session(root)
    test = keep(session)
    test.finished = finished
    session.run.ended(status)
    assert test.path.exists() == bool(left)
    assert session.run.tests == []
    assert test.journal is not None
    assert test.journal._file is None


def test_tests_that_share_a_total_are_recognised(root: Path) -> None:
    shared, alone = Session(root, total=100), Session(root)
    assert shared.test() is shared.test()
    assert shared.test() is not shared.test(item(root, name="test_other"))
    assert len(shared.run.tests) == 2
    assert alone.test() is not alone.test()
    assert len(alone.run.tests) == 2


def test_a_test_without_episodes_ends_without_a_file(root: Path) -> None:
    session = Session(root)
    test = session.test()
    test.finished = True
    test.close()
    session.run.ended(pytest.ExitCode.OK)
    assert not test.path.parent.exists()
