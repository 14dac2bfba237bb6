"""Errors shown to users. Every message says what is wrong, where, and what to do next."""

from __future__ import annotations

from typing import Final

MOST_TEXT: Final = 4000  # maximum characters of an error's message to show (two screens of a terminal)


class TarlError(Exception):
    """Base of all errors that users see as a sentence, without a traceback."""


class SettingsError(TarlError):
    """A marker, an option or an ini value is invalid."""


class FixtureError(TarlError):
    """A recording is missing, damaged, or of another test or format. `what` is the message without advice."""

    def __init__(self, what: str, advice: str = "") -> None:
        super().__init__(f"{what} {advice}".rstrip())
        self.what = what


class AnalysisError(TarlError):
    """The named nodes cannot be analysed, or have no flow from a subscription to a publish call."""


class RecordingError(TarlError):
    """A test run cannot be recorded: no reward, a silent sensor, or a node that fails to start."""


class SimulatorError(RecordingError):
    """An external simulator cannot be started or does not fit the test."""


class SimulatorLostError(SimulatorError):
    """An external simulator died or hung; the episode is repeated with a new one. `why` is the reason in brief."""

    def __init__(self, text: str, why: str = "") -> None:
        super().__init__(text)
        self.why = why or text


class RequirementError(AssertionError):
    """A formula does not hold in an episode, which therefore counts as a failed mission."""


class LogError(TarlError):
    """A node cannot be observed, or a mission log cannot be read."""


class FleetError(TarlError):
    """A fleet's data set cannot be read or written, or its files are damaged or in another format."""


class MonitorError(TarlError):
    """`tarl watch` cannot run: its state file is damaged, in use, or of another watch."""


class NodeError(TarlError):
    """A node raised an exception or never waited."""


class StuckNodeError(NodeError):
    """A node never waits. Such an episode takes seconds, so the run stops after the first one."""


class UnsupportedApiError(TarlError):
    """A node uses a part of the ROS API that the in-process ROS does not implement."""


class UnsupportedNameError(UnsupportedApiError, AttributeError):
    """A node reads a name that is missing from a module of the in-process ROS; `hasattr` returns False."""


class UnsupportedImportError(UnsupportedApiError, ImportError):
    """A node imports a name that is missing from a module of the in-process ROS; it may catch this error."""


class UnsupportedModuleError(UnsupportedApiError, ModuleNotFoundError):
    """A node imports a ROS module that the in-process ROS does not implement; it may catch this error."""


class RepairError(TarlError):
    """A change cannot be written to the source code."""


class StaleTextError(TarlError):
    """A repair candidate replaced a file's text, but the episode ran the old text."""


class SearchError(TarlError):
    """A user's search breaks the search protocol."""


class RefusedError(TarlError):
    """A command is valid, but would do harm in the current state, so it changed nothing."""


def text_of(said: object) -> str:
    """Return the message of an error from other code, cut to `MOST_TEXT` characters.

    The error's `__str__` may itself raise an exception; the returned text then names that exception.
    """
    try:
        text = str(said)
    except KeyboardInterrupt:
        raise
    except BaseException as problem:
        return f"(its __str__ raised {type(problem).__name__})"
    return text if len(text) <= MOST_TEXT else f"{text[:MOST_TEXT]}… ({len(text)} characters)"


def first_line(error: BaseException | None) -> str:
    """Return the first line of an error's message, or its class name if the message is empty."""
    text = text_of(error).strip()
    return text.splitlines()[0] if text else type(error).__name__
