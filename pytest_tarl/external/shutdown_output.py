"""What a simulator printed after TARL had ended it: its own words, without the tracebacks that SIGINT causes."""

from __future__ import annotations

import re

_FRAMES = r"(?:Exception (?:ignored|in thread) .*\n)?Traceback \(most recent call last\):\n(?:[ \t].*\n)*"
_LINK = (
    r"\n(?:During handling of the above exception, another exception occurred"
    r"|The above exception was the direct cause of the following exception):\n\n"
)
_INTERRUPTS = (
    r"(?:KeyboardInterrupt|ExternalShutdownException|ROSInterruptException|NotInitializedException)(?::.*)?"
)
# rclpy and rospy shut down in another thread on SIGINT; a program that uses them at that moment, or shuts them down
# once more, gets one of these errors
_SHUT_DOWN = (
    r"\w+: .*(?:context is (?:not valid|invalid)|rcl_shutdown already called"
    r"|Context must be initialized before it can be shutdown|destruction was requested|publish\(\) to a closed topic).*"
)
_INTERRUPTED = re.compile(
    rf"^(?:{_FRAMES}[\w.]+(?::.*)?\n{_LINK})*{_FRAMES}(?:[\w.]+\.)?(?:{_INTERRUPTS}|{_SHUT_DOWN})(?:\n(?!{_LINK})|\Z)",
    re.MULTILINE,
)
# rclpy's handler of SIGINT wakes executors, also those of a context that has just been destroyed
_HANDLING = re.compile(r"^\[\w+\] \[[\d.]+\] \[rclpy\.signals\]: .*(?:\n|\Z)", re.MULTILINE)


def without_interrupts(output: str) -> str:
    """Remove what rclpy's handler of signals logs, and each Python traceback whose last exception shows an interrupt.

    The interrupt is one of the process or of its ROS. Other tracebacks remain, even if an interrupt caused their
    exception or occurred while it was being handled.
    """
    return _INTERRUPTED.sub("", _HANDLING.sub("", output))
