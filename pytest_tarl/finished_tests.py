"""A finished test of a TARL run, reported to pytest at once or, if tests are judged together, at the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import pytest

from pytest_tarl.errors import FixtureError, TarlError
from pytest_tarl.printable import printable
from pytest_tarl.repeating import INTERRUPTS, finish
from pytest_tarl.terminal_summary import attach

if TYPE_CHECKING:
    from pytest_tarl.accounts import Account
    from pytest_tarl.learning.spending import Stage


@dataclass
class FinishedTest:
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
            # the JUnit report takes its properties from the last of these reports
            for one in (report, self.teardown):
                one.user_properties.extend(account.properties)
            if account.problem:
                report.outcome, report.longrepr = "failed", printable(account.problem)
        elif isinstance(error, TarlError):
            report.longrepr = printable(str(error))
        elif error is not None and isinstance(error.__context__, FixtureError):
            attach(
                report, Account((str(error),), unrecorded=True)
            )  # the test is skipped; pytest shows why only with -rs
        return report


def started(item: pytest.Item) -> None:
    """Tell pytest that a test has started."""
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)


def passed(item: pytest.Item, when: Literal["setup"]) -> pytest.TestReport:
    """Return the report of a phase without failure."""
    return pytest.TestReport.from_item_and_call(item, pytest.CallInfo.from_call(lambda: None, when=when))
