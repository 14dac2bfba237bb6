"""Run one designated test in one mode: analyse it, record or compare, write files below `.tarl`, and report."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from pytest_tarl.accounts import Account, Compared
from pytest_tarl.analysed import analysed, instruments, passed_with_imports
from pytest_tarl.boundary_repairs import Job, repair_boundary
from pytest_tarl.comparing import run_online
from pytest_tarl.design import AS_WRITTEN, fixture_path
from pytest_tarl.designation import Designation
from pytest_tarl.errors import FixtureError, SettingsError
from pytest_tarl.files import slug
from pytest_tarl.instrumentation.sites import Plan, plan
from pytest_tarl.item_episode import Instruments
from pytest_tarl.learning import fixture as fixtures
from pytest_tarl.learning.binning import learned_edges
from pytest_tarl.learning.drift import tolerated
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.spending import Stage
from pytest_tarl.lost_simulators import LostSimulators, RolloutWith
from pytest_tarl.modules_of_tests import Digests, digests, remark
from pytest_tarl.options import Options
from pytest_tarl.other_recordings import adopted, lost_design, unchecked
from pytest_tarl.recording import Progress, Tell, read_values, record
from pytest_tarl.repairing.repair import repair
from pytest_tarl.repairing.request import Neighbour, Order
from pytest_tarl.report import guarantee_words
from pytest_tarl.rollout import Rollout
from pytest_tarl.sensors import Sensor, declared, with_edges
from pytest_tarl.stressing.delivering import deliver, deliver_repairs
from pytest_tarl.stressing.failing_statements import source
from pytest_tarl.stressing.stress_run import Request
from pytest_tarl.unrecorded_nodes import silent_files
from tarl_lint.api import Analysis
from tarl_lint.files import write_atomically

EARLIER = "# Commit only the recorded utility.\n*\n!.gitignore\n!utility/\n!utility/**\nutility/.*\n"
IGNORED = (
    "# Commit only the recorded utility and the margins.\n*\n!.gitignore\n"
    "!utility/\n!utility/**\nutility/.*\n!margins/\n!margins/**\nmargins/.*\n"
)


@dataclass(frozen=True)
class Other:
    """Another designated test of the run, that is, one with the marker `tarl`."""

    test: str
    folder: Path
    designation: Designation
    rollout: Rollout


@dataclass(frozen=True)
class Mission:
    """A designated test (one with the marker `tarl`), its location, and how to run it."""

    test: str
    folder: Path
    root: Path
    started: Path  # the folder in which pytest was started
    designation: Designation
    options: Options
    drift: str | None
    width: int
    progress: Progress
    tell: Tell  # prints a sentence at once on a terminal
    others: tuple[Other, ...] = ()
    stage: Stage | None = None  # with --tarl-total, the stage of the comparison that this call runs
    node: str = ""  # pytest's node id, including the scenario

    def run(self, rollout_with: RolloutWith) -> Account | Compared:
        """Run the mode and return its report; a comparison is returned as Compared, whose `told` makes the report.

        Raise TarlError if the test cannot be recorded or compared.
        """
        lost = LostSimulators()
        done = self._run(lost.watched(rollout_with))
        if isinstance(done, Compared):
            return replace(
                done, comparison=replace(done.comparison, notes=(*done.comparison.notes, *lost.notes()))
            )
        return replace(done, lines=(*done.lines, *(f"  {note}" for note in lost.notes())))

    def _run(self, rollout_with: RolloutWith) -> Account | Compared:
        fixture = None if self.options.mode == "record" else self._fixture()
        if fixture is not None and self.options.mode == "stress":
            return self._stress(rollout_with, fixture)
        analysis = self._analysis()
        sites = plan(analysis)
        sensors = self._sensors(rollout_with, fixture)
        rollout = rollout_with(instruments(sites, self.root), sensors)
        self._ignore()
        if fixture is None:
            return replace(self, designation=replace(self.designation, sensors=sensors))._record(
                rollout, sites, analysis
            )
        return self._online(rollout, sites, analysis, fixture)

    @property
    def fixture_path(self) -> Path:
        """Return the path of the test's recording."""
        return fixture_path(self.root, self.test)

    @property
    def target(self) -> str:
        """Return the pytest argument for this test, relative to the folder in which pytest was started."""
        return self._from_start(self.test)

    def _from_start(self, node: str) -> str:
        folder = os.path.relpath(self.root, self.started).replace(os.sep, "/")
        return node if folder == "." else f"{folder}/{node}"

    @property
    def tarl(self) -> Path:
        """Return the folder for all files that TARL writes."""
        return self.root / ".tarl"

    def interrupted(self, done: int, total: int, kept: str) -> str:
        """Return a line about an interrupted run and its recording; `kept` is a sentence on the kept episodes."""
        if self.options.mode != "record":
            return f"Interrupted in episode {done + 1} of {total}. {kept}".rstrip()
        path = self.fixture_path
        left = f"{path.relative_to(self.root)} is unchanged" if path.exists() else "no recording was written"
        return f"Interrupted in episode {done + 1} of {total}: {left}. {kept}".rstrip()

    def _analysis(self) -> Analysis:
        return analysed(self.designation, self.folder, self.root)

    def _sensors(self, rollout_with: RolloutWith, fixture: Fixture | None) -> tuple[Sensor, ...]:
        """Return the sensors with their bins, from the recording or learned from separate episodes."""
        asked = self.designation.sensors
        if fixture is not None:
            return with_edges(asked, {one.name: one.edges for one in fixture.sensors if one.learned})
        if not any(sensor.to_learn for sensor in asked):
            return asked
        read = read_values(
            rollout_with(Instruments(), asked), self.options.seed, self.progress, self._recorded_drift
        )
        return with_edges(asked, learned_edges(asked, read))

    @property
    def _recorded_drift(self) -> str | None:
        """Return the drift of the recorded world. Raise SettingsError if the marker does not declare it permanent."""
        name = self.options.drift if self.options.mode == "record" else None
        if name is None or (name == AS_WRITTEN and name not in self.designation.drifts):
            return name
        declared = self.designation.drifts[name]
        if not declared.permanent:
            raise SettingsError(
                f"--tarl-record makes the drift part of the design, but {name!r} is not permanent: if the world has "
                f'changed for good, declare drifts={{"{name}": Drift({declared.value!r}, permanent=True)}}, with `from '
                "pytest_tarl import Drift`."
            )
        return name

    def _silent(self, analysis: Analysis) -> Iterator[str]:
        """Yield a note for each node file without a recorded statement."""
        files = [(self.folder / node).resolve() for node in self.designation.nodes]
        return silent_files(files, analysis, self.root.resolve(), passed_with_imports)

    def _record(self, rollout: Rollout, sites: Plan, analysis: Analysis) -> Account:
        drift = self._recorded_drift
        result = record(
            rollout,
            self.test,
            self.designation,
            self.options,
            sites,
            self.fixture_path,
            self.progress,
            self.tell,
            drift,
            self._test_side(),
        )
        if result.problem:
            return Account(tuple(f"  {note}" for note in result.notes), result.problem)
        written = self.fixture_path.relative_to(self.root)
        bounds = [f"  {told}" for told in guarantee_words.sentences(result.stated)] if result.stated else []
        lines = [
            f"{self.test}: {result.line}",
            *bounds,
            f"  wrote {written}",
            *adopted(self._designations, self.tarl, self.fixture_path, sites),
        ]
        notes = (*result.notes, *self._silent(analysis))
        return Account((*lines, *(f"  {note}" for note in notes)))

    @property
    def _designations(self) -> dict[str, Designation]:
        """Return the markers of the run's other tests, by test."""
        return {other.test: other.designation for other in self.others}

    def _test_side(self) -> Digests:
        """Return the hash of each definition in the test's modules."""
        return digests(self.test, self.root, [self.folder / node for node in self.designation.nodes])

    def _online(self, rollout: Rollout, sites: Plan, analysis: Analysis, fixture: Fixture) -> Compared:
        online = run_online(
            rollout,
            fixture,
            self.designation,
            self.options,
            sites,
            self.drift,
            self.progress,
            _changeable(analysis),
            self.tell,
            self.stage,
        )
        comparison = online.comparison
        episodes = {"offline": fixture.sample.episodes, "online": online.recorded.sample.episodes}
        interrupted = False
        if self.options.mode == "repair" and "reward" in comparison.verdict.because:
            order = Order(
                rollout,
                analysis,
                self.root,
                fixture,
                online,
                self.options,
                self.progress,
                self.tarl / "patches",
                self.fixture_path,
                self._neighbours,
                self.designation.drifts.get(self.drift or ""),
                self.designation.total_range,
            )
            repaired = repair(order)
            comparison = repaired.comparison
            episodes |= repaired.episodes
            interrupted = repaired.interrupted
        notes = (
            *comparison.notes,
            *remark(fixture.world, self._test_side()),
            *self._silent(analysis),
            *unchecked(comparison.repair, {self.test, *self._designations}, self.tarl),
            *lost_design(self.designation, fixture, self.drift),
        )
        flags = self.options.flags if self.stage is None else self.options.alone(episodes["online"]).flags
        node = self._from_start(self.node) if "[" in self.test else ""
        told = replace(comparison, target=self.target, node=node, flags=flags, notes=notes)
        name = f"{slug(self.test)}-{slug(self.drift or 'online')}"
        return Compared(name, self.root, self.width, told, online, episodes, interrupted)

    def _stress(self, rollout_with: RolloutWith, fixture: Fixture) -> Account:
        sensors = self._sensors(rollout_with, fixture)
        analysis = self._analysis() if self.options.stress_repair else None
        sites = plan(analysis) if analysis is not None else None
        recorded = Instruments() if sites is None else instruments(sites, self.root)
        rollout = rollout_with(recorded, sensors)
        given = source(
            [(self.folder / node).resolve() for node in self.designation.nodes],
            self.root.resolve(),
            lambda positions: rollout_with(Instruments(positions), sensors),
        )
        request = Request(
            rollout, fixture, self.designation, self.options, self.drift or "", self.progress, given
        )
        self._ignore()
        found = deliver(request, self.root)
        if analysis is None or sites is None or found.found is None or found.interrupted:
            return Account(found.lines, found.problem, interrupted=found.interrupted)
        job = Job(
            request,
            analysis,
            sites,
            self.root,
            self.tarl / "patches",
            self.fixture_path,
            self._neighbours,
            _changeable(analysis),
        )
        told = repair_boundary(job, found.found)
        unwritten = deliver_repairs(replace(found.found, repairs=told.attempts), self.root)
        return Account((*found.lines, *told.lines, *unwritten), found.problem, told.patch, told.interrupted)

    def _neighbours(self) -> list[Neighbour]:
        """Return the run's other tests that have a readable recording."""
        found = []
        for other in self.others:
            with suppress(FixtureError):
                path = fixture_path(self.root, other.test)
                if not path.exists():
                    continue
                fixture = fixtures.load(path)
                nodes = tuple((other.folder / node).resolve() for node in other.designation.nodes)
                margin = tolerated(fixture.sample, other.designation.tolerance)
                declared = other.designation.drifts.get(self.drift or "")
                drift = self.drift if declared is not None and declared.permanent else None
                found.append(Neighbour(other.test, nodes, other.rollout, fixture, margin, drift))
        return found

    def _fixture(self) -> Fixture:
        if not self.fixture_path.exists():
            command = f"pytest {shlex.quote(self.target)} --tarl-record"
            raise NoFixtureError(f"{self.test} has no recorded utility yet: run `{command}` first.")
        fixture = fixtures.load(self.fixture_path)
        if [*map(declared, fixture.sensors)] != [*map(declared, self.designation.sensors)]:
            raise FixtureError(
                f"The sensors of {self.test} differ from those of its recording: record it again with "
                f"`pytest {shlex.quote(self.test)} --tarl-record`."
            )
        return fixture

    def _ignore(self) -> None:
        ignore = self.tarl / ".gitignore"
        # an unwritable folder is reported when the other files are written
        with suppress(OSError, UnicodeDecodeError):
            if not ignore.exists() or ignore.read_text("utf-8") == EARLIER:
                write_atomically(ignore, IGNORED.encode(), parents=True)


def _changeable(analysis: Analysis) -> set[str]:
    """Return the ids of the sites with an operand that a repair can change."""
    return {str(step.site) for step in analysis.sites if analysis.operands(step.site)}


class NoFixtureError(FixtureError):
    """The test has no recording: it is skipped or, with `--tarl-strict`, fails."""
