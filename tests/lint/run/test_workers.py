"""Tasks run in processes, the largest first; their results come in the order of the tasks."""

from __future__ import annotations

import io
import os
import signal
import threading

import pytest

from tarl_lint.run import workers
from tarl_lint.run.interrupts import end_silently, over, uninterrupted
from tarl_lint.run.progress import Progress, paused, silent
from tarl_lint.run.workers import in_processes


def doubled(number: int) -> tuple[int, int]:
    return 2 * number, os.getpid()


def failing(number: int) -> int:
    raise ValueError(f"no {number}")


@pytest.fixture
def safe_path(monkeypatch):
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)


@pytest.mark.usefixtures("safe_path")
def test_results_come_in_the_order_of_the_tasks():
    if threading.active_count() > 1:
        pytest.skip("a process with threads is not forked")
    answers = in_processes(doubled, [3, 1, 2], [1, 9, 5], 2, silent)
    assert answers is not None
    assert [answer for answer, _ in answers] == [6, 2, 4]
    assert os.getpid() not in {process for _, process in answers}
    assert "PYTHONSAFEPATH" not in os.environ


class Pool:
    """A pool that records what it gets, in place of processes."""

    def __init__(self) -> None:
        self.work: list[int] = []
        self.chunk = 0
        self.path = ""
        self.shut: dict[str, bool] = {}

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def map(self, perform, work, chunksize):
        self.work, self.chunk, self.path = [*work], chunksize, os.environ["PYTHONSAFEPATH"]
        return map(perform, work)

    def shutdown(self, **given: bool) -> None:
        self.shut = given


@pytest.fixture
def pool(monkeypatch) -> Pool:
    made = Pool()
    monkeypatch.setattr(workers, "_pool", lambda _: made)
    return made


def test_the_largest_task_starts_first(pool, monkeypatch):
    monkeypatch.setenv("PYTHONSAFEPATH", "")
    assert in_processes(str, [10, 20, 30], [1, 3, 2], 4, silent) == ["10", "20", "30"]
    assert (pool.work, pool.chunk, pool.path) == ([20, 30, 10], 1, "1")
    assert os.environ["PYTHONSAFEPATH"] == "", "the variable is as before"


@pytest.mark.parametrize(("count", "chunk"), [(31, 1), (32, 2), (64, 3)])
@pytest.mark.usefixtures("safe_path")
def test_tasks_are_divided_into_sixteen_chunks_per_process(pool, count, chunk):
    in_processes(str, range(count), [1] * count, 2, silent)
    assert pool.chunk == chunk


@pytest.mark.usefixtures("safe_path")
def test_a_failing_task_ends_the_other_tasks(pool):
    with pytest.raises(ValueError, match="no 1"):
        in_processes(failing, [1, 2], [1, 1], 2, silent)
    assert pool.shut == {"wait": False, "cancel_futures": True}
    assert "PYTHONSAFEPATH" not in os.environ


def test_result_is_none_without_process_support(monkeypatch):
    monkeypatch.setattr(workers, "_context", lambda: None)
    assert in_processes(str, [1], [1], 2, silent) is None


def test_a_program_with_threads_is_not_forked():
    end = threading.Event()
    thread = threading.Thread(target=end.wait)
    thread.start()
    try:
        assert workers._context() is None
    finally:
        end.set()
        thread.join()


def test_progress_pauses_while_processes_start():
    with Progress(io.StringIO(), patience=60) as progress:
        before = threading.active_count()
        with paused(progress.tell):
            assert threading.active_count() == before - 1
        assert threading.active_count() == before
        with pytest.raises(KeyError), paused(progress.tell):
            raise KeyError
        assert threading.active_count() == before
    with paused(silent):
        pass


def test_an_interrupt_waits_until_the_processes_have_started():
    got: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: got.append(number))
    try:
        with uninterrupted():
            signal.raise_signal(signal.SIGINT)
            assert got == []
        assert got == [signal.SIGINT]
        over()
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
        end_silently()  # a job in the background ignores Ctrl-C, and its processes do, too
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
        signal.signal(signal.SIGINT, signal.default_int_handler)
        with uninterrupted():
            end_silently()
            assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, set())
        assert signal.getsignal(signal.SIGINT) is signal.SIG_DFL
    finally:
        signal.signal(signal.SIGINT, before)
