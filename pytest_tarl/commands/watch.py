"""`tarl watch`: test missions for changes as they arrive."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from time import monotonic

from pytest_tarl.errors import LogError, SettingsError
from pytest_tarl.monitoring import dashboard, watch, watch_state, words
from pytest_tarl.monitoring.status import Status
from pytest_tarl.monitoring.watch import Watch
from pytest_tarl.printable import print_lines, printable, printable_line

STANDARD_OUTPUT = Path("-")
INTERRUPTED = 130
TOLD = 1.0  # maximum seconds between two reports while unread missions are being processed


@dataclass(frozen=True)
class Order:
    """The arguments of the command line."""

    logs: tuple[Path, ...]
    fixture: Path
    state: Path
    json: Path | None = None
    alpha: float = 0.05
    seed: int = 0
    interval: float = 1.0  # seconds between two reads of the logs
    every: float = 60.0  # seconds between two lines of output
    once: bool = False
    until_alarm: bool = False
    ros: str = ""  # library for publishing diagnostics: "rospy" or "rclpy"


def run(order: Order) -> int:
    """Watch until an end condition. Return 1 after an alarm, 130 if Ctrl-C interrupts `once`, otherwise 0.

    Raise LogError if a log cannot be read with `once`, and FixtureError, MonitorError or SettingsError for invalid
    input.
    """
    _check(order)
    with watch_state.locked(order.state), _stopped() as stopped:
        watched = watch.begun(order.logs, order.fixture, order.state, alpha=order.alpha, seed=order.seed)
        with closing(watched):
            teller = Teller(order, watched, stopped)
            if not order.once:
                return _follow(teller)
            status = teller.look()
            code = teller.close(status)
            if watched.problems:
                raise LogError(" ".join(watched.problems))
            return INTERRUPTED if stopped.is_set() else code


def default_state(fixture: Path) -> Path:
    """Return the default path for a watch's state."""
    return Path(".tarl/watch") / f"{fixture.stem}.npz"


class Teller:
    """Read the logs and print results: alarms and problems at once, the rest at intervals."""

    def __init__(self, order: Order, watched: Watch, stopped: Event) -> None:
        self.order = order
        self.watch = watched
        self.stopped = stopped
        self._looked = self._told = monotonic()
        self._before = watched.status()
        self._problems: tuple[str, ...] = ()

    def look(self) -> Status:
        """Read new missions until an end condition; return the status."""
        for _ in self.watch.poll():
            if monotonic() - self._looked > TOLD:
                self._tell(self.watch.status())
            if self.ending(self._before):
                self.watch.save()
                break
        status = self.watch.status()
        self._tell(status)
        return status

    def ending(self, status: Status) -> bool:
        """Return whether an end condition is met."""
        return self.stopped.is_set() or (self.order.until_alarm and status.alarm)

    def _tell(self, status: Status) -> None:
        order, before, now = self.order, self._before, monotonic()
        problems = tuple(one for one in self.watch.problems if one not in self._problems)
        fresh = status.missions != before.missions
        alarms = (status.below, status.drifted) != (before.below, before.drifted)
        self._before, self._problems, self._looked = status, self.watch.problems, now
        if order.once:
            return
        for problem in problems:
            print(printable(f"tarl: {problem}"), file=sys.stderr, flush=True)
        kept = order.json is not None and order.json != STANDARD_OUTPUT
        if kept and (fresh or problems):
            self.document(status)
        if alarms or (fresh and now - self._told > order.every):
            self._told = now
            if order.json == STANDARD_OUTPUT:
                self.document(status)
            else:
                print(printable_line(words.headline(self.watch, status)), flush=True)

    def document(self, status: Status) -> None:
        """Write the JSON result if --json is given."""
        found = dashboard.document(self.watch, status)
        if self.order.json == STANDARD_OUTPUT:
            print(dashboard.line(found), flush=True)
        elif self.order.json is not None:
            dashboard.write(found, self.order.json)

    def close(self, status: Status) -> int:
        """Print the full report; return the exit code."""
        if self.order.json is not None:
            self.document(status)
        if self.order.json != STANDARD_OUTPUT:
            print_lines(words.lines(self.watch, status))
            sys.stdout.flush()
        return int(status.alarm)


def _follow(teller: Teller) -> int:
    """Read the logs again and again, until an alarm (with --until-alarm), Ctrl-C or SIGTERM."""
    order = teller.order
    if not order.ros:
        status = teller.look()
        while not teller.ending(status):
            teller.stopped.wait(order.interval)
            status = teller.look()
        return teller.close(status)
    from pytest_tarl.monitoring import node

    def look() -> tuple[bool, Watch, Status]:
        status = teller.look()
        return not teller.ending(status), teller.watch, status

    node.run(order.ros, look, order.interval, teller.stopped)
    return teller.close(teller.watch.status())


@contextmanager
def _stopped() -> Iterator[Event]:
    """Let Ctrl-C and SIGTERM stop a watch only between portions of a log."""
    stopped = Event()

    def stop(_number: int, _frame: object) -> None:
        if stopped.is_set():
            raise KeyboardInterrupt
        stopped.set()

    try:
        before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    except ValueError:  # Python sets signal handlers only in the main thread
        yield stopped
        return
    try:
        yield stopped
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _check(order: Order) -> None:
    if not 0.0 < order.alpha < 1.0:
        raise SettingsError(
            f"--alpha must be a probability between 0 and 1, such as 0.05, got {order.alpha:g}."
        )
    for name, value in (("interval", order.interval), ("every", order.every)):
        if not 0.0 < value < float("inf"):
            raise SettingsError(f"--{name} must be a number of seconds above 0, got {value:g}.")
    if order.once and (order.until_alarm or order.ros):
        raise SettingsError(
            "--once reads the logs once and ends, so it cannot be combined with --until-alarm or --diagnostics."
        )
    taken = {path.resolve() for path in (*order.logs, order.fixture, order.state)}
    if order.json is not None and order.json != STANDARD_OUTPUT and order.json.resolve() in taken:
        raise SettingsError(f"--json {order.json} would overwrite an input file: name another file.")
    twice = _twice(order.logs)
    if twice is not None:
        raise SettingsError(f"{twice} is named twice: name each log once.")


def _twice(logs: Sequence[Path]) -> Path | None:
    seen: set[Path] = set()
    for log in logs:
        if log.resolve() in seen:
            return log
        seen.add(log.resolve())
    return None
