"""Ctrl-C during an episode, and the limit of CPU time of a process whose interpreter is held."""

from __future__ import annotations

import faulthandler
import os
import signal
import threading
from collections.abc import Iterator
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import held_interpreter
from pytest_tarl.repeating import EPISODE, LIMIT, _heeding_interrupts, _limited, defer_limit


@pytest.fixture
def default() -> Iterator[Any]:
    """Handle Ctrl-C as Python does, whatever this run does."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield signal.default_int_handler
    signal.signal(signal.SIGINT, before)


def test_caught_interrupt_still_ends_the_run(default: Any) -> None:
    after = []

    def episode() -> None:
        with _heeding_interrupts():
            with suppress(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
            after.append("the node goes on")

    with pytest.raises(KeyboardInterrupt):
        episode()
    assert after
    assert signal.getsignal(signal.SIGINT) is default


def test_without_an_interrupt_the_handler_is_restored(default: Any) -> None:
    with _heeding_interrupts():
        assert signal.getsignal(signal.SIGINT) is not default
    assert signal.getsignal(signal.SIGINT) is default


def test_handler_stays_if_interrupts_are_ignored(default: Any) -> None:
    def inside() -> None:
        with _heeding_interrupts():
            found.append(signal.getsignal(signal.SIGINT))

    found: list[Any] = []
    other = threading.Thread(target=inside)
    other.start()
    other.join()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    inside()
    assert found == [default, signal.SIG_IGN]
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_item_limit_applies_to_each_episode() -> None:
    told: list[tuple[str, Any]] = []
    hook = SimpleNamespace(
        pytest_timeout_set_timer=lambda item, settings: told.append(("set", settings)),
        pytest_timeout_cancel_timer=lambda item: told.append(("cancelled", None)),
    )
    item: Any = SimpleNamespace(stash=pytest.Stash(), ihook=hook)
    with _limited(item):
        pass
    assert told == []
    assert defer_limit(item, "5 s") is True
    assert item.stash[LIMIT] == "5 s"
    for _ in range(2):
        with suppress(ValueError), _limited(item):
            assert told.pop() == ("set", "5 s")
            raise ValueError
        assert told.pop() == ("cancelled", None)
    item.stash[EPISODE] = "running"
    assert defer_limit(item, "9 s") is None
    assert item.stash[LIMIT] == "5 s"


class System:
    """Records the calls of the functions that set the limit."""

    def __init__(self, patch: pytest.MonkeyPatch, handler: Any, stderr: int | None) -> None:
        self.timers: list[float] = []
        self.registered: list[dict[str, Any]] = []
        patch.setattr(held_interpreter, "_registered", False)
        patch.setattr(held_interpreter, "_stderr", stderr)
        patch.setattr(held_interpreter, "SIGNAL", 26)
        patch.setattr(signal, "getsignal", lambda _: handler)
        patch.setattr(signal, "setitimer", lambda which, seconds: self.timers.append(seconds))
        patch.setattr(faulthandler, "register", lambda number, **how: self.registered.append(how))


def test_cpu_limit_is_set_when_given(monkeypatch: pytest.MonkeyPatch) -> None:
    system = System(monkeypatch, signal.SIG_DFL, stderr=7)
    held_interpreter.allow(0.0)
    assert (system.timers, system.registered) == ([], [])
    for seconds in (5.0, 0.0, 6.0):
        held_interpreter.allow(seconds)
    assert system.timers == [5.0, 0.0, 6.0]
    assert system.registered == [{"file": 7, "all_threads": True, "chain": True}]


@pytest.mark.parametrize(("handler", "stderr"), [(signal.SIG_IGN, 7), (print, 7), (signal.SIG_DFL, None)])
def test_cpu_limit_needs_standard_error_and_free_signals(
    handler: Any, stderr: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(_: int) -> int:
        raise OSError

    system = System(monkeypatch, handler, stderr)
    monkeypatch.setattr(os, "dup", none)
    held_interpreter.allow(5.0)
    assert (system.timers, system.registered) == ([], [])


def test_standard_error_is_duplicated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(held_interpreter, "_stderr", None)
    handles = iter([11, 12])
    monkeypatch.setattr(os, "dup", lambda number: next(handles) if number == 2 else -1)
    held_interpreter.prepare()
    held_interpreter.prepare()
    assert held_interpreter._stderr == 11
