"""`tarl watch`: invalid arguments, what is printed when, the end of a watch, and its exit status."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.commands import watch
from pytest_tarl.commands.watch import Order, Teller, default_state, run
from pytest_tarl.errors import LogError, SettingsError

ORDER = Order((Path("a.log"),), Path("f.npz"), Path("state.npz"))
Printed = pytest.CaptureFixture[str]


def status(missions: int = 0, *, alarm: bool = False, below: bool = False, drifted: bool = False) -> Any:
    return SimpleNamespace(missions=missions, alarm=alarm or below or drifted, below=below, drifted=drifted)


class Watch:
    """Stand-in for a watch: each poll yields missions, after each of which the next status holds."""

    def __init__(self, *polls: list[Any], problems: tuple[str, ...] = ()) -> None:
        self.polls = list(polls)
        self.now = status()
        self.problems = problems
        self.saved = 0
        self.closed = False

    def status(self) -> Any:
        return self.now

    def poll(self) -> Iterator[int]:
        for now in self.polls.pop(0) if self.polls else []:
            self.now = now
            yield now.missions

    def save(self) -> None:
        self.saved += 1

    def close(self) -> None:
        self.closed = True


@pytest.fixture(autouse=True)
def shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shorten what is printed."""
    monkeypatch.setattr(watch.words, "headline", lambda _, now: f"headline {now.missions}")
    monkeypatch.setattr(watch.words, "lines", lambda _, now: ["report", str(now.missions)])
    monkeypatch.setattr(watch.dashboard, "document", lambda _, now: {"missions": now.missions})
    monkeypatch.setattr(watch.dashboard, "line", lambda found: f"json {found['missions']}")
    monkeypatch.setattr(watch.dashboard, "write", lambda found, path: path.write_text(str(found["missions"])))


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(watch, "monotonic", made)
    return made


def teller(watched: Watch, **changed: Any) -> Teller:
    found: Any = watched
    return Teller(replace(ORDER, **changed), found, threading.Event())


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"alpha": 0.0}, "--alpha must be a probability between 0 and 1, such as 0.05, got 0"),
        ({"alpha": 1.0}, "--alpha must be"),
        ({"alpha": float("nan")}, "--alpha must be"),
        ({"interval": 0.0}, "--interval must be a number of seconds above 0, got 0"),
        ({"interval": float("inf")}, "--interval must be"),
        ({"every": -1.0}, "--every must be a number of seconds above 0, got -1"),
        ({"every": float("nan")}, "--every must be"),
        ({"once": True, "until_alarm": True}, "--once reads the logs once and ends"),
        ({"once": True, "ros": "rospy"}, "--once reads the logs once and ends"),
        ({"json": Path("a.log")}, "--json a.log would overwrite an input file"),
        ({"json": Path("x/../f.npz")}, "--json x/../f.npz would overwrite"),
        ({"json": Path("state.npz")}, "--json state.npz would overwrite"),
        ({"logs": (Path("a.log"), Path("b.log"), Path("x/../b.log"))}, "x/../b.log is named twice"),
    ],
)
def test_arguments_that_contradict_each_other_are_refused(changed: Any, said: str) -> None:
    with pytest.raises(SettingsError, match=f"^{said.replace('.', '[.]')}"):
        run(replace(ORDER, **changed))


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"once": True},
        {"until_alarm": True},
        {"ros": "rclpy", "until_alarm": True},
        {"json": Path("-")},
        {"json": Path("other.json"), "alpha": 0.999, "interval": 1e-9},
        {"logs": (Path("a.log"), Path("b.log"))},
    ],
)
def test_arguments_that_do_not_contradict_each_other_are_accepted(changed: Any) -> None:
    watch._check(replace(ORDER, **changed))


def test_watch_state_is_named_after_the_recording() -> None:
    assert default_state(Path("x/y/f.npz")) == Path(".tarl/watch/f.npz")


def test_missions_are_reported_at_intervals_and_alarms_at_once(clock: Clock, capsys: Printed) -> None:
    watched = Watch([status(1)], [status(2)], [status(3, below=True)], [status(4, below=True)], [])
    told = teller(watched, every=60.0)
    said = []
    for later in (0.0, 60.5, 1.0, 59.0, 500.0):
        clock.now += later
        told.look()
        said.append(capsys.readouterr().out)
    # 1: the interval has not passed; 2: it has; 3: an alarm; 4: 59 s after it; 5: nothing is new
    assert said == ["", "headline 2\n", "headline 3\n", "", ""]


def test_an_alarm_that_changes_is_reported(clock: Clock, capsys: Printed) -> None:
    watched = Watch([status(1, drifted=True)], [status(1, drifted=True, below=True)])
    told = teller(watched)
    told.look()
    told.look()
    assert capsys.readouterr().out == "headline 1\nheadline 1\n"


def test_a_long_log_is_reported_while_it_is_read(clock: Clock, capsys: Printed) -> None:
    watched = Watch()

    def poll() -> Iterator[int]:
        for missions, later in ((1, 0.5), (2, 0.6), (3, 1.1)):
            clock.now += later
            watched.now = status(missions)
            yield missions

    watched.poll = poll  # type: ignore[method-assign]
    told = teller(watched, every=1.0)
    told.look()
    # at 1.1 s and at 2.2 s since the last look; nothing new follows
    assert capsys.readouterr().out == "headline 2\nheadline 3\n"


def test_each_problem_is_reported_once(clock: Clock, capsys: Printed) -> None:
    watched = Watch(problems=("a.log: torn",))
    told = teller(watched)
    told.look()
    watched.problems = ("a.log: torn", "b.log: gone")
    told.look()
    assert capsys.readouterr().err == "tarl: a.log: torn\ntarl: b.log: gone\n"


def test_the_result_file_is_updated_while_the_watch_runs(
    clock: Clock, tmp_path: Path, capsys: Printed
) -> None:
    path = tmp_path / "a.json"
    watched = Watch([], [status(1)], [])
    told = teller(watched, json=path)
    told.look()
    assert not path.exists()
    told.look()
    assert path.read_text() == "1"
    path.unlink()
    told.look()
    assert not path.exists()
    watched.problems = ("torn",)
    told.look()
    assert path.read_text() == "1"
    assert capsys.readouterr().out == ""


def test_json_on_standard_output_replaces_the_text_report(clock: Clock, capsys: Printed) -> None:
    watched = Watch([status(1, below=True)])
    told = teller(watched, json=Path("-"))
    assert told.close(told.look()) == 1
    assert capsys.readouterr().out == "json 1\njson 1\n"


def test_with_the_option_once_only_the_report_is_printed(clock: Clock, capsys: Printed) -> None:
    watched = Watch([status(1, below=True)], problems=("torn",))
    told = teller(watched, once=True)
    assert told.close(told.look()) == 1
    assert capsys.readouterr() == ("report\n1\n", "")


@pytest.mark.parametrize(
    ("until", "stopped", "read"), [(True, False, 2), (False, False, 3), (False, True, 1), (True, True, 1)]
)
def test_reading_ends_at_an_alarm_or_an_interruption(
    clock: Clock, until: bool, stopped: bool, read: int
) -> None:
    watched = Watch()
    seen: list[int] = []

    def poll() -> Iterator[int]:
        for missions, below in ((1, False), (2, True), (3, True)):
            seen.append(missions)
            clock.now += 5.0
            watched.now = status(missions, below=below)
            yield missions

    watched.poll = poll  # type: ignore[method-assign]
    told = teller(watched, until_alarm=until)
    if stopped:
        told.stopped.set()
    assert told.look().missions == read
    assert (len(seen), watched.saved) == (read, int(read < 3))


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return a function that makes `run` watch a stand-in, and the arguments of its beginning."""
    given: list[Any] = []

    @contextmanager
    def locked(path: Path) -> Iterator[None]:
        given.append(path)
        yield

    def use(watched: Watch) -> list[Any]:
        monkeypatch.setattr(watch.watch_state, "locked", locked)
        monkeypatch.setattr(
            watch.watch, "begun", lambda *positional, **named: given.append((positional, named)) or watched
        )
        return given

    return use


@pytest.mark.parametrize(("below", "code"), [(True, 1), (False, 0)])
def test_once_option_sets_the_exit_status_by_alarm(
    begun: Any, below: bool, code: int, capsys: Printed
) -> None:
    watched = Watch([status(1, below=below)])
    given = begun(watched)
    order = replace(ORDER, once=True, alpha=0.1, seed=3)
    assert run(order) == code
    assert given == [order.state, ((order.logs, order.fixture, order.state), {"alpha": 0.1, "seed": 3})]
    assert watched.closed
    assert capsys.readouterr().out == "report\n1\n"


def test_once_option_reports_an_unreadable_log_and_fails(begun: Any, capsys: Printed) -> None:
    watched = Watch([status(1)], problems=("a.log: torn.", "b.log: gone."))
    begun(watched)
    with pytest.raises(LogError, match=r"^a\.log: torn\. b\.log: gone\.$"):
        run(replace(ORDER, once=True))
    assert watched.closed
    assert capsys.readouterr().out == "report\n1\n"


def test_interruption_ends_the_watch_between_missions(begun: Any) -> None:
    watched = Watch()

    def poll() -> Iterator[int]:
        signal.raise_signal(signal.SIGINT)
        yield 1
        pytest.fail("read on")

    watched.poll = poll  # type: ignore[method-assign]
    begun(watched)
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    assert run(replace(ORDER, once=True)) == 130
    assert watched.saved == 1
    assert (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)) == before


def test_a_second_interruption_ends_the_watch_at_once() -> None:
    with watch._stopped() as stopped:
        signal.raise_signal(signal.SIGTERM)
        assert stopped.is_set()
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)


def test_watch_in_a_thread_keeps_signal_handlers() -> None:
    before, found = signal.getsignal(signal.SIGINT), []

    def other() -> None:
        with watch._stopped() as stopped:
            found.append((stopped.is_set(), signal.getsignal(signal.SIGINT)))

    thread = threading.Thread(target=other)
    thread.start()
    thread.join()
    assert found == [(False, before)]


def test_until_alarm_ends_at_the_first_alarm(begun: Any, capsys: Printed) -> None:
    watched = Watch([], [status(1)], [status(2, below=True)], [status(3, below=True)])
    begun(watched)
    assert run(replace(ORDER, until_alarm=True, interval=1e-6)) == 1
    assert [one.missions for poll in watched.polls for one in poll] == [3]
    assert capsys.readouterr().out == "headline 2\nreport\n2\n"


def test_a_watch_waits_between_two_reads_of_the_logs(begun: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    waited: list[float | None] = []

    class Event(threading.Event):
        def wait(self, timeout: float | None = None) -> bool:
            waited.append(timeout)
            if len(waited) == 3:
                self.set()
            return self.is_set()

    monkeypatch.setattr(watch, "Event", Event)
    begun(Watch())
    assert run(replace(ORDER, interval=7.5)) == 0
    assert waited == [7.5] * 3


def test_ros_node_of_the_watch_reads_logs_until_it_ends(
    begun: Any, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    watched = Watch([status(1)], [status(2, below=True)])
    begun(watched)
    given: list[Any] = []

    def node(ros: str, look: Any, interval: float, stopped: threading.Event) -> None:
        given.append((ros, interval, stopped.is_set()))
        given.extend(look() for _ in range(2))

    monkeypatch.setattr("pytest_tarl.monitoring.node.run", node)
    assert run(replace(ORDER, ros="rclpy", until_alarm=True, interval=2.0)) == 1
    assert given[0] == ("rclpy", 2.0, False)
    assert [(going, of is watched, now.missions) for going, of, now in given[1:]] == [
        (True, True, 1),
        (False, True, 2),
    ]
