"""Find, continue and remove the kept episodes of all tests in a pytest run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from pytest_tarl.design import fixture_path
from pytest_tarl.designation import Designation
from pytest_tarl.errors import RecordingError
from pytest_tarl.files import advice_on
from pytest_tarl.item_episode import Instruments
from pytest_tarl.options import Options
from pytest_tarl.resuming.journal import Journal, TakenError, conditions_of
from pytest_tarl.resuming.kept_rollout import KeptRollout, scope_of
from pytest_tarl.resuming.run_conditions import changed, conditions
from pytest_tarl.rollout import Rollout
from pytest_tarl.scenarios import scenario, without_drift
from pytest_tarl.sensors import Sensor

FOLDER = "unfinished"
COMPLETE = (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED)


@dataclass
class ResumableTest:
    """A test in one mode, with its kept episodes; `tell` prints a sentence at once."""

    item: pytest.Function
    designation: Designation
    options: Options
    tell: Callable[[str], None]
    journal: Journal | None = None
    finished: bool = False

    def keeping(self, rollout: Rollout, instruments: Instruments, sensors: tuple[Sensor, ...]) -> Rollout:
        """Return a rollout that keeps its episodes and reuses kept ones.

        Raise RecordingError if an interrupted run cannot be continued.
        """
        if self.options.log is not None or self.options.bags:
            return rollout
        scope, checked = scope_of(instruments, sensors), self.journal is not None and self.finished
        self.journal = self.journal or self._opened([*instruments.positions])
        return KeptRollout(rollout, self.journal, scope, self._shown, checked=checked)

    def interrupted(self) -> str:
        """Return a sentence on the episodes kept by an interrupted run, or an empty text."""
        if self.journal is None:
            return ""
        if self.journal.problem is not None:
            reason = self.journal.problem.strerror or str(self.journal.problem)
            return f"Later episodes were not kept, because {self._shown} cannot be written: {reason}."
        count = self.journal.episodes
        return f"{_counted(count)} kept: add --tarl-resume to continue." if count else ""

    def close(self) -> None:
        """Write the kept episodes to disk."""
        if self.journal is not None:
            self.journal.close()

    @property
    def path(self) -> Path:
        """Return the path of the kept episodes."""
        root, test = self.item.config.rootpath, without_drift(self.item)
        kind = "-".join(filter(None, (self.options.mode, self.options.drift or scenario(self.item))))
        name = fixture_path(root, f"{test} {kind}").with_suffix(".episodes").name
        return root / ".tarl" / FOLDER / name

    @property
    def _shown(self) -> str:
        return self.path.relative_to(self.item.config.rootpath).as_posix()

    def _opened(self, files: list[Path]) -> Journal:
        root = self.item.config.rootpath
        test, folder = without_drift(self.item), self.item.path.parent
        now = conditions(test, folder, root, self.designation, self.options, files)
        found, journal = conditions_of(self.path), Journal(self.path, now)
        if found is None:
            if self.options.resume:
                self.tell(f"{self.item.nodeid}: no episodes are kept, so all of them are run.")
            return journal
        before, count = found
        difference = changed(before, now)
        if not self.options.resume:
            if not difference:
                self.tell(
                    f"{self.item.nodeid}: {_counted(count)} kept from an interrupted run and will be replaced by this "
                    "run's. To continue with them, press Ctrl-C now and add --tarl-resume."
                )
            return journal
        if difference:
            raise RecordingError(
                f"The interrupted run cannot be continued: {difference}. Undo the change, or run without "
                "--tarl-resume to begin again."
            )
        try:
            journal.resume()
        except TakenError:
            raise RecordingError(
                f"Another run of this test is writing {self._shown}: wait until it ends, or stop it."
            ) from None
        except OSError as problem:
            raise RecordingError(
                f"{self._shown} cannot be continued ({problem.strerror}): {advice_on(problem)}"
            ) from None
        self.tell(f"{self.item.nodeid}: {_counted(count)} kept from the interrupted run.")
        return journal


@dataclass
class ResumableRun:
    """The tests of a run that keep their episodes. Files are removed when the run ends without an interruption."""

    tests: list[ResumableTest] = field(default_factory=list)

    def test(
        self,
        item: pytest.Function,
        designation: Designation,
        options: Options,
        tell: Callable[[str], None],
    ) -> ResumableTest:
        """Return a test; if several calls share a total number of episodes, return the existing one."""
        known = next((one for one in self.tests if one.item is item), None)
        if known is not None and options.total is not None:
            return known
        self.tests.append(ResumableTest(item, designation, options, tell))
        return self.tests[-1]

    def ended(self, status: int) -> None:
        """Remove the episodes of finished tests if the run is complete; write the others to disk."""
        for one in self.tests:
            one.close()
            if one.finished and one.journal is not None and status in COMPLETE:
                one.journal.remove()
        self.tests.clear()


def _counted(count: int) -> str:
    return "1 finished episode is" if count == 1 else f"{count} finished episodes are"
