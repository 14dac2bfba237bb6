"""What can go wrong for a linter's user. Every message says what is wrong, where, and what to do next."""

from __future__ import annotations


class LintError(Exception):
    """Base of all errors that are meant for the user: shown as one sentence, no traceback, exit code 2."""


class UsageError(LintError):
    """The command line asks for what does not exist: an option, a rule, a file, a place without Python."""


class ConfigError(LintError):
    """A settings file cannot be read, or holds a key or value that is not usable."""


class BaselineError(LintError):
    """The file of accepted flows is missing, damaged, foreign or of another format."""


class OutputError(LintError):
    """A file that was asked for cannot be written."""


class AnalysisBug(LintError):  # noqa: N818 - it names whose mistake it is: ours
    """The analysis itself crashed."""
