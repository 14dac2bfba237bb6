"""Pass tests' reports to the terminal summary, including those from other processes."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pytest_tarl.printable import printable
from pytest_tarl.report.table import side_by_side

if TYPE_CHECKING:
    import pytest
    from _pytest.terminal import TerminalReporter

    from pytest_tarl.accounts import Account

ACCOUNT = "tarl_account"  # attribute of a report; has only plain values, which xdist can send


def attach(report: pytest.TestReport, account: Account) -> None:
    """Attach TARL's report of a test (an account) to pytest's."""
    told = {
        "lines": [printable(line) for line in account.lines],
        "patch": str(account.patch or ""),
        "annotation": account.annotation,
        "row": list(account.row),
        "unrecorded": account.unrecorded,
    }
    setattr(report, ACCOUNT, told)


class Summary:
    """Collect accounts from reports and write them in one section."""

    def __init__(self) -> None:
        self._told: list[Mapping[str, Any]] = []
        self.patches: list[str] = []  # paths of patches that repair the tests

    def collect(self, report: pytest.TestReport) -> None:
        """Collect a report's account, unless it was already collected."""
        told = getattr(report, ACCOUNT, None)
        if told and told not in self._told:
            self._told.append(told)
            self.patches += [told["patch"]] if told["patch"] else []

    def warning(self) -> str:
        """Return a warning if tests without a recording were not compared, or an empty text."""
        missing = sum(bool(one["unrecorded"]) for one in self._told)
        if not missing:
            return ""
        them = "it has" if missing == 1 else "they have"
        what = (
            f"NOTHING WAS COMPARED: {missing} of {missing}"
            if missing == len(self._told)
            else f"NOT COMPARED: {missing} of {len(self._told)}"
        )
        return (
            f"{what} tests, since {them} no recording. Run `pytest --tarl-record` once and commit .tarl/utility; "
            "--tarl-strict makes such tests fail."
        )

    def write(self, terminal: TerminalReporter, width: int, closing: Sequence[str]) -> None:
        """Write the section, ending with `closing`; on GitHub, write the annotations below it."""
        if not self._told:
            return
        terminal.section("TARL", sep="=")
        table = side_by_side([tuple(one["row"]) for one in self._told if one["row"]], width)
        blocks = [*(one["lines"] for one in self._told), *([table] if table else [])]
        for number, lines in enumerate(blocks):
            terminal.write_line(printable("\n".join(["", *lines] if number else lines)))
        for line in closing:
            terminal.write_line(f"\n{printable(line)}")
        if os.environ.get("GITHUB_ACTIONS") == "true":
            for one in self._told:
                if one["annotation"]:
                    terminal.write_line(printable(one["annotation"]))
