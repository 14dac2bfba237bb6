"""Run the body of a test as one episode, as often as asked, with fresh function-scoped fixtures each time.

One pass is pytest's own run of an item (set-up, call, teardown, each with its report), except that the reports are not
logged and that only the item's own fixtures are torn down: wider-scoped ones live until the item is done.
"""

from __future__ import annotations

import inspect
import signal
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

import pytest
from _pytest.runner import runtestprotocol

from pytest_tarl import ini
from pytest_tarl.designation import Designation, designation
from pytest_tarl.errors import NodeError, RequirementError, SettingsError, StuckNodeError, TarlError
from pytest_tarl.formula_calls import said
from pytest_tarl.printable import printable
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending
from pytest_tarl.scenarios import without_drift
from pytest_tarl.seeds import episode_seed

if TYPE_CHECKING:
    from pytest_tarl.bags.replay import Replay
    from pytest_tarl.episode import Tarl
    from pytest_tarl.formulas.judging import Judged
    from pytest_tarl.instrumentation.sites import Positions
    from pytest_tarl.instrumentation.trace import Trace


@dataclass(frozen=True)
class Instruments:
    """What is recorded of the nodes: by file the position of every site, and the sites that publish."""

    positions: Mapping[Path, Positions] = field(default_factory=dict)
    publishes: frozenset[int] = frozenset()


NOTHING = Instruments()


@dataclass
class Episode:
    """The episode that an item is about to run or has run: plan in, outcome out."""

    plan: EpisodePlan
    designation: Designation
    instruments: Instruments = NOTHING
    error: BaseException | None = None
    problem: TarlError | None = None  # why it cannot be learned from
    trace: Trace | None = None
    topics: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    replayed: bool = False  # a bag, to its end
    judged: tuple[Judged, ...] = ()
    older: tuple[Path, ...] = ()  # edited files that ran as they were before


EPISODE = pytest.StashKey[Episode]()
LIMIT = pytest.StashKey[Any]()  # the settings of pytest-timeout for an item
INTERRUPTS = (pytest.exit.Exception, KeyboardInterrupt)  # what ends the whole run


def designated(item: pytest.Item) -> Designation | None:
    """Return the item's marker, checked; None without one. Raises SettingsError."""
    marker = item.get_closest_marker("tarl")
    if marker is None:
        return None
    marked = designation(item.nodeid, marker.args, marker.kwargs, said(item.nodeid, item.config.rootpath))
    return replace(marked, purpose=_first_paragraph(inspect.getdoc(getattr(item, "function", None))))


def _first_paragraph(docstring: str | None) -> str:
    """Return the first paragraph of a docstring in one line, empty without one."""
    return " ".join((docstring or "").strip().partition("\n\n")[0].split())


@contextmanager
def opened(item: pytest.Item) -> Iterator[Tarl]:
    """Open the item's episode, close it afterwards and keep its trace."""
    from pytest_tarl.episode import Tarl
    from pytest_tarl.instrumentation.datafiles import is_data, reading
    from pytest_tarl.instrumentation.importhook import NodeImports
    from pytest_tarl.instrumentation.recorder import Recorder
    from pytest_tarl.realros.choice import check_kind

    episode = _episode(item)
    recorder = Recorder()
    imports = NodeImports(
        item.config.rootpath,
        episode.instruments.positions,
        recorder.hook,
        {path: text for path, text in episode.plan.overlay.items() if not is_data(path)},
        publishes=episode.instruments.publishes,
        bind=recorder.bind,
    )
    replay = _replay(episode)
    kind = check_kind(ini.value_of(item.config, "ros"))
    tarl = Tarl(
        episode.plan.seed,
        episode.designation.sensors,
        item.path.parent,
        recorder,
        imports,
        kind="embedded" if replay else kind,
        nodes=episode.designation.nodes,
        replay=replay,
        requirements=episode.designation.requirements,
        alone=EPISODE not in item.stash,
    )
    data = {path: text for path, text in episode.plan.overlay.items() if is_data(path)}
    try:
        with reading(data):
            yield tarl
    finally:
        try:
            episode.trace = tarl.rewarded(recorder.finish())
            episode.judged = tarl.judged
            episode.topics, episode.values = dict(tarl.topics), tarl.values
            episode.problem = tarl.problem()
            episode.replayed = replay is not None and replay.done
        finally:
            tarl.close()
            episode.notes, episode.older = tarl.notes(), imports.older


def _replay(episode: Episode) -> Replay | None:
    """Return the recorded mission that takes the place of the world, if there is one."""
    if episode.plan.bag is None:
        return None
    from pytest_tarl.bags.reading import opened as opened_bag
    from pytest_tarl.bags.replay import Replay

    marked = episode.designation
    return Replay(
        opened_bag(episode.plan.bag),
        marked.sensors,
        marked.monitor,
        marked.judge,
        requirements=marked.requirements,
    )


def drift_value(item: pytest.Item) -> Any:
    """Return the value of the scenario that the item's episode runs under; off-line that of the design, or None."""
    from pytest_tarl import design

    episode = _episode(item)
    path = design.fixture_path(item.config.rootpath, without_drift(item))
    drifts, plan = episode.designation.drifts, episode.plan
    return design.value(drifts, design.adopted(path) if drifts else (), plan.drift, plan.seed)


def keep_error(item: pytest.Item, error: BaseException, report: pytest.TestReport) -> None:
    """Keep what ended a phase; a user's mistake becomes a sentence in the report."""
    if EPISODE in item.stash and item.stash[EPISODE].error is None:
        item.stash[EPISODE].error = error
    if isinstance(error, (TarlError, RequirementError)) and report.failed:
        from pytest_tarl.ros.accounts import account

        report.longrepr = printable(account(error, item.path))


def in_the_node(excinfo: pytest.ExceptionInfo[BaseException]) -> pytest.ExceptionInfo[BaseException]:
    """Return the exception of a node in place of what the test got, so that a debugger stops in the node."""
    from pytest_tarl.ros.accounts import of_node

    cause = excinfo.value.__cause__
    if not isinstance(excinfo.value, NodeError) or cause is None or cause.__traceback__ is None:
        return excinfo
    cause.__traceback__ = of_node(cause.__traceback__)
    return pytest.ExceptionInfo.from_exc_info((type(cause), cause, cause.__traceback__))


def _episode(item: pytest.Item) -> Episode:
    """Return the episode that is set up for the item, or the one of a plain test run."""
    if EPISODE in item.stash:
        return item.stash[EPISODE]
    marked = designated(item)
    if marked is None:
        raise SettingsError(
            f"{item.nodeid} uses the fixture `tarl` without the marker: add @pytest.mark.tarl(nodes=[…], sensors=[…])."
        )
    seed = episode_seed(ini.value_of(item.config, "seed"), "offline", 0)
    return Episode(EpisodePlan(seed), marked)


@dataclass(frozen=True)
class ItemRollout:
    """Runs episodes of one pytest item, here and now."""

    item: pytest.Function
    designation: Designation
    instruments: Instruments
    workers = 1

    def begin(self, plan: EpisodePlan) -> Pending:
        """Ask for an episode, to be run when its result is."""
        return Deferred(self, plan)

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode. Raises TarlError where the test cannot be run as asked, pytest's Exit on Ctrl-C."""
        episode = Episode(plan, self.designation, self.instruments if plan.record else NOTHING)
        self.item.stash[EPISODE] = episode
        self.item._report_sections.clear()  # else the output of all episodes would be kept, and shown
        _forget_instance(self.item)
        try:
            # An item's parent keeps all that is wider than the item itself; pytest asks it for no more than that.
            with _heeding_interrupts(), _limited(self.item):
                reports = runtestprotocol(self.item, log=False, nextitem=self.item.parent)  # type: ignore[arg-type]
        finally:
            del self.item.stash[EPISODE]
        return _outcome(episode, reports)


def _forget_instance(item: pytest.Function) -> None:
    """Let the method of a class have an object of its own in each episode, as every test has."""
    if item.cls is not None:
        for name in ("_instance", "_obj"):  # pytest makes them anew when they are asked for
            vars(item).pop(name, None)


@dataclass(frozen=True)
class BesideRollout(ItemRollout):
    """Runs episodes of another item while one is at work: what the two do not share is set up anew."""

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
    """Keep a limit that pytest-timeout is about to set, for each episode anew; None where one is running."""
    if EPISODE in item.stash:
        return None
    item.stash[LIMIT] = settings
    return True


@contextmanager
def _limited(item: pytest.Function) -> Iterator[None]:
    """Give one episode the time that pytest-timeout gives a test."""
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
    """End the run on Ctrl-C even where a node catches it, as the main part of many does."""
    before = signal.getsignal(signal.SIGINT)
    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield  # who ignores it, as a job in the background does, goes on doing so
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
    """Tear down what the next item does not need, once the last episode has run."""
    # Not through pytest's hooks: the item itself was torn down after its last episode, perhaps in another process, and
    # plugins count on that.
    state = item.session._setupstate
    call = pytest.CallInfo.from_call(
        lambda: state.teardown_exact(nextitem), when="teardown", reraise=INTERRUPTS
    )
    return pytest.TestReport.from_item_and_call(item, call)


def _outcome(episode: Episode, reports: list[pytest.TestReport]) -> EpisodeRun:
    if isinstance(episode.error, TarlError) and not isinstance(episode.error, NodeError):
        raise episode.error
    mission = isinstance(episode.error, (AssertionError, pytest.fail.Exception, NodeError))
    if episode.problem is not None and (episode.error is None or isinstance(episode.error, AssertionError)):
        raise episode.problem
    skipped = next((report for report in reports if report.skipped and not _expected(report)), None)
    if skipped is not None and not episode.replayed:
        pytest.skip(_reason(skipped))
    failed = [report for report in reports if _expected(report) or (report.failed and not _surprise(report))]
    broken = [report for report in failed if report.when != "call" or not mission]
    if episode.trace is None:
        lost = "\n".join(report.longreprtext for report in broken)
        raise TarlError(lost or "The test does not use the fixture `tarl`: take it as an argument.")
    return EpisodeRun(
        plan=episode.plan,
        trace=episode.trace,
        passed=not failed,
        failure=_first_line(episode.error) if failed and mission else "",
        broken="\n".join(report.longreprtext for report in broken),
        topics=episode.topics,
        crashed=isinstance(episode.error, NodeError),
        stuck=isinstance(episode.error, StuckNodeError) or _timed_out(episode.error),
        notes=episode.notes,
        values=episode.values,
        judged=episode.judged,
        older=episode.older,
    )


def _timed_out(error: BaseException | None) -> bool:
    """Tell whether pytest-timeout ended the episode; it fails a test as `pytest.fail` does."""
    return isinstance(error, pytest.fail.Exception) and str(error).startswith("Timeout (>")


def _expected(report: pytest.TestReport) -> bool:
    """Tell whether a mission failed under an xfail mark: a failed mission all the same."""
    return report.skipped and report.when == "call" and hasattr(report, "wasxfail")


def _surprise(report: pytest.TestReport) -> bool:
    """Tell whether a mission succeeded that a strict xfail mark expected to fail: nothing was raised."""
    return report.when == "call" and isinstance(report.longrepr, str) and report.longrepr.startswith("[XPASS")


def _reason(report: pytest.TestReport) -> str:
    """Return why a test skipped itself."""
    return str(report.longrepr[2]) if isinstance(report.longrepr, tuple) else report.longreprtext


def _first_line(error: BaseException | None) -> str:
    text = str(error).strip()
    return text.splitlines()[0] if text else type(error).__name__
