"""The episode of a pytest item: its plan, its fixtures `tarl` and `tarl_drift`, and its outcome.

In a plain run of the test, the item is one episode; `repeating.py` runs an item as many episodes.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from pytest_tarl import ini
from pytest_tarl.designation import Designation, designation
from pytest_tarl.errors import NodeError, RequirementError, SettingsError, TarlError
from pytest_tarl.formula_calls import said
from pytest_tarl.printable import printable
from pytest_tarl.rollout import EpisodePlan
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
    """The nodes' sites (statements to record): positions by file, and the numbers of those that publish."""

    positions: Mapping[Path, Positions] = field(default_factory=dict)
    publishes: frozenset[int] = frozenset()


NOTHING = Instruments()


@dataclass
class Episode:
    """An episode of an item: its plan and, after it has run, its outcome."""

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
    older: tuple[Path, ...] = ()  # files of the overlay whose old text was run
    simulator: bool = False  # whether the world was an external simulator
    outputs: Mapping[str, Sequence[float]] = field(default_factory=dict)
    parameters: Mapping[str, bool | int | float] = field(default_factory=dict)
    silent: str = ""  # which sensor or node was silent in the whole episode


EPISODE = pytest.StashKey[Episode]()


def designated(item: pytest.Item) -> Designation | None:
    """Return the item's checked marker; None if it has none. Raise SettingsError if the marker is invalid."""
    marker = item.get_closest_marker("tarl")
    if marker is None:
        return None
    marked = designation(item.nodeid, marker.args, marker.kwargs, said(item.nodeid, item.config.rootpath))
    purpose = _first_paragraph(inspect.getdoc(getattr(item, "function", None)))
    return replace(marked, purpose=purpose, nodes=node_files(marked.nodes, item.path.parent, item.nodeid))


def _first_paragraph(docstring: str | None) -> str:
    """Return a docstring's first paragraph on one line; empty without a docstring."""
    return " ".join((docstring or "").strip().partition("\n\n")[0].split())


@contextmanager
def opened(item: pytest.Item) -> Iterator[Tarl]:
    """Open the item's episode and yield the fixture; on exit, close the episode and store its trace."""
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
        changed=bool(episode.plan.overlay),
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
            episode.outputs, episode.parameters = outputs.sums, tarl.parameters_read
            episode.problem, episode.silent = tarl.problem(), tarl.silence()
            episode.replayed = replay is not None and replay.done
            episode.simulator = tarl.simulator is not None
        finally:
            tarl.close()
            episode.notes, episode.older = tarl.notes(), imports.older


def _launch_files_replaced(data: Mapping[Path, str]) -> AbstractContextManager[None]:
    """Return a context that reads launch and parameter files again if the overlay replaces data files."""
    if not data:
        return nullcontext()
    from pytest_tarl.ros.launched import texts_replaced

    return texts_replaced()


def _faults(episode: Episode) -> Faults:
    """Return all faults declared by the test, and those active in this episode."""
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
    """Return the drift value in the item's episode; without a scenario, the design's value or None."""
    from pytest_tarl import design

    episode = _episode(item)
    path = design.fixture_path(item.config.rootpath, without_drift(item))
    drifts, plan = episode.designation.drifts, episode.plan
    return design.value(drifts, design.adopted(path) if drifts else (), plan.drift, plan.seed, plan.point)


def keep_error(item: pytest.Item, error: BaseException, report: pytest.TestReport) -> None:
    """Store the error that ended a phase; show user-facing errors in the report without a traceback."""
    if EPISODE in item.stash and item.stash[EPISODE].error is None:
        item.stash[EPISODE].error = error
    if isinstance(error, (TarlError, RequirementError)) and report.failed:
        from pytest_tarl.ros.exception_texts import account

        report.longrepr = printable(account(error, item.path))


def add_notes(item: pytest.Item, report: pytest.TestReport) -> None:
    """Add how nodes were started to the report of a failed plain run; other runs show it in their summary."""
    episode = getattr(item, "funcargs", {}).get("tarl")
    if episode is not None and EPISODE not in item.stash and report.failed and report.when == "call":
        notes = [f"note: {one}" for one in dict.fromkeys(episode.starting_notes)]
        if notes:
            report.sections.append(("TARL", "\n".join(notes)))


def in_the_node(excinfo: pytest.ExceptionInfo[BaseException]) -> pytest.ExceptionInfo[BaseException]:
    """Return the node's exception that caused a NodeError, so that a debugger stops in the node's code."""
    from pytest_tarl.ros.exception_texts import of_node

    cause = excinfo.value.__cause__
    if not isinstance(excinfo.value, NodeError) or cause is None or cause.__traceback__ is None:
        return excinfo
    cause.__traceback__ = of_node(cause.__traceback__)
    return pytest.ExceptionInfo.from_exc_info((type(cause), cause, cause.__traceback__))


def _episode(item: pytest.Item) -> Episode:
    """Return the episode prepared for the item; in a plain test run, create one."""
    if EPISODE in item.stash:
        return item.stash[EPISODE]
    marked = designated(item)
    if marked is None:
        raise SettingsError(
            f"{item.nodeid} uses the fixture `tarl` without the marker: add @pytest.mark.tarl(nodes=[…], sensors=[…])."
        )
    seed = episode_seed(ini.value_of(item.config, "seed"), "offline", 0)
    return Episode(EpisodePlan(seed), marked)
