"""Names of sources and sinks in messages of rules."""

from __future__ import annotations

from tarl_lint.model import Sink, Source


def end(which: Source | Sink) -> str:
    """Name a source or sink: `/odom (Odometry)`."""
    name = ", ".join(which.topics) or "an unknown topic"
    return f"{name} ({which.type})" if which.type else name
