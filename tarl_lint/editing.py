"""A workspace that is open in an editor: linted again after each change, including unsaved texts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final

from tarl_lint import baseline
from tarl_lint.read.source import Script
from tarl_lint.read.watched import Reading
from tarl_lint.run import cache, runner
from tarl_lint.run.cache import Cache, Report
from tarl_lint.run.reuse import Analyses
from tarl_lint.run.runner import Early, Result
from tarl_lint.settings.config import Config, Options, resolve
from tarl_lint.settings.schema import BASELINE_NAME

# a report is kept for this number of runs after its last use, because users often undo an edit
KEPT_RUNS: Final = 10
__all__ = ["Result", "Superseded", "Workspace"]


class Superseded(BaseException):
    """A later edit made this run obsolete.

    This class does not inherit from Exception, so it is not reported as a bug of the analysis.
    """


class Workspace:
    """The files at and below some paths. Programs that a change does not affect are not analysed again."""

    def __init__(self, paths: Sequence[Path]) -> None:
        self._options = Options(paths=tuple(paths), jobs=1)
        self._known: _Memory | None = None

    def lint(
        self,
        buffers: Mapping[Path, str],
        current: Callable[[], bool] = lambda: True,
        early: Early | None = None,
    ) -> Result:
        """Return the result; `buffers` maps absolute paths to the texts of unsaved files.

        `current` returns whether the result is still wanted; it is called before each program is analysed. `early`
        gets incomplete results while programs are still to be analysed, with the paths of the files whose findings
        are final. The programs that are run from an edited file are analysed first.

        Raises LintError for unusable settings or an unusable baseline, and if there is nothing to lint. Raises
        Superseded if the result is no longer wanted; the programs analysed so far are not analysed again.
        """

        def proceed(_: str) -> None:
            if not current():
                raise Superseded

        config = resolve(self._options)
        if self._known is None or self._known.config != config:
            self._known = _Memory(config, cache.opened(self._options.paths, config))
        texts = {path: text.encode("utf-8", "surrogatepass") for path, text in buffers.items()}
        return runner.run(self._options, config, proceed, texts, self._known, early)

    def accept(self, fingerprint: str, result: Result) -> Path:
        """Add the findings of a result with this fingerprint to the baseline and return its path.

        Raises LintError for unusable settings, an unusable baseline, or if the file cannot be written.
        """
        config = resolve(self._options)
        path = config.baseline or (config.root or Path.cwd()) / BASELINE_NAME
        before = baseline.load(path).entries if path.exists() else ()
        found = [one for one in result.found if one.fingerprint.digest() == fingerprint]
        kept = [one for one in before if one.fingerprint.digest() != fingerprint]
        baseline.save(path, baseline.merged(found, kept))
        return path


class _Memory(Cache):
    """The reports of the last runs, by key, in memory. The cache on disk is only read."""

    adapts = True

    def __init__(self, config: Config, saved: Cache) -> None:
        super().__init__(None)
        self.config = config
        self._analyses = Analyses(config)
        self._saved = saved
        self._known: dict[str, Report] = {}
        self._digests: Mapping[str, str] = {}  # path → digest of the file in the last complete run
        self._seen: Mapping[str, str] = {}
        self._used: dict[str, int] = {}  # key of a report → number of the last run that needed the report
        self._run = 0

    def report(self, key: str) -> Report | None:
        """Return the report stored under a key; None if there is none."""
        found = self._known.get(key) or self._saved.report(key)
        if found is not None:
            self.put(key, found)
        return found

    def put(self, key: str, report: Report) -> None:
        """Keep a report until KEPT_RUNS runs in a row have not needed it."""
        self._known[key] = report
        self._used[key] = self._run

    def adapted(self, scripts: Sequence[Script]) -> Report | None:
        """Return the report of the last analysis of these files, if later edits cannot have changed it."""
        return self._analyses.adapted(scripts)

    def keep(self, scripts: Sequence[Script], readings: Mapping[str, Reading], report: Report) -> None:
        """Store a report, together with the parts of files that its analysis has read."""
        self._analyses.keep(scripts, readings, report)

    def edited(self, digests: Mapping[str, str]) -> frozenset[str]:
        """Return the files whose digests differ from the last complete run; empty in the first run."""
        before, self._seen = self._digests, digests
        return frozenset(path for path, one in digests.items() if before and before.get(path) != one)

    def plan(self, _: str) -> Sequence[str]:
        """Return no plan, so that each run determines which reports it needs."""
        return []

    def save(self) -> None:
        """Drop the reports that the last runs did not need."""
        for key in [key for key, run in self._used.items() if self._run - run >= KEPT_RUNS]:
            del self._known[key], self._used[key]
        self._digests = self._seen
        self._run += 1
