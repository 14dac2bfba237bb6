"""Run the body of a test repeatedly; each run is an episode with fresh function-scoped fixtures.

An episode is pytest's own run of an item: setup, call and teardown, each with a report. It differs in two ways: the
reports are not logged, and only function-scoped fixtures are torn down. Fixtures of wider scope live until the item is
finished.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import FrameType
from typing import Any

import pytest
from _pytest.runner import runtestprotocol

from pytest_tarl.designation import Designation
from pytest_tarl.errors import NodeError, SimulatorLostError, StuckNodeError, TarlError, first_line
from pytest_tarl.item_episode import EPISODE, NOTHING, Episode, Instruments
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending

LIMIT = pytest.StashKey[Any]()  # pytest-timeout's settings for an item
SIMULATORS = 3  # maximum number of runs of an episode if its simulator is lost
INTERRUPTS = (pytest.exit.Exception, KeyboardInterrupt)  # exceptions that end the whole run


@dataclass(frozen=True)
class ItemRollout:
    """Run episodes of one pytest item in this process."""

    item: pytest.Function
    designation: Designation
    instruments: Instruments
    workers = 1

    def begin(self, plan: EpisodePlan) -> Pending:
        """Return an episode that runs when its result is requested."""
        return Deferred(self, plan)

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run an episode; if its simulator is lost, run it again, up to SIMULATORS times in total.

        Raise TarlError if the test cannot run as planned, and pytest's Exit on Ctrl-C.
        """
        lost: list[str] = []
        while isinstance(run := self._tried(plan), SimulatorLostError):
            lost.append(run.why)
            if len(lost) == SIMULATORS:
                raise SimulatorLostError(_given_up(run, plan, lost)) from run
        return replace(run, lost=tuple(lost))

    def _tried(self, plan: EpisodePlan) -> EpisodeRun | SimulatorLostError:
        """Run an episode once; return the error if its simulator is lost."""
        try:
            return self._once(plan)
        except SimulatorLostError as problem:
            return problem

    def _once(self, plan: EpisodePlan) -> EpisodeRun:
        episode = Episode(plan, self.designation, self.instruments if plan.record else NOTHING)
        self.item.stash[EPISODE] = episode
        self.item._report_sections.clear()  # otherwise the captured output of all episodes would accumulate
        _forget_instance(self.item)
        try:
            # passing the item's own parent as next item keeps all fixtures of wider scope
            with _heeding_interrupts(), _limited(self.item):
                reports = runtestprotocol(self.item, log=False, nextitem=self.item.parent)  # type: ignore[arg-type]
        finally:
            del self.item.stash[EPISODE]
        return _outcome(episode, reports)


def _given_up(problem: SimulatorLostError, plan: EpisodePlan, lost: Sequence[str]) -> str:
    """Return the message for an episode that lost its simulator in every run."""
    earlier = "; ".join(dict.fromkeys(lost[:-1]))
    return (
        f"{problem} TARL ran the episode with seed {plan.seed} {len(lost)} times, each time with a new simulator, and "
        f"gave up. Before: {earlier}."
    )


def _forget_instance(item: pytest.Function) -> None:
    """Make a test method create a new instance of its class in each episode."""
    if item.cls is not None:
        for name in ("_instance", "_obj"):  # pytest creates these attributes again when they are read
            vars(item).pop(name, None)


@dataclass(frozen=True)
class BesideRollout(ItemRollout):
    """Run episodes of another item while an item runs; fixtures that they do not share are set up again."""

    at_work: pytest.Function

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode of the other item."""
        state = self.item.session._setupstate
        state.teardown_exact(self.item)
        try:
            return ItemRollout.__call__(self, plan)
        finally:
            state.teardown_exact(self.at_work)


def defer_limit(item: pytest.Item, settings: Any) -> bool | None:
    """Apply pytest-timeout's limit to each episode instead of to the whole item.

    While an episode is running, return None, so that pytest-timeout sets its timer.
    """
    if EPISODE in item.stash:
        return None
    item.stash[LIMIT] = settings
    return True


@contextmanager
def _limited(item: pytest.Function) -> Iterator[None]:
    """Apply pytest-timeout's limit to one episode."""
    settings = item.stash.get(LIMIT, None)
    if settings is None:
        yield
        return
    item.ihook.pytest_timeout_set_timer(item=item, settings=settings)
    try:
        yield
    finally:
        item.ihook.pytest_timeout_cancel_timer(item=item)


@contextmanager
def _heeding_interrupts() -> Iterator[None]:
    """End the run on Ctrl-C even if a node catches KeyboardInterrupt, as many main functions do."""
    before = signal.getsignal(signal.SIGINT)
    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield  # SIGINT is ignored here, as in a background job, so leave the handler alone
        return
    seen = []
    passed_on = before

    def interrupted(number: int, frame: FrameType | None) -> None:
        seen.append(number)
        passed_on(number, frame)

    signal.signal(signal.SIGINT, interrupted)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if seen:
        raise KeyboardInterrupt


def finish(item: pytest.Function, nextitem: pytest.Item | None) -> pytest.TestReport:
    """After the last episode, tear down the fixtures that the next item does not need."""
    # do not call pytest's hooks: plugins expect one teardown per item, and the last episode has already called the
    # teardown hooks, perhaps in another process
    state = item.session._setupstate
    call = pytest.CallInfo.from_call(
        lambda: state.teardown_exact(nextitem), when="teardown", reraise=INTERRUPTS
    )
    return pytest.TestReport.from_item_and_call(item, call)


def _outcome(episode: Episode, reports: list[pytest.TestReport]) -> EpisodeRun:
    if isinstance(episode.error, TarlError) and not isinstance(episode.error, NodeError):
        raise episode.error
    mission = isinstance(episode.error, (AssertionError, pytest.fail.Exception, NodeError))
    ended = episode.error is None or isinstance(episode.error, AssertionError)
    if episode.problem is not None and ended:
        raise episode.problem
    skipped = next((report for report in reports if report.skipped and not _expected(report)), None)
    if skipped is not None and not episode.replayed:
        pytest.skip(_reason(skipped))
    failed = [report for report in reports if _expected(report) or (report.failed and not _surprise(report))]
    broken = [report for report in failed if report.when != "call" or not mission]
    if episode.trace is None:
        lost = "\n".join(report.longreprtext for report in broken)
        raise TarlError(
            lost or "The test ended without its fixture `tarl`: remove the default value of the argument."
        )
    return EpisodeRun(
        plan=episode.plan,
        trace=episode.trace,
        passed=not failed,
        failure=first_line(episode.error) if failed and mission else "",
        broken="\n".join(report.longreprtext for report in broken),
        topics=episode.topics,
        crashed=isinstance(episode.error, NodeError),
        stuck=isinstance(episode.error, StuckNodeError) or _timed_out(episode.error),
        notes=episode.notes,
        values=episode.values,
        judged=episode.judged,
        older=episode.older,
        simulator=episode.simulator,
        outputs=episode.outputs,
        parameters=episode.parameters,
        silent=episode.silent if ended else "",  # if the node had an error, that explains the silence
    )


def _timed_out(error: BaseException | None) -> bool:
    """Return whether pytest-timeout ended the episode, which it does with `pytest.fail`."""
    return isinstance(error, pytest.fail.Exception) and str(error).startswith("Timeout (>")


def _expected(report: pytest.TestReport) -> bool:
    """Return whether an xfail mark expected the failure of a mission, which then counts as failed."""
    return report.skipped and report.when == "call" and hasattr(report, "wasxfail")


def _surprise(report: pytest.TestReport) -> bool:
    """Return whether a mission failed only because of a strict xfail mark, without an exception."""
    return report.when == "call" and isinstance(report.longrepr, str) and report.longrepr.startswith("[XPASS")


def _reason(report: pytest.TestReport) -> str:
    """Return the reason given by a skipped test."""
    return str(report.longrepr[2]) if isinstance(report.longrepr, tuple) else report.longreprtext
