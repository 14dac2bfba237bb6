"""What a simulator printed after TARL had ended it: its own words, without the tracebacks that SIGINT causes."""

from __future__ import annotations

import re

_FRAMES = r"(?:Exception (?:ignored|in thread) .*\n)?Traceback \(most recent call last\):\n(?:[ \t].*\n)*"
_LINK = (
    r"\n(?:During handling of the above exception, another exception occurred"
    r"|The above exception was the direct cause of the following exception):\n\n"
)
_INTERRUPTS = r"(?:[\w.]+\.)?(?:KeyboardInterrupt|ExternalShutdownException|ROSInterruptException)"
_INTERRUPTED = re.compile(
    rf"^(?:{_FRAMES}[\w.]+(?::.*)?\n{_LINK})*{_FRAMES}{_INTERRUPTS}(?::.*)?(?:\n(?!{_LINK})|\Z)", re.MULTILINE
)


def without_interrupts(output: str) -> str:
    """Remove each Python traceback whose last exception shows that the process was interrupted.

    Other tracebacks remain, even if an interrupt caused their exception or occurred while it was being handled.
    """
    return _INTERRUPTED.sub("", output)
