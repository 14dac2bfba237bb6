"""Run the body of a test repeatedly; each run is an episode with fresh function-scoped fixtures.

An episode is pytest's own run of an item (setup, call and teardown, each with its report), except that the reports are
not logged and only function-scoped fixtures are torn down: fixtures of wider scope live until the item is finished.
"""

from __future__ import annotations

import inspect
import signal
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

import pytest
from _pytest.runner import runtestprotocol

from pytest_tarl import ini
from pytest_tarl.designation import Designation, designation
from pytest_tarl.errors import (
    NodeError,
    RequirementError,
    SettingsError,
    SimulatorLostError,
    StuckNodeError,
    TarlError,
    first_line,
)
from pytest_tarl.formula_calls import said
from pytest_tarl.printable import printable
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending
from pytest_tarl.scenarios import without_drift
from pytest_tarl.seeds import episode_seed
from pytest_tarl.starting import node_files

if TYPE_CHECKING:
    from pytest_tarl.bags.replay import Replay
    from pytest_tarl.episode import Tarl
    from pytest_tarl.faults.installing import Faults
    from pytest_tarl.formulas.judging import Judged
    from pytest_tarl.instrumentation.sites import Positions
    from pytest_tarl.instrumentation.trace import Trace


@dataclass(frozen=True)
class Instruments:
    """The sites (statements to record) in the nodes: their positions by file, and the numbers of those that publish."""

    positions: Mapping[Path, Positions] = field(default_factory=dict)
    publishes: frozenset[int] = frozenset()


NOTHING = Instruments()


@dataclass
class Episode:
    """An episode of an item: its plan, and its outcome once it has run."""

    plan: EpisodePlan
    designation: Designation
    instruments: Instruments = NOTHING
    error: BaseException | None = None
    problem: TarlError | None = None  # why the episode is unusable
    trace: Trace | None = None
    topics: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    replayed: bool = False  # whether a bag was replayed to its end
    judged: tuple[Judged, ...] = ()
    older: tuple[Path, ...] = ()  # files of the overlay for which the episode ran the old text
    simulator: bool = False  # whether an external simulator was the episode's world
    outputs: Mapping[str, Sequence[float]] = field(default_factory=dict)


EPISODE = pytest.StashKey[Episode]()
LIMIT = pytest.StashKey[Any]()  # pytest-timeout's settings for an item
SIMULATORS = 3  # maximum number of runs of an episode whose simulator is lost
INTERRUPTS = (pytest.exit.Exception, KeyboardInterrupt)  # exceptions that end the whole run


def designated(item: pytest.Item) -> Designation | None:
    """Return the item's checked marker, or None if it has none. Raise SettingsError if the marker is invalid."""
    marker = item.get_closest_marker("tarl")
    if marker is None:
        return None
    marked = designation(item.nodeid, marker.args, marker.kwargs, said(item.nodeid, item.config.rootpath))
    purpose = _first_paragraph(inspect.getdoc(getattr(item, "function", None)))
    return replace(marked, purpose=purpose, nodes=node_files(marked.nodes, item.path.parent, item.nodeid))


def _first_paragraph(docstring: str | None) -> str:
    """Return the first paragraph of a docstring in one line; empty if there is no docstring."""
    return " ".join((docstring or "").strip().partition("\n\n")[0].split())


@contextmanager
def opened(item: pytest.Item) -> Iterator[Tarl]:
    """Open the item's episode and yield the fixture; on exit, close the episode and keep its trace."""
    from pytest_tarl.episode import Tarl
    from pytest_tarl.instrumentation.datafiles import is_data, reading
    from pytest_tarl.instrumentation.importhook import NodeImports
    from pytest_tarl.instrumentation.recorder import Recorder
    from pytest_tarl.outputs import Outputs
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
    replay, outputs = _replay(episode), Outputs()
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
        faults=_faults(episode),
        drifted=episode.plan.drift is not None and not ini.value_of(item.config, "record"),
        outputs=outputs if episode.plan.outputs else None,
    )
    data = {path: text for path, text in episode.plan.overlay.items() if is_data(path)}
    try:
        with reading(data), _launch_files_replaced(data):
            yield tarl
    finally:
        try:
            episode.trace = tarl.rewarded(recorder.finish(signed=episode.plan.signed))
            episode.judged = tarl.judged
            episode.topics, episode.values = dict(tarl.topics), tarl.values
            episode.outputs = outputs.sums
            episode.problem = tarl.problem()
            episode.replayed = replay is not None and replay.done
            episode.simulator = tarl.simulator is not None
        finally:
            tarl.close()
            episode.notes, episode.older = tarl.notes(), imports.older


def _launch_files_replaced(data: Mapping[Path, str]) -> AbstractContextManager[None]:
    """Return a context that re-reads the parameters of launch files if the overlay replaces data files."""
    if not data:
        return nullcontext()
    from pytest_tarl.ros.launched import texts_replaced

    return texts_replaced()


def _faults(episode: Episode) -> Faults:
    """Return all faults that the test declares, and the active ones of this episode."""
    from pytest_tarl import design
    from pytest_tarl.faults.installing import Faults

    drifts, plan = episode.designation.drifts, episode.plan
    declared = {name: one for space in design.spaces(drifts).values() for name, one in space.faults.items()}
    return Faults(declared, design.faults(drifts, plan.drift, plan.seed, plan.point), plan.seed)


def _replay(episode: Episode) -> Replay | None:
    """Return the recorded mission that replaces the world, or None."""
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
    """Return the value of the drift scenario in the item's episode; without a scenario, the design's value or None."""
    from pytest_tarl import design

    episode = _episode(item)
    path = design.fixture_path(item.config.rootpath, without_drift(item))
    drifts, plan = episode.designation.drifts, episode.plan
    return design.value(drifts, design.adopted(path) if drifts else (), plan.drift, plan.seed, plan.point)


def keep_error(item: pytest.Item, error: BaseException, report: pytest.TestReport) -> None:
    """Keep the error that ended a phase; show user-facing errors in the report without their traceback."""
    if EPISODE in item.stash and item.stash[EPISODE].error is None:
        item.stash[EPISODE].error = error
    if isinstance(error, (TarlError, RequirementError)) and report.failed:
        from pytest_tarl.ros.accounts import account

        report.longrepr = printable(account(error, item.path))


def in_the_node(excinfo: pytest.ExceptionInfo[BaseException]) -> pytest.ExceptionInfo[BaseException]:
    """Return the node's exception that caused a NodeError, so that a debugger stops in the node's code."""
    from pytest_tarl.ros.accounts import of_node

    cause = excinfo.value.__cause__
    if not isinstance(excinfo.value, NodeError) or cause is None or cause.__traceback__ is None:
        return excinfo
    cause.__traceback__ = of_node(cause.__traceback__)
    return pytest.ExceptionInfo.from_exc_info((type(cause), cause, cause.__traceback__))


def _episode(item: pytest.Item) -> Episode:
    """Return the episode that was prepared for the item; in a plain test run, create one."""
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
    """Run episodes of one pytest item in this process."""

    item: pytest.Function
    designation: Designation
    instruments: Instruments
    workers = 1

    def begin(self, plan: EpisodePlan) -> Pending:
        """Return an episode that runs when its result is requested."""
        return Deferred(self, plan)

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode. If its simulator is lost, run it again, at most SIMULATORS times in total.

        Raise TarlError if the test cannot run as planned, pytest's Exit on Ctrl-C.
        """
        for _ in range(SIMULATORS - 1):
            with suppress(SimulatorLostError):
                return self._once(plan)
        return self._once(plan)

    def _once(self, plan: EpisodePlan) -> EpisodeRun:
        episode = Episode(plan, self.designation, self.instruments if plan.record else NOTHING)
        self.item.stash[EPISODE] = episode
        self.item._report_sections.clear()  # otherwise the captured output of all episodes would accumulate
        _forget_instance(self.item)
        try:
            # pass the item's own parent as next item: this keeps all fixtures of wider scope
            with _heeding_interrupts(), _limited(self.item):
                reports = runtestprotocol(self.item, log=False, nextitem=self.item.parent)  # type: ignore[arg-type]
        finally:
            del self.item.stash[EPISODE]
        return _outcome(episode, reports)


def _forget_instance(item: pytest.Function) -> None:
    """Make a test method create a new instance of its class in each episode."""
    if item.cls is not None:
        for name in ("_instance", "_obj"):  # pytest creates these attributes again when they are read
            vars(item).pop(name, None)


@dataclass(frozen=True)
class BesideRollout(ItemRollout):
    """Run episodes of another item while an item runs. Fixtures that the items do not share are set up again."""

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
    """Apply the limit of pytest-timeout to each episode instead of the whole item.

    Return None if an episode is running, so that pytest-timeout sets its timer.
    """
    if EPISODE in item.stash:
        return None
    item.stash[LIMIT] = settings
    return True


@contextmanager
def _limited(item: pytest.Function) -> Iterator[None]:
    """Apply the limit of pytest-timeout to one episode."""
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
        yield  # leave the handler unchanged, since SIGINT is ignored here, as in a background job
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
    # do not call pytest's hooks: plugins expect one teardown per item, and the last episode has called the hooks for
    # it, perhaps in another process
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
        raise TarlError(
            lost or "The test ended without its fixture `tarl`: do not give the argument a default."
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
    )


def _timed_out(error: BaseException | None) -> bool:
    """Return whether pytest-timeout ended the episode; it calls `pytest.fail`."""
    return isinstance(error, pytest.fail.Exception) and str(error).startswith("Timeout (>")


def _expected(report: pytest.TestReport) -> bool:
    """Return whether a mission failed that has an xfail mark; such a mission counts as failed."""
    return report.skipped and report.when == "call" and hasattr(report, "wasxfail")


def _surprise(report: pytest.TestReport) -> bool:
    """Return whether a mission failed only because of a strict xfail mark; the test itself raised no exception."""
    return report.when == "call" and isinstance(report.longrepr, str) and report.longrepr.startswith("[XPASS")


def _reason(report: pytest.TestReport) -> str:
    """Return the reason that a skipped test gave."""
    return str(report.longrepr[2]) if isinstance(report.longrepr, tuple) else report.longreprtext
