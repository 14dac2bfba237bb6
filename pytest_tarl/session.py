"""A pytest run with TARL's flags: select tests, run each one in the selected mode, and report at the end."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal
from unittest import TestCase

import pytest

from pytest_tarl.design import AS_WRITTEN
from pytest_tarl.errors import FixtureError, SettingsError, TarlError
from pytest_tarl.extras import missing_stress
from pytest_tarl.options import Options
from pytest_tarl.printable import printable
from pytest_tarl.progress import ProgressLine
from pytest_tarl.repeating import (
    INTERRUPTS,
    NOTHING,
    BesideRollout,
    Instruments,
    ItemRollout,
    defer_limit,
    designated,
    finish,
)
from pytest_tarl.scenarios import scenario, without_drift
from pytest_tarl.sensors import Sensor
from pytest_tarl.spaces import Space
from pytest_tarl.summary import Summary, attach

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

PLAIN_WIDTH = 80  # number of columns if there is no terminal reporter (`-p no:terminal`)

UNMARKED = (
    "NOTHING WAS RUN: no collected test has the marker. With TARL's flags, pytest runs only tests with "
    "@pytest.mark.tarl(nodes=[…], sensors=[…])."
)


class TarlSession:
    """The hooks of one run; registered only if a mode is selected."""

    def __init__(self, config: pytest.Config, options: Options) -> None:
        if _of_all_tests(options) and (
            hasattr(config, "workerinput") or config.getoption("numprocesses", None)
        ):
            what = "--tarl-holm corrects" if options.holm else "--tarl-total shares episodes"
            raise pytest.UsageError(
                f"{what} over all tests of a run, but with -n no process knows them all: remove -n, and use "
                "--tarl-workers to run episodes in parallel."
            )
        self.config = config
        self.options = options
        self._summary = Summary()
        self._ended: list[_Ended] = []  # finished tests that are not reported yet
        self._designated: tuple[pytest.Item, ...] = ()
        self._unmarked = False  # whether all collected tests lack the marker
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
        )  # an invalid marker is reported when the test runs
        if self.options.log is not None or self.options.bags:
            names = []  # logs and bags are not named after a drift
        if self.options.drift is not None:
            names = [name for name in names if name == self.options.drift]
        if self.options.mode == "stress":
            names = [name for name in names if _is_space(drifts[name])]
        if "tarl_drift" in metafunc.fixturenames:
            metafunc.parametrize("tarl_drift", names or [None], ids=names or ["online"], indirect=True)

    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        """Deselect tests that do not take part in a TARL run."""
        marked = [item for item in items if item.get_closest_marker("tarl") is not None]
        self._unmarked = bool(items) and not marked
        self._designated = tuple(marked)
        if self.options.drift is not None:
            self._check_drift(marked)
            marked = [item for item in marked if self._chosen(item)]
        if self.options.mode == "stress":
            marked = self._spaced(marked)
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

    def _spaced(self, marked: Sequence[pytest.Item]) -> list[pytest.Item]:
        """Return the items with a drift space.

        Raise UsageError if no item has one, or if a needed package is missing.
        """
        sentence = missing_stress("--tarl-stress")
        if sentence is not None:
            raise pytest.UsageError(sentence)
        found = [item for item in marked if _has_space(item)]
        if marked and not found:
            raise pytest.UsageError(
                "No test declares a space of drifts, which --tarl-stress searches: declare one in the marker, such as "
                'drifts={"world": Drift.space(mud=Drift.range(0.05, 1.0, nominal=1.0))}.'
            )
        return found

    def _chosen(self, item: pytest.Item) -> bool:
        """Return whether `--tarl-drift` selects an item.

        When recording, it selects every item whose marker declares the drift. When comparing, it selects the items of
        that scenario, and items that declare it but lack the fixture `tarl_drift`; their reports say so.
        """
        declared = self.options.drift in _drift_names(item)
        if self.options.mode == "record":
            return declared or self.options.drift == AS_WRITTEN
        return scenario(item) == self.options.drift or (declared and not _takes(item, "tarl_drift"))

    def _check_drift(self, marked: Sequence[pytest.Item]) -> None:
        known = sorted({name for item in marked for name in _drift_names(item)})
        backwards = self.options.mode == "record" and self.options.drift == AS_WRITTEN
        if marked and self.options.drift not in known and not backwards:
            names = ", ".join(known) or "none is declared"
            raise pytest.UsageError(
                f"No test declares the drift {self.options.drift!r} (declared: {names}). Declare it "
                "in the marker: drifts={…}."
            )

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
        """Run a designated test (one with the marker `tarl`) in the selected mode, with one report per phase.

        If Ctrl-C ended the test, raise KeyboardInterrupt after its reports.
        """
        if not isinstance(item, pytest.Function) or item.get_closest_marker("tarl") is None:
            return None
        together = _of_all_tests(self.options)
        if not together:
            _started(item)
        stage = self._shared.first if self._shared is not None else None
        call = pytest.CallInfo.from_call(lambda: self._run(item, stage), when="call", reraise=INTERRUPTS)
        self._ended.append(_Ended(item, call, _phase(item, "setup"), finish(item, nextitem)))
        if nextitem is None and self._shared is not None:
            self._share(self._shared)
        if nextitem is None or not together:
            self._tell()
        if call.excinfo is None and getattr(call.result, "interrupted", False):
            raise KeyboardInterrupt  # the results are reported; start no further test
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
                _started(one.item)
            one.log()

    def _share(self, shared: SharedEpisodes) -> None:
        """Spend the remaining shared episodes on undecided comparisons.

        Then replace all comparisons by their reports.
        """
        from pytest_tarl.accounts import Compared

        while (chosen := shared.following([one.outcome for one in self._ended])) is not None:
            self._ended[chosen[0]].proceed(self._run, chosen[1])
        notes = shared.notes([one.outcome for one in self._ended])
        for one, note in zip(self._ended, notes, strict=True):
            if isinstance(one.outcome, Compared):
                one.conclude(one.outcome.noted(note).told)

    @pytest.hookimpl(optionalhook=True, tryfirst=True)
    def pytest_timeout_set_timer(self, item: pytest.Item, settings: object) -> bool | None:
        """Apply the limit of pytest-timeout to each episode of a designated test, not to the whole test."""
        return None if item.get_closest_marker("tarl") is None else defer_limit(item, settings)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Collect the reports of all tests, including those from xdist's workers."""
        self._summary.collect(report)

    def pytest_terminal_summary(self, terminalreporter: TerminalReporter) -> None:
        """Write the reports in one section."""
        self._summary.write(terminalreporter, self._width(), self._joined().lines)

    def pytest_sessionfinish(self, exitstatus: int) -> None:
        """Delete the stored episodes of finished tests, unless the run was interrupted."""
        if self._resumable is not None:
            self._resumable.ended(exitstatus)

    def pytest_unconfigure(self) -> None:
        """Print the commands that apply the patches, or a warning that nothing was compared, as the last output."""
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

    def _run(self, item: pytest.Function, stage: Stage | None = None) -> Account | Compared:
        from pytest_tarl.accounts import Account
        from pytest_tarl.missions import Mission, NoFixtureError
        from pytest_tarl.resuming.run import ResumableRun

        marked = designated(item)
        if marked is None:
            raise SettingsError(f"{item.nodeid} has no tarl marker.")
        if not _takes(item, "tarl"):
            raise SettingsError(f"The test does not use the fixture `tarl`: {_how_to_take(item)}.")
        drifted = self.options.mode != "record" or self.options.drift is not None
        if marked.drifts and drifted and not _takes(item, "tarl_drift"):
            raise SettingsError(
                "the marker declares drifts, but the test does not use the fixture `tarl_drift`, so they have no "
                "effect: add the argument `tarl_drift` and build the world with it."
            )
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
                if stage is None:  # otherwise, the comparison may continue
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
        """Return the rollout of a test, which runs episodes in this process or in workers.

        Workers end with the test.
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
        """Print a sentence before the episodes run; in a worker of xdist, which has no terminal, at the end."""
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


@dataclass
class _Ended:
    """A finished test: its result, and the reports of its setup and teardown."""

    item: pytest.Function
    call: pytest.CallInfo[Any]
    setup: pytest.TestReport
    teardown: pytest.TestReport

    @property
    def outcome(self) -> Any:
        """Return the comparison of the test; None if it ended in an error."""
        return self.call.result if self.call.excinfo is None else None

    def proceed(self, run: Callable[[pytest.Function, Stage], object], stage: Stage) -> None:
        """Run a further stage of the comparison; its result replaces the previous one."""
        call = pytest.CallInfo.from_call(lambda: run(self.item, stage), when="call", reraise=INTERRUPTS)
        call.start, call.duration = self.call.start, self.call.duration + call.duration
        self.call = call
        again = finish(self.item, None)
        self.teardown = again if self.teardown.passed else self.teardown

    def conclude(self, told: Callable[[], Account]) -> None:
        """Replace the comparison by its report."""
        call = pytest.CallInfo.from_call(told, when="call", reraise=INTERRUPTS)
        call.start, call.stop, call.duration = self.call.start, self.call.stop, self.call.duration
        self.call = call

    def log(self) -> None:
        """Report the test to pytest."""
        item, report = self.item, self._report()
        for one in (self.setup, report, self.teardown):
            item.ihook.pytest_runtest_logreport(report=one)
        item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)

    def _report(self) -> pytest.TestReport:
        from pytest_tarl.accounts import Account

        report = pytest.TestReport.from_item_and_call(self.item, self.call)
        account, error = self.outcome, self.call.excinfo.value if self.call.excinfo else None
        if account is not None:
            attach(report, account)
            for one in (report, self.teardown):  # JUnit reads the properties of the last report
                one.user_properties.extend(account.properties)
            if account.problem:
                report.outcome, report.longrepr = "failed", printable(account.problem)
        elif isinstance(error, TarlError):
            report.longrepr = printable(str(error))
        elif error is not None and isinstance(error.__context__, FixtureError):
            attach(
                report, Account((str(error),), unrecorded=True)
            )  # skipped: pytest shows reasons only with -rs
        return report


def _of_all_tests(options: Options) -> bool:
    """Return whether reports must wait until all tests have run."""
    return options.holm or options.total is not None


def _started(item: pytest.Item) -> None:
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)


def _drift_names(item: pytest.Item) -> list[str]:
    try:
        marked = designated(item)
    except SettingsError as error:
        raise pytest.UsageError(str(error)) from None
    return list(marked.drifts) if marked else []


def _is_space(drift: object) -> bool:
    return isinstance(getattr(drift, "value", None), Space)


def _has_space(item: pytest.Item) -> bool:
    """Return whether an item's scenario is a space, or its marker declares one and the item lacks the fixture."""
    marker = item.get_closest_marker("tarl")
    drifts = marker.kwargs.get("drifts", {}) if marker is not None else {}
    if not isinstance(drifts, Mapping):
        return True  # an invalid marker is reported when the test runs
    if _takes(item, "tarl_drift"):
        return _is_space(drifts.get(scenario(item)))
    return any(map(_is_space, drifts.values()))


def _takes(item: pytest.Item, fixture: str) -> bool:
    return fixture in getattr(item, "fixturenames", ())


def _how_to_take(item: pytest.Function) -> str:
    """Describe how a test requests the fixture; methods of unittest.TestCase cannot have fixture arguments."""
    if item.cls is None or not issubclass(item.cls, TestCase):
        return "take it as an argument"
    return (
        f"a method of unittest.TestCase cannot take it as an argument, so give {item.cls.__name__} a method with "
        "@pytest.fixture(autouse=True) that takes it and stores it in self"
    )


def _phase(item: pytest.Item, when: Literal["setup"]) -> pytest.TestReport:
    return pytest.TestReport.from_item_and_call(item, pytest.CallInfo.from_call(lambda: None, when=when))
