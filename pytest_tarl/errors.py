"""Errors shown to users. Every message says what is wrong, where, and what to do next."""

from __future__ import annotations


class TarlError(Exception):
    """Base of all errors shown to the user as a sentence, without a traceback."""


class SettingsError(TarlError):
    """A marker, an option or an ini value is invalid."""


class FixtureError(TarlError):
    """A recording is missing, damaged, of another test or format; `what` is the message without the advice."""

    def __init__(self, what: str, advice: str = "") -> None:
        super().__init__(f"{what} {advice}".rstrip())
        self.what = what


class AnalysisError(TarlError):
    """The named nodes cannot be analysed, or have no flow from a subscription to a publish call."""


class RecordingError(TarlError):
    """A test run cannot be recorded: no reward, silent sensor, node that fails to start."""


class SimulatorError(RecordingError):
    """An external simulator cannot be started or does not fit the test."""


class SimulatorLostError(SimulatorError):
    """An external simulator died or hung; its episode is run again with a new one."""


class RequirementError(AssertionError):
    """A formula does not hold in an episode, so the mission failed."""


class LogError(TarlError):
    """A node cannot be observed, or the log of its missions cannot be read."""


class FleetError(TarlError):
    """A fleet's data set cannot be read or written, or holds files that are damaged or of another format."""


class MonitorError(TarlError):
    """Missions cannot be watched: the watch's state is damaged, in use, or belongs to another watch."""


class NodeError(TarlError):
    """A node never waits, or raised an exception."""


class StuckNodeError(NodeError):
    """A node computed without ever waiting. Each such episode takes seconds, so the run stops at the first."""


class UnsupportedApiError(TarlError):
    """A node uses a part of the ROS API that the in-process ROS does not implement."""


class UnsupportedModuleError(UnsupportedApiError, ModuleNotFoundError):
    """A node imports a ROS module that the in-process ROS does not implement; it may do without."""


class RepairError(TarlError):
    """A mutation cannot be written to the source."""


class StaleTextError(TarlError):
    """A candidate was written to a file, but the previous text ran."""


class SearchError(TarlError):
    """A plugged-in search breaks the search protocol."""


class RefusedError(TarlError):
    """A command is valid but would cause harm in the current state, so it changed nothing."""


def first_line(error: BaseException | None) -> str:
    """Return the first line of what an error says, or the name of its class if it says nothing, as timeouts do."""
    text = str(error).strip()
    return text.splitlines()[0] if text else type(error).__name__
