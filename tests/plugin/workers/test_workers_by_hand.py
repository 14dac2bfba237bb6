"""The worker process and its parent, one function at a time, without starting a process."""

from __future__ import annotations

import io
import json
import os
import runpy
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import _pytest.config
import pytest

from pytest_tarl import Sensor
from pytest_tarl.errors import FixtureError, SettingsError, TarlError
from pytest_tarl.rollout import EpisodePlan
from pytest_tarl.workers import cluster, executor, pool, protocol, worker, worker_main
from pytest_tarl.workers.executor import EpisodeExecutor, opened
from pytest_tarl.workers.pool import PATIENCE, Pool, Post, Worker, WorkerDiedError, WorkerHeldError
from tests.plugin.workers.test_answers import reason, said
from tests.plugin.workers.test_pool import Process
from tests.plugin.workers.test_protocol import PLAN, RUN

POST = Post("/project", '{"path": []}', b"first")


# The parent's side of one worker


class Started(Process):
    """A worker process that notes how it is awaited."""

    def __init__(self, *answers: bytes, hangs: bool = False) -> None:
        super().__init__(*answers)
        self.hangs = hangs

    def wait(self, timeout: float | None = None) -> int:
        self.signals.append(f"wait {timeout}")
        if self.hangs and timeout is not None:
            raise subprocess.TimeoutExpired("worker", timeout)
        return self.returncode


@pytest.fixture
def start(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., tuple[Worker, Started, dict[str, Any]]]]:
    """Return a function that starts a worker with these answers."""
    made: list[Worker] = []

    def started(*answers: bytes, post: Post = POST, hangs: bool = False) -> tuple[Worker, Started, Any]:
        process, given = Started(*answers, hangs=hangs), dict[str, Any]()
        monkeypatch.setattr(
            subprocess, "Popen", lambda command, **how: given.update(how, command=command) or process
        )
        made.append(Worker(post))
        return made[-1], process, given

    yield started
    for one in made:
        one._log.close()


def test_worker_is_a_process_in_the_run_folder(start: Any) -> None:
    one, _, given = start()
    assert given["command"] == [sys.executable, str(pool.WORKER_MAIN), POST.start]
    assert pool.WORKER_MAIN.is_file()
    assert (given["cwd"], given["stdin"], given["stdout"]) == (
        "/project",
        subprocess.PIPE,
        subprocess.PIPE,
    )
    assert given["stderr"] is one._log
    assert start(post=Post("/project", "{}", b"", loud=True))[2]["stderr"] is None


def test_a_worker_is_ready_after_its_greeting(start: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[Any] = []

    class Thread:
        def __init__(self, target: Any, name: str, daemon: bool) -> None:
            self.start = lambda: begun.append((target, daemon))

    monkeypatch.setattr(threading, "Thread", Thread)
    one, process, _ = start(protocol.READY)
    one.greet()
    assert begun == [(one._listen, True)]
    assert process.stdin.getvalue().endswith(b"first")
    refusing, _, _ = start(protocol.error_message(FixtureError("old", "record it")))
    with pytest.raises(FixtureError, match="old"):
        refusing.greet()
    assert len(begun) == 1


@pytest.mark.parametrize("hangs", [False, True])
def test_dismissed_worker_gets_time_to_tear_down(start: Any, hangs: bool) -> None:
    one, process, _ = start(hangs=hangs)
    written: list[bytes] = []
    process.stdin.close = lambda: written.append(process.stdin.getvalue())
    one.dismiss()
    assert written == [protocol.LENGTH.pack(0)]
    assert process.signals == [f"wait {PATIENCE}", "kill", "wait None"]
    assert one._over.is_set()
    assert process.stdout.closed
    assert one._log.closed


def test_a_worker_whose_pipe_is_closed_can_be_dismissed(start: Any) -> None:
    one, process, _ = start()
    process.stdin.close()
    one.dismiss()
    assert "kill" in process.signals


def test_ended_worker_is_awaited_first(start: Any) -> None:
    one, process, _ = start(hangs=True)
    one._log.write("first\n\xfc last\n\n".encode("latin-1"))
    with pytest.raises(WorkerDiedError, match=r"^ended with status 3: \ufffd last$"):
        one.ask(b"request")
    assert process.signals == [f"wait {PATIENCE}"]
    assert one._asked is False
    assert one._log_text() == "first\n\ufffd last\n\n"  # from the beginning, also if it was read before
    one._log.close()
    assert one._log_text() == ""


@pytest.mark.parametrize(
    ("status", "held"), [(-signal.SIGABRT, False), (-(pool.SIGNAL or 0), True), (0, False)]
)
def test_worker_ended_by_the_watchdog_hung(start: Any, status: int, held: bool) -> None:
    one, process, _ = start()
    process.returncode = status
    one._log.write(b'  File "/robot/keeper.py", line 12 in control\n')
    with pytest.raises(WorkerHeldError if held else WorkerDiedError, match="keeper"):
        one.ask(b"request")


def test_silent_worker_is_killed(start: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "SILENCE", 0)
    one, process, _ = start(hangs=True)
    one._asked = True
    waits: list[float] = []
    one._over.wait = lambda seconds: waits.append(seconds) or False
    one._listen()
    assert waits == [1.0]
    assert process.signals == [f"signal {signal.SIGABRT:d}", f"wait {PATIENCE}", "kill"]


@pytest.mark.parametrize(
    ("log", "place"),
    [
        ("", ""),
        ("no frames\n", ""),
        ('  File "{ours}/a.py", line 3 in f\n', ""),
        ('  File "{ours}/a.py", line 3 in f\n  File "/r/n.py", line 12 in g\n  File "/r/m.py", line 1 in h\n',
         "n.py"),
        ('File "/r/n.py", line 12 in g\n', "n.py"),
    ],
)  # fmt: skip
def test_hang_is_located_in_user_code(log: str, place: str) -> None:
    found = pool.place_held(log.format(ours=pool.WORKER_MAIN.parent.parent))
    assert (place in found) if place else (found == pool.describe_first([]))
    assert "m.py" not in found


# The pool


class Willing:
    """A worker that answers with the number of its requests, unless it is told to fail."""

    log: list[tuple[int, str]]
    failing: BaseException | None

    def __init__(self, post: Post) -> None:
        self.number = sum(what == "made" for _, what in self.log)
        self.note("made")

    def note(self, what: str) -> None:
        type(self).log.append((self.number, what))

    def greet(self) -> None:
        self.note("greet")

    def ask(self, request: bytes) -> bytes:
        self.note("ask")
        if self.failing is not None:
            raise self.failing
        return request + b"%d" % self.number

    def end(self) -> None:
        self.note("end")

    def dismiss(self) -> None:
        self.note("dismiss")


@pytest.fixture
def willing(monkeypatch: pytest.MonkeyPatch) -> Any:
    kind = type("Kind", (Willing,), {"log": [], "failing": None})
    monkeypatch.setattr(pool, "Worker", kind)
    return kind


def test_worker_serves_only_its_own_job(willing: Any) -> None:
    one, other = Pool(), Post("/other", "{}", b"first")
    answers = [one.serve(post, b"x") for post in (POST, POST, other, POST)]
    assert answers == [b"x0", b"x0", b"x1", b"x0"]
    assert [what for number, what in willing.log if number == 0] == ["made", "greet", "ask", "ask", "ask"]
    assert one._busy == []
    one.close()
    assert sorted(willing.log[-2:]) == [(0, "dismiss"), (1, "dismiss")]


@pytest.mark.parametrize("error", [TarlError("no marker"), WorkerHeldError("a.py:3"), KeyboardInterrupt()])
def test_repeatable_error_is_not_retried(willing: Any, error: BaseException) -> None:
    willing.failing = error
    one = Pool()
    with pytest.raises(type(error)):
        one.serve(POST, b"x")
    assert willing.log == [(0, "made"), (0, "greet"), (0, "ask"), (0, "end")]
    assert (one._busy, one._idle) == ([], {})


# The executor


def test_episodes_are_submitted_with_the_job_and_their_plan() -> None:
    requests: list[tuple[Post, EpisodePlan]] = []

    def serve(post: Post, request: bytes) -> bytes:
        requests.append((post, protocol.planned(request)))
        return protocol.run_message(RUN)

    with ThreadPoolExecutor(1) as threads:
        made = EpisodeExecutor(threads, serve, POST, 1)
        assert made(PLAN).failure == "fell"
        assert made.begin(PLAN).result().plan == PLAN
    assert requests == [(POST, PLAN)] * 2


class Threads:
    """An executor that notes how it is shut down."""

    def __init__(self, log: list[Any], *given: Any) -> None:
        self.log = log
        log.append(("threads", *given))

    def shutdown(self, **how: bool) -> None:
        self.log.append(("shutdown", how))


@pytest.mark.parametrize("fails", [False, True])
def test_local_workers_end_with_the_test(monkeypatch: pytest.MonkeyPatch, fails: bool) -> None:
    log: list[Any] = []
    serving = SimpleNamespace(serve="serve", close=lambda: log.append("close"))
    monkeypatch.setattr(executor, "posted", lambda *given: given)
    monkeypatch.setattr(executor, "Pool", lambda: serving)
    monkeypatch.setattr(executor, "ThreadPoolExecutor", lambda *given: Threads(log, *given))
    options: Any = SimpleNamespace(cluster=None, workers=3)
    ended = False
    try:
        with opened("item", "instruments", "sensors", options) as made:  # type: ignore[arg-type]
            assert (made.serve, made.post, made.workers) == ("serve", ("item", "instruments", "sensors"), 3)
            if fails:
                raise ValueError
    except ValueError:
        ended = True
    assert ended is fails
    assert log == [
        ("threads", 3, "tarl"),
        ("shutdown", {"wait": False, "cancel_futures": True}),
        "close",
        ("shutdown", {}),
    ]


def test_address_selects_cluster_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    log: list[str] = []

    @contextmanager
    def joined(address: str) -> Iterator[tuple[str, int]]:
        log.append(address)
        yield "remote", 5
        log.append("left")

    monkeypatch.setattr(executor, "posted", lambda *given: "post")
    monkeypatch.setattr(cluster, "joined", joined)
    options: Any = SimpleNamespace(cluster="tcp://x:1", workers=3)
    with opened(None, None, (), options) as made:  # type: ignore[arg-type]
        assert (made.executor, made.serve, made.post, made.workers) == (
            "remote",
            cluster.serve_here,
            "post",
            5,
        )
        assert log == ["tcp://x:1"]
    assert log == ["tcp://x:1", "left"]


# The cluster


class Client:
    """A client of Dask."""

    def __init__(self, log: list[Any], threads: dict[str, int], address: str, **how: Any) -> None:
        self.log, self.threads, self.lost = log, threads, False
        log.append((address, how))

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.log.append("closed")

    def nthreads(self) -> dict[str, int]:
        return self.threads

    def get_executor(self, **how: Any) -> Threads:
        return Threads(self.log, how)

    def run(self, function: Any) -> None:
        self.log.append(function)
        raise TimeoutError  # the cluster may have gone; leaving it must not fail


@pytest.fixture
def dask(monkeypatch: pytest.MonkeyPatch) -> tuple[list[Any], dict[str, int]]:
    """Put a stand-in of Dask into `sys.modules`; return what it is told, and the threads of its workers."""
    log: list[Any] = []
    threads = {"a": 2, "b": 3}
    module: Any = ModuleType("distributed")
    module.Client = lambda address, **how: Client(log, threads, address, **how)
    monkeypatch.setitem(sys.modules, "distributed", module)
    return log, threads


def test_run_uses_all_cluster_threads(dask: tuple[list[Any], dict[str, int]]) -> None:
    log, _ = dask
    with cluster.joined("tcp://x:1") as (remote, workers):
        assert workers == 5
        assert isinstance(remote, Threads)
    assert log == [
        ("tcp://x:1", {"timeout": 10, "set_as_default": False}),
        ("threads", {"retries": 2}),
        ("shutdown", {"wait": False}),
        cluster.leave,
        "closed",
    ]


def test_a_cluster_without_workers_is_refused(dask: tuple[list[Any], dict[str, int]]) -> None:
    log, threads = dask
    threads.clear()
    with (
        pytest.raises(SettingsError, match=r"scheduler at tcp://x:1 has no workers"),
        cluster.joined("tcp://x:1"),
    ):
        pass
    assert log[1:] == ["closed"]


@pytest.mark.parametrize("problem", [OSError("timed out"), ValueError("no address")])
def test_a_cluster_that_does_not_answer_is_refused(
    monkeypatch: pytest.MonkeyPatch, problem: Exception
) -> None:
    def refused(address: str, **how: Any) -> None:
        raise problem

    module: Any = ModuleType("distributed")
    module.Client = refused
    monkeypatch.setitem(sys.modules, "distributed", module)
    with (
        pytest.raises(SettingsError, match=rf"no Dask scheduler answers at x \({problem}\)"),
        cluster.joined("x"),
    ):
        pass
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SettingsError, match="needs Dask: run pip install"), cluster.joined("x"):
        pass


def test_each_cluster_machine_has_one_pool(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[Any] = []

    def new() -> Any:
        closed: list[bool] = []
        one = SimpleNamespace(
            serve=lambda post, request: (len(made), post, request),
            close=lambda: closed.append(True),
            closed=closed,
        )
        made.append(one)
        return one

    monkeypatch.setattr(cluster, "Pool", new)
    monkeypatch.setattr(cluster, "_pools", [])
    assert cluster.serve_here(POST, b"x") == (1, POST, b"x")
    assert cluster.serve_here(POST, b"y") == (1, POST, b"y")  # type: ignore[comparison-overlap]
    cluster.leave()
    cluster.leave()
    assert (made[0].closed, cluster._pools) == ([True], [])
    cluster.serve_here(POST, b"z")
    assert len(made) == 2


# The worker's side


class Items:
    """A session with one collected test; `sessions` is what the worker did with its rollout."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, item: pytest.Function) -> None:
        self.log: list[Any] = []
        self.session: Any = SimpleNamespace(items=[item])
        monkeypatch.setattr(worker, "BEAT", 1e6)
        monkeypatch.setattr(worker, "finish", lambda *given: self.log.append(("finish", *given)))

    def run(self, post: dict[str, Any], *requests: bytes) -> list[bytes]:
        asked, answers = io.BytesIO(), io.BytesIO()
        for request in requests:
            protocol.write(asked, request)
        asked.seek(0)
        server = worker.Server(post, asked, answers)
        assert server.pytest_runtestloop(self.session)
        server.refuse("no test was run")
        return said(answers)


@dataclass(frozen=True)
class Marked:
    """The marker of a test."""

    sensors: tuple[Sensor, ...]


class Collected(pytest.Function):
    """A test function of pytest that is not in a session."""

    nodeid = "test_it.py::test_x"


@pytest.fixture
def item(monkeypatch: pytest.MonkeyPatch) -> pytest.Function:
    """Return a collected test with a marker, without collecting it."""
    made = Collected.__new__(Collected)
    monkeypatch.setattr(
        worker, "designated", lambda one: Marked((Sensor("x", bins=2),)) if one is made else None
    )
    return made


def test_a_worker_uses_the_learned_bins_of_the_run(
    item: pytest.Function, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = Items(monkeypatch, item)
    given: list[Any] = []
    monkeypatch.setattr(worker, "ItemRollout", lambda *all_: given.append(all_) or (lambda plan: RUN))
    post = {
        "nodeid": item.nodeid,
        "edges": {"x": [0.0, 0.5, 2.0]},
        "instruments": {"positions": {"/a.py": [[3, 5, 7], [4, 1, 8]]}, "publishes": [8]},
    }
    answers = made.run(post, protocol.plan_message(PLAN), b"", protocol.plan_message(PLAN))
    ((used, marked, places),) = given
    assert (used, marked.sensors[0].edges, marked.sensors[0].learned) == (item, (0.0, 0.5, 2.0), 2)
    assert places.positions == {Path("/a.py"): {(3, 5): 7, (4, 1): 8}}
    assert places.publishes == frozenset({8})
    assert len(answers) == 2  # an empty request ends the session
    assert answers[0] == protocol.READY
    assert made.log == [("finish", item, None)]


@pytest.mark.parametrize("collected", ["other", "no function"])
def test_only_the_test_of_the_job_is_used(
    item: pytest.Function, monkeypatch: pytest.MonkeyPatch, collected: str
) -> None:
    made = Items(monkeypatch, item)
    name = item.nodeid if collected == "no function" else f"{item.nodeid}[2]"
    if collected == "no function":
        made.session.items = [SimpleNamespace(nodeid=name)]
    (answer,) = made.run({"nodeid": name, "edges": {}, "instruments": {}}, b"x")
    assert reason(answer) == f"{name} was not collected"
    assert made.log == []


@pytest.mark.parametrize("fails", [False, True])
def test_a_worker_for_bags_replays_them_through_the_test(
    item: pytest.Function, monkeypatch: pytest.MonkeyPatch, fails: bool
) -> None:
    made = Items(monkeypatch, item)
    seen: list[Any] = []

    def replaying(*given: Any) -> Any:
        seen.append(given)
        if fails:
            raise FixtureError("other sensors", "record it")
        return lambda plan: RUN

    monkeypatch.setattr(worker, "replaying", replaying)
    # the job names the test with its drift, but pytest collects it without, for bags
    monkeypatch.setattr(worker, "without_drift", lambda one: f"{one.nodeid}[mud]")
    post = {"nodeid": f"{item.nodeid}[mud]", "edges": {}, "instruments": None, "sensors": "digest",
            "sites": ["b", "a"]}  # fmt: skip
    answers = made.run(post, protocol.plan_message(PLAN))
    assert (seen[0][0], seen[0][2:]) == (item, ("digest", ["b", "a"]))
    if fails:
        assert reason(answers[0]).startswith("other sensors")
        assert (len(answers), made.log) == (1, [])
    else:
        assert answers[0] == protocol.READY
        assert protocol.answered(PLAN, answers[1]).failure == "fell"


def test_heartbeats_are_sent_until_the_run_has_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    waits: list[float] = []

    class Pipe(io.BytesIO):
        def flush(self) -> None:
            if len(waits) == 3:
                raise OSError

    monkeypatch.setattr(
        worker.threading, "Event", lambda: SimpleNamespace(wait=lambda s: waits.append(s) or False)
    )
    answers = Pipe()
    server = worker.Server({}, io.BytesIO(), answers)
    server._beat()
    assert waits == [worker.BEAT] * 3
    assert said(io.BytesIO(answers.getvalue())) == [protocol.ALIVE] * 3
    assert not server.turn.locked()


def test_workers_do_not_write_caches() -> None:
    removed: list[str] = []
    manager = SimpleNamespace(unregister=lambda name: removed.append(name))
    session: Any = SimpleNamespace(config=SimpleNamespace(pluginmanager=manager))
    worker.Server({}, io.BytesIO(), io.BytesIO()).pytest_sessionstart(session)
    assert removed == ["lfplugin", "nfplugin", "stepwiseplugin"]


class Ended(BaseException):
    """In place of the end of the process."""


def test_requests_are_forwarded_whole_until_the_run_has_ended(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    chunks = [b"abcdefgh", b"ij"]
    written: list[bytes] = []
    log: list[Any] = []

    def read(descriptor: int, size: int) -> bytes:
        assert (descriptor, size) == (3, 1 << 16)
        return chunks.pop(0) if chunks else b""

    def write(descriptor: int, data: bytes) -> int:
        assert descriptor == 4
        written.append(bytes(data[:3]))
        return len(data[:3])

    def leave(status: int) -> None:
        log.append(status)
        raise Ended

    monkeypatch.setattr(os, "read", read)
    monkeypatch.setattr(os, "write", write)
    monkeypatch.setattr(os, "_exit", leave)
    monkeypatch.setattr(sys, "stderr", SimpleNamespace(flush=lambda: log.append("flush")))
    with pytest.raises(Ended):
        worker._forwarded(3, 4)
    assert written == [b"abc", b"def", b"gh", b"ij"]
    assert log == ["flush", 70]


@pytest.mark.parametrize("case", ["ended", "no configuration", "served", "no test"])
def test_a_worker_serves_the_first_message_of_its_run(monkeypatch: pytest.MonkeyPatch, case: str) -> None:
    told, answers = os.pipe()
    sent: list[bytes] = []
    begun: list[Any] = []

    def forward(function: Any, given: tuple[int, int]) -> None:
        begun.append((function, given[0]))
        with os.fdopen(given[1], "wb") as pipe:
            if case != "ended":
                protocol.write(pipe, b'{"nodeid": "t"}')

    registered: list[Any] = []

    def main(config: Any) -> None:
        server, name = registered[0]
        assert (server.post, name) == ({"nodeid": "t"}, "tarl-worker")
        sent.append(b"ran")
        if case == "served":
            server.serving = True

    config: Any = SimpleNamespace(
        pluginmanager=SimpleNamespace(register=lambda *given: registered.append(given)),
        hook=SimpleNamespace(pytest_cmdline_main=main),
    )
    monkeypatch.setattr(worker._thread, "start_new_thread", forward)
    worker.serve(77, answers, None if case == "no configuration" else config, "no such option")
    with os.fdopen(told, "rb") as pipe:
        found = said(io.BytesIO(pipe.read()))
    assert begun == [(worker._forwarded, 77)]
    assert [reason(one) for one in found] == {
        "no configuration": ["no such option"],
        "no test": ["no test was run"],
    }.get(case, [])
    assert sent == ([b"ran"] if case in ("served", "no test") else [])


# The script of a worker


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> Callable[..., dict[str, Any]]:
    """Return a function that runs the script with this job; it returns what the script does."""

    def run(start: dict[str, Any], problem: BaseException | None = None) -> dict[str, Any]:
        done: dict[str, Any] = {}

        def configured(*given: Any) -> Any:
            done["given"] = given
            if problem is not None:
                raise problem
            return SimpleNamespace(option=SimpleNamespace(old=1))

        monkeypatch.setattr(sys, "argv", ["worker_main.py", json.dumps(start)])
        monkeypatch.setattr(sys, "path", [*sys.path])
        monkeypatch.setattr(worker_main, "_pipes", lambda: (5, 6))
        monkeypatch.setattr(signal, "signal", lambda *given: done.update(signal=given))
        monkeypatch.setattr(_pytest.config, "_prepareconfig", configured)
        monkeypatch.setattr(_pytest.config.Config, "fromdictargs", configured)
        monkeypatch.setattr(worker, "serve", lambda *given: done.update(served=given))
        worker_main.main()
        return {**done, "path": [*sys.path]}

    return run


def test_a_worker_has_the_configuration_of_its_run(script: Callable[..., dict[str, Any]]) -> None:
    options = {"plugins": ["no:terminal", "cov", "no:odd"], "maxfail": 1}
    done = script({"path": [*sys.path, "/lib"], "options": options, "target": "t.py::test_x"})
    assert done["given"] == (options, ["t.py::test_x", "-pno:terminal", "-pno:odd"])
    assert done["signal"] == (signal.SIGINT, signal.SIG_IGN)
    assert done["path"][-1] == "/lib"
    requests, answers, config, problem = done["served"]
    assert (requests, answers, problem) == (5, 6, "")
    assert config.option.old == 1


def test_a_worker_for_bags_is_configured_by_arguments(script: Callable[..., dict[str, Any]]) -> None:
    done = script({"path": [*sys.path], "arguments": ["-q", "t.py"], "options": {"dist": "no"}})
    assert done["given"] == (["-q", "t.py"],)
    assert vars(done["served"][2].option) == {"old": 1, "dist": "no"}


@pytest.mark.parametrize("problem", [ValueError("odd"), SystemExit("usage")])
def test_a_worker_reports_a_failed_configuration_to_the_run(
    script: Callable[..., dict[str, Any]], problem: BaseException
) -> None:
    done = script({"path": [*sys.path], "options": {"plugins": []}, "target": "t"}, problem)
    assert done["served"] == (5, 6, None, f"{type(problem).__name__}: {problem}")


def test_worker_pipes_are_hidden_from_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    log: list[Any] = []
    monkeypatch.setattr(os, "dup", lambda one: 10 + one)
    monkeypatch.setattr(os, "open", lambda *given: log.append(("open", *given)) or 20)
    monkeypatch.setattr(os, "dup2", lambda one, other: log.append((one, other)))
    monkeypatch.setattr(os, "close", lambda one: log.append(("close", one)))
    assert worker_main._pipes() == (10, 11)
    assert log == [("open", os.devnull, os.O_RDONLY), (20, 0), (2, 1), ("close", 20)]


def test_the_script_does_nothing_when_it_is_imported() -> None:
    assert "main" in runpy.run_path(str(pool.WORKER_MAIN), run_name="imported")
