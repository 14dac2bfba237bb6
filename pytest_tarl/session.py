"""A pytest run with TARL's flags: select tests, run each in the selected mode, and report at the end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.finished_tests import FinishedTest, passed, started
from pytest_tarl.item_episode import NOTHING, Instruments, designated
from pytest_tarl.options import Options
from pytest_tarl.printable import printable
from pytest_tarl.progress import ProgressLine
from pytest_tarl.repeating import INTERRUPTS, BesideRollout, ItemRollout, defer_limit, finish
from pytest_tarl.scenarios import scenario, without_drift
from pytest_tarl.selecting import check_drift, chosen, how_to_take, is_space, takes, with_space
from pytest_tarl.sensors import Sensor
from pytest_tarl.terminal_summary import Summary

if TYPE_CHECKING:
    from _pytest.terminal import TerminalReporter

    from pytest_tarl.accounts import Account, Compared
    from pytest_tarl.designation import Designation
    from pytest_tarl.learning.spending import Stage
    from pytest_tarl.missions import Other
    from pytest_tarl.repairing.merge_patches import Joined
    from pytest_tarl.resuming.run import ResumableRun
    from pytest_tarl.rollout import Rollout
    from pytest_tarl.sharing import SharedEpisodes

PLAIN_WIDTH = 80  # columns if there is no terminal reporter (`-p no:terminal`)

UNMARKED = (
    "NOTHING WAS RUN: no collected test has the marker. With TARL's flags, pytest runs only tests with "
    "@pytest.mark.tarl(nodes=[…], sensors=[…])."
)


class TarlSession:
    """The hooks of a run; registered only if a mode is selected."""

    def __init__(self, config: pytest.Config, options: Options) -> None:
        if _of_all_tests(options) and (
            hasattr(config, "workerinput") or config.getoption("numprocesses", None)
        ):
            what = "--tarl-holm corrects" if options.holm else "--tarl-total shares episodes"
            raise pytest.UsageError(
                f"{what} over all tests of a run, but with -n no process sees them all: remove -n, and use "
                "--tarl-workers to run episodes in parallel."
            )
        self.config = config
        self.options = options
        self._summary = Summary()
        self._ended: list[FinishedTest] = []  # finished tests that are not reported yet
        self._designated: tuple[pytest.Item, ...] = ()
        self._unmarked = False  # whether no collected test has the marker
        self._resumable: ResumableRun | None = None
        self._shared: SharedEpisodes | None = None  # with --tarl-total

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Parametrize tests by drift scenario: `test_delivers[mud]`, or `[online]` if the marker has no drifts."""
        marker = metafunc.definition.get_closest_marker("tarl")
        if marker is None or self.options.mode == "record":
            return
        drifts = marker.kwargs.get("drifts", {})
        names = (
            list(drifts) if isinstance(drifts, Mapping) else []
        )  # running the test will report that the marker is invalid
        if self.options.log is not None or self.options.bags:
            names = []  # files for a log or bag have no drift in their names
        if self.options.drift is not None:
            names = [name for name in names if name == self.options.drift]
        if self.options.mode == "stress":
            names = [name for name in names if is_space(drifts[name])]
        if "tarl_drift" in metafunc.fixturenames:
            metafunc.parametrize("tarl_drift", names or [None], ids=names or ["online"], indirect=True)

    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        """Deselect tests that do not take part in a TARL run."""
        marked = [item for item in items if item.get_closest_marker("tarl") is not None]
        self._unmarked = bool(items) and not marked
        self._designated = tuple(marked)
        if self.options.drift is not None:
            check_drift(marked, self.options)
            marked = [item for item in marked if chosen(item, self.options)]
        if self.options.mode == "stress":
            marked = with_space(marked)
        if self.options.holm:
            self.options = replace(self.options, comparisons=max(len(marked), 1))
        if self.options.total is not None:
            self._shared = self._sharing(self.options.total, marked)
        kept = set(marked)
        others = [item for item in items if item not in kept]
        if others:
            config.hook.pytest_deselected(items=others)
            items[:] = marked

    def _sharing(self, total: int, marked: Sequence[pytest.Item]) -> SharedEpisodes | None:
        """Return the plan for --tarl-total. Raise UsageError if the total is too small for the recorded tests."""
        from pytest_tarl.design import fixture_path
        from pytest_tarl.sharing import SharedEpisodes, shortage

        root = self.config.rootpath
        recorded = [item for item in marked if fixture_path(root, without_drift(item)).exists()]
        if not recorded:
            return None
        if sentence := shortage(total, len(recorded)):
            raise pytest.UsageError(sentence)
        return SharedEpisodes(total, len(recorded), self.options.most_looks)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
        """Run a designated test (one with the marker `tarl`) in the selected mode, with one report per phase.

        If Ctrl-C ended the test, raise KeyboardInterrupt after its reports.
        """
        if not isinstance(item, pytest.Function) or item.get_closest_marker("tarl") is None:
            return None
        together = _of_all_tests(self.options)
        if not together:
            started(item)
        stage = self._shared.first if self._shared is not None else None
        call = pytest.CallInfo.from_call(lambda: self._run(item, stage), when="call", reraise=INTERRUPTS)
        self._ended.append(FinishedTest(item, call, passed(item, "setup"), finish(item, nextitem)))
        if nextitem is None and self._shared is not None:
            self._share(self._shared)
        if nextitem is None or not together:
            self._tell()
        if call.excinfo is None and getattr(call.result, "interrupted", False):
            raise KeyboardInterrupt  # the results are reported, so end the run before the next test
        return True

    def _tell(self) -> None:
        """Report the finished tests to pytest.

        With --tarl-holm and --tarl-total, wait until all tests have finished.
        """
        from pytest_tarl.accounts import Compared, jointly

        ended, self._ended = self._ended, []
        if self.options.holm:
            several = [one for one in ended if isinstance(one.outcome, Compared)]
            found = jointly([one.outcome for one in several], self.options.alpha)
            for one, outcome in zip(several, found, strict=True):
                one.conclude(outcome.told)
        for one in ended:
            if _of_all_tests(self.options):
                started(one.item)
            one.log()

    def _share(self, shared: SharedEpisodes) -> None:
        """Spend the remaining shared episodes on undecided comparisons.

        Afterwards, replace all comparisons by their reports.
        """
        from pytest_tarl.accounts import Compared

        while (following := shared.following([one.outcome for one in self._ended])) is not None:
            self._ended[following[0]].proceed(self._run, following[1])
        notes = shared.notes([one.outcome for one in self._ended])
        for one, note in zip(self._ended, notes, strict=True):
            if isinstance(one.outcome, Compared):
                one.conclude(one.outcome.noted(note).told)

    @pytest.hookimpl(optionalhook=True, tryfirst=True)
    def pytest_timeout_set_timer(self, item: pytest.Item, settings: object) -> bool | None:
        """Apply pytest-timeout's limit to each episode of a designated test, not to the whole test."""
        return None if item.get_closest_marker("tarl") is None else defer_limit(item, settings)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Collect the reports of all tests, including those from xdist's workers."""
        self._summary.collect(report)

    def pytest_terminal_summary(self, terminalreporter: TerminalReporter) -> None:
        """Write the reports in one section."""
        self._summary.write(terminalreporter, self._width(), self._joined().lines)

    def pytest_sessionfinish(self, exitstatus: int) -> None:
        """Delete the kept episodes of finished tests, unless the run was interrupted."""
        if self._resumable is not None:
            self._resumable.ended(exitstatus)

    def pytest_unconfigure(self) -> None:
        """Print, as the last output, the commands that apply the patches, or a warning that nothing was compared."""
        if not self._has_terminal():
            return
        terminal = self.config.get_terminal_writer()
        if warning := UNMARKED if self._unmarked else self._summary.warning():
            terminal.line(warning, bold=True, red=True)
        if not self._summary.patches:
            return
        for command in self._joined().commands:
            terminal.line(printable(command))
        self._summary.patches.clear()

    def _joined(self) -> Joined:
        """Merge the patches of all tests in the run."""
        from pytest_tarl.repairing.merge_patches import joined

        patches = tuple(map(Path, self._summary.patches))
        return joined(patches, self.config.invocation_params.dir)

    def _designation(self, item: pytest.Function) -> Designation:
        """Return the marker of a test. Raise SettingsError if the test does not use the fixtures that it needs."""
        marked = designated(item)
        if marked is None:
            raise SettingsError(f"{item.nodeid} has no tarl marker.")
        if not takes(item, "tarl"):
            raise SettingsError(f"The test does not use the fixture `tarl`: {how_to_take(item)}.")
        drifted = self.options.mode != "record" or self.options.drift is not None
        if marked.drifts and drifted and not takes(item, "tarl_drift"):
            raise SettingsError(
                "the marker declares drifts, but the test does not use the fixture `tarl_drift`, so they have no "
                "effect: add the argument `tarl_drift` and build the world with it."
            )
        return marked

    def _run(self, item: pytest.Function, stage: Stage | None = None) -> Account | Compared:
        from pytest_tarl.accounts import Account
        from pytest_tarl.missions import Mission, NoFixtureError
        from pytest_tarl.resuming.run import ResumableRun

        marked = self._designation(item)
        progress = self._progress(item)
        mission = Mission(
            test=without_drift(item),
            folder=item.path.parent,
            root=self.config.rootpath,
            started=self.config.invocation_params.dir,
            designation=marked,
            options=self.options,
            drift=scenario(item),
            width=self._width(),
            progress=progress,
            tell=self._say,
            others=self._others(item),
            stage=stage,
            node=item.nodeid,
        )
        self._resumable = self._resumable or ResumableRun()
        kept = self._resumable.test(item, marked, self.options, self._say)
        try:
            with ExitStack() as opened:
                if stage is None:  # with a stage, the comparison may continue after this call
                    opened.callback(kept.close)

                def rollout_with(instruments: Instruments, sensors: tuple[Sensor, ...]) -> Rollout:
                    rollout = self._rollout(item, replace(marked, sensors=sensors), instruments, opened)
                    return kept.keeping(rollout, instruments, sensors)

                outcome = mission.run(rollout_with)
                kept.finished = True
                if outcome.interrupted:
                    self._say(kept.interrupted())
                if isinstance(outcome, Account) or _of_all_tests(self.options):
                    return outcome
                return outcome.told()
        except NoFixtureError as missing:
            if self.options.strict:
                raise
            pytest.skip(str(missing))
        except KeyboardInterrupt:
            self._say(mission.interrupted(progress.done, progress.total, kept.interrupted()))
            raise

    def _rollout(
        self, item: pytest.Function, marked: Designation, instruments: Instruments, opened: ExitStack
    ) -> Rollout:
        """Return a rollout that runs a test's episodes in this process or in workers.

        The workers end with the test.
        """
        if self.options.workers == 1 and self.options.cluster is None:
            return ItemRollout(item, marked, instruments)
        from pytest_tarl.workers import executor

        return opened.enter_context(executor.opened(item, instruments, marked.sensors, self.options))

    def _others(self, item: pytest.Function) -> tuple[Other, ...]:
        """Return the other designated tests of the run; a test with several drifts appears once."""
        from pytest_tarl.missions import Other

        found: dict[str, Other] = {}
        repairs = self.options.mode == "repair" or self.options.stress_repair
        needed = repairs or (self.options.mode == "record" and self.options.drift)
        for other in self._designated if needed else ():
            marked, name = designated(other), without_drift(other)
            if marked is not None and isinstance(other, pytest.Function) and name != without_drift(item):
                rollout = BesideRollout(other, marked, NOTHING, item)
                found.setdefault(name, Other(name, other.path.parent, marked, rollout))
        return tuple(found.values())

    def _width(self) -> int:
        return self.config.get_terminal_writer().fullwidth if self._has_terminal() else PLAIN_WIDTH

    def _has_terminal(self) -> bool:
        return self.config.pluginmanager.has_plugin("terminalreporter")

    def _say(self, sentence: str) -> None:
        """Print a sentence before the episodes run; in an xdist worker, which has no terminal, print it at the end."""
        reporter = self.config.pluginmanager.get_plugin("terminalreporter")
        if reporter is not None:
            reporter.ensure_newline()
            reporter.write_line(printable(sentence))

    def _progress(self, item: pytest.Function) -> ProgressLine:
        reporter = self.config.pluginmanager.get_plugin("terminalreporter")

        def write(line: str) -> None:
            if reporter is not None and reporter.isatty:
                reporter.rewrite(line, erase=True)

        return ProgressLine(item.nodeid, write)


def _of_all_tests(options: Options) -> bool:
    """Return whether reports must wait until all tests have run."""
    return options.holm or options.total is not None
