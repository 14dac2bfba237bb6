"""From the file of kept episodes, all complete episodes can be read after any interruption."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.resuming.journal import KEY, SYNC, Journal, TakenError, conditions_of

CONDITIONS = {"keeper.py": "a1", "--tarl-seed": "0"}


def key(number: int) -> bytes:
    return number.to_bytes(KEY, "big")


def written(path: Path, episodes: list[tuple[int, bytes]]) -> Path:
    path.unlink(missing_ok=True)
    journal = Journal(path, CONDITIONS)
    for number, episode in episodes:
        journal.keep(key(number), episode)
    journal.close()
    return path


def continued(path: Path) -> Journal:
    journal = Journal(path, CONDITIONS)
    journal.resume()
    return journal


@settings(max_examples=25)
@given(
    episodes=st.lists(st.tuples(st.integers(0, 3), st.binary(max_size=40)), min_size=1, max_size=6),
    kept=st.floats(0, 1),
    rest=st.binary(max_size=12),
)
def test_truncated_file_keeps_whole_episodes(
    tmp_path_factory: pytest.TempPathFactory, episodes: list[tuple[int, bytes]], kept: float, rest: bytes
) -> None:
    path = tmp_path_factory.getbasetemp() / "cut.episodes"
    whole = written(path, episodes).read_bytes()
    ends = [len(written(path, episodes[:n]).read_bytes()) for n in range(1, len(episodes) + 1)]
    cut = ends[0] + int(kept * (len(whole) - ends[0]))
    path.write_bytes(whole[:cut] + (rest if cut < len(whole) else b""))
    survivors = sum(end <= cut for end in ends)
    assert conditions_of(path) == (CONDITIONS, survivors)
    journal = continued(path)
    journal.keep(key(9), b"new")
    journal.close()
    again = continued(path)
    counts: dict[int, int] = {}
    for number, episode in [*episodes[:survivors], (9, b"new")]:
        assert again.taken(key(number), counts.get(number, 0)) == episode
        counts[number] = counts.get(number, 0) + 1
    assert all(again.taken(key(number), count) is None for number, count in counts.items())
    assert again.episodes == survivors + 1
    again.close()


@pytest.mark.parametrize("content", [b"", b"tarl epis", b"something else\n", b"tarl episodes 1\n"])
def test_no_conditions_are_read_from_a_file_without_episodes(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.episodes"
    path.write_bytes(content)
    assert conditions_of(path) is None


def test_new_run_replaces_the_file_at_once(tmp_path: Path) -> None:
    path = written(tmp_path / "a.episodes", [(1, b"old"), (2, b"old")])
    journal = Journal(path, {"keeper.py": "b2"})
    assert conditions_of(path) == (CONDITIONS, 2)
    journal.keep(key(1), b"new")
    journal.close()
    assert conditions_of(path) == ({"keeper.py": "b2"}, 1)


def test_two_runs_cannot_write_the_same_file(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    path = written(tmp_path / "a.episodes", [(1, b"x")])
    first = continued(path)
    with pytest.raises(TakenError):
        continued(path)
    second = Journal(path, CONDITIONS)
    second.keep(key(2), b"y")
    assert isinstance(second.problem, TakenError)
    first.close()
    assert conditions_of(path) == (CONDITIONS, 1)


def test_full_disk_does_not_stop_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    journal = Journal(tmp_path / "a.episodes", CONDITIONS)
    monkeypatch.setattr("pytest_tarl.resuming.journal.os.fsync", full)
    journal.keep(key(1), b"x")
    journal.keep(key(2), b"y")
    assert journal.problem is not None
    assert journal.problem.errno == errno.ENOSPC
    journal.close()


def test_episodes_are_written_after_a_delay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    synced: list[float] = []
    monkeypatch.setattr("pytest_tarl.resuming.journal.monotonic", lambda: now[0])
    monkeypatch.setattr("pytest_tarl.resuming.journal.os.fsync", lambda _: synced.append(now[0]))
    kept = Journal(tmp_path / "a.episodes", CONDITIONS)
    for after in (0.0, SYNC / 2, SYNC, SYNC + SYNC / 2, 2 * SYNC, 4 * SYNC):
        now[0] = 100.0 + after
        kept.keep(key(1), b"x")
    of_episodes = sorted({one - 100.0 for one in synced} - {0.0})
    assert of_episodes == [SYNC, 2 * SYNC, 4 * SYNC]
    kept.close()
    assert conditions_of(kept.path) == (CONDITIONS, 6)


def test_removing_the_file_also_removes_its_empty_folder(tmp_path: Path) -> None:
    first, second = (
        Journal(tmp_path / "unfinished" / name, CONDITIONS) for name in ("a.episodes", "b.episodes")
    )
    first.keep(key(1), b"x")
    second.keep(key(1), b"x")
    first.remove()
    assert second.path.exists()
    second.remove()
    assert not second.path.parent.exists()


def test_keeping_episodes_leaves_no_file_open(tmp_path: Path) -> None:
    handles = Path("/proc/self/fd")
    if not handles.is_dir():
        pytest.skip("needs /proc")
    before = len(list(handles.iterdir()))
    for number in range(3):
        written(tmp_path / "a.episodes", [(number, b"x")])
    again = continued(tmp_path / "a.episodes")
    again.taken(key(2), 0)
    assert conditions_of(tmp_path / "a.episodes") is not None
    again.close()
    assert len(list(handles.iterdir())) == before
