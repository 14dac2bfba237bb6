"""The results of submitted episodes, and what a worker answers if it cannot serve."""

from __future__ import annotations

import io
from concurrent.futures import CancelledError, Future
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import RecordingError, TarlError
from pytest_tarl.workers import protocol, worker
from pytest_tarl.workers.executor import Answer
from pytest_tarl.workers.pool import WorkerDiedError, WorkerHeldError
from tests.plugin.workers.test_protocol import PLAN, RUN


def submitted(outcome: bytes | BaseException | None) -> Answer:
    future: Future[bytes] = Future()
    if isinstance(outcome, bytes):
        future.set_result(outcome)
    elif outcome is not None:
        future.set_exception(outcome)
    return Answer(PLAN, future)


ENDS = [
    (protocol.error_message(TarlError("no reward")), TarlError, "no reward"),
    (protocol.error_message(protocol.SkippedError("rain")), pytest.skip.Exception, "rain"),
    (protocol.error_message(protocol.EndedError("enough")), pytest.exit.Exception, "enough"),
    (
        WorkerDiedError("ended with status 3"),
        RecordingError,
        r"In each of 3 attempts, .* ended with status 3\.",
    ),
    (WorkerHeldError("keeper.py:12"), RecordingError, "held the interpreter at keeper.py:12"),
    (CancelledError(), RecordingError, "cluster cancelled"),
]


@pytest.mark.parametrize(("outcome", "error", "says"), ENDS, ids=lambda one: getattr(one, "__name__", None))
def test_an_episode_without_a_result_raises_its_reason(
    outcome: bytes | BaseException, error: type[BaseException], says: str
) -> None:
    with pytest.raises(error, match=says):
        submitted(outcome).result()


def test_a_callback_gets_each_result_and_no_failure() -> None:
    heard: list[Any] = []
    submitted(protocol.run_message(RUN)).then(heard.append)
    assert [one.failure for one in heard] == ["fell"]
    for outcome, _, _ in ENDS:
        submitted(outcome).then(heard.append)
    later = submitted(None)
    later.then(heard.append)
    assert len(heard) == 1
    later.future.set_result(protocol.run_message(RUN))
    cancelled = submitted(None)
    cancelled.then(heard.append)
    assert cancelled.cancel()
    assert len(heard) == 2


def said(pipe: io.BytesIO) -> list[bytes]:
    read = io.BytesIO(pipe.getvalue())
    return [*iter(lambda: protocol.read(read), None)]


def reason(message: bytes) -> str:
    with pytest.raises(TarlError) as raised:
        protocol.refused(message)
    return str(raised.value)


def test_empty_worker_gives_the_reason_once() -> None:
    answers = io.BytesIO()
    server = worker.Server({"nodeid": "test_x.py::test_x", "instruments": {}}, io.BytesIO(), answers)
    server.pytest_collectreport(SimpleNamespace(failed=False, longreprtext="fine"))  # type: ignore[arg-type]
    server.pytest_collectreport(SimpleNamespace(failed=True, longreprtext="no module y"))  # type: ignore[arg-type]
    server.pytest_internalerror("INTERNAL")
    assert server.pytest_runtestloop(SimpleNamespace(items=[]))  # type: ignore[arg-type]
    server.refuse("no test was run")
    (message,) = said(answers)
    assert reason(message) == "test_x.py::test_x was not collected\nno module y\nINTERNAL"


@pytest.mark.parametrize("marked", [True, False])
def test_prepared_worker_never_reports_a_failed_preparation(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, marked: bool
) -> None:
    marker = "@pytest.mark.tarl(nodes=['n.py'], sensors=[Sensor('x')])\n" if marked else ""
    (pytester.path / "n.py").touch()
    item = pytester.getitem(
        f"import pytest\nfrom pytest_tarl import Sensor\n{marker}def test_x(tarl): ...", "test_x"
    )
    finished = []
    monkeypatch.setattr(worker, "BEAT", 1e6)
    monkeypatch.setattr(worker, "finish", lambda *given: finished.append(given))
    monkeypatch.setattr(worker, "ItemRollout", lambda *_: lambda plan: RUN)
    post = {"nodeid": item.nodeid, "edges": {}, "instruments": {"positions": {}, "publishes": []}}
    requests, answers = io.BytesIO(), io.BytesIO()
    for _ in range(2):
        protocol.write(requests, protocol.plan_message(PLAN))
    protocol.write(requests, b"")
    requests.seek(0)
    server = worker.Server(post, requests, answers)
    assert server.pytest_runtestloop(SimpleNamespace(items=[item]))  # type: ignore[arg-type]
    server.refuse("no test was run")
    first, *runs = said(answers)
    if not marked:
        assert reason(first) == f"{item.nodeid} has no tarl marker"
        assert (runs, finished) == ([], [])
        return
    assert first == protocol.READY
    assert [protocol.answered(PLAN, one).failure for one in runs] == ["fell", "fell"]
    assert finished == [(item, None)]


@pytest.mark.parametrize(
    ("raised", "error", "says"),
    [
        (RecordingError("disk"), RecordingError, "disk"),
        (pytest.skip.Exception("rain"), protocol.SkippedError, "rain"),
        (pytest.exit.Exception("enough"), protocol.EndedError, "enough"),
        (ValueError("odd"), TarlError, "(?s)failed in a worker process:.*ValueError: odd"),
    ],
)
def test_answer_contains_the_episode_exception(
    raised: BaseException, error: type[TarlError], says: str
) -> None:
    def rollout(_: object) -> None:
        raise raised

    with pytest.raises(error, match=says):
        protocol.answered(PLAN, worker.answer(rollout, protocol.plan_message(PLAN)))  # type: ignore[arg-type]
