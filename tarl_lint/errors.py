"""Errors for users. Every message says what is wrong, where, and what to do next."""

from __future__ import annotations


class LintError(Exception):
    """Base of all errors for users: printed as one sentence without traceback, exit code 2."""


class UsageError(LintError):
    """The command line is invalid: an unknown option, rule or file, or a directory without Python files."""


class ConfigError(LintError):
    """A settings file cannot be read, or contains an invalid key or value."""


class BaselineError(LintError):
    """The baseline is missing, damaged, not a baseline, or of another format version."""


class OutputError(LintError):
    """A requested output file cannot be written."""


class AnalysisBug(LintError):  # noqa: N818 - the name says that the mistake is in tarl-lint
    """The analysis itself crashed."""
