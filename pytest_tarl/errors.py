"""What can go wrong for a user. Every message says what is wrong, where, and what to do next."""

from __future__ import annotations


class TarlError(Exception):
    """Base of all errors that are meant for the user: shown as one sentence, without a traceback."""


class SettingsError(TarlError):
    """A marker, an option or an ini value is not usable."""


class FixtureError(TarlError):
    """A utility fixture is missing, damaged, foreign or of another format; `what` leaves the advice out."""

    def __init__(self, what: str, advice: str = "") -> None:
        super().__init__(f"{what} {advice}".rstrip())
        self.what = what


class AnalysisError(TarlError):
    """The named nodes cannot be analysed, or hold no flow from a subscription to a publish call."""


class RecordingError(TarlError):
    """A test run cannot be recorded: no reward, silent sensor, node that fails to start."""


class RequirementError(AssertionError):
    """A formula does not hold in an episode: a failed mission, told without a traceback."""


class LogError(TarlError):
    """A node cannot be observed, or the log of its missions cannot be read."""


class MonitorError(TarlError):
    """Missions cannot be watched: the state of the watch is damaged, in use, or belongs to something else."""


class NodeError(TarlError):
    """A node misbehaves towards the simulation: it never waits, or ends in an exception."""


class StuckNodeError(NodeError):
    """A node kept the processor without ever waiting; each such episode costs seconds."""


class UnsupportedApiError(TarlError):
    """A node asks the in-process ROS for something that it does not have."""


class RepairError(TarlError):
    """A mutation cannot be written into the source."""


class StaleTextError(TarlError):
    """A candidate was written into a file, and the text of before ran."""


class SearchError(TarlError):
    """A search that was plugged in does not do what is asked of it."""


class RefusedError(TarlError):
    """A command can be understood but would do harm as things are, so nothing was changed."""
