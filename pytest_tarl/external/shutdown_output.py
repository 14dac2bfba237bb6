"""Remove the tracebacks that SIGINT causes from a simulator's output."""

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
# On SIGINT, rclpy and rospy shut down in another thread. A program gets one of these errors if it uses them at that
# moment, or shuts them down again.
_SHUT_DOWN = (
    r"\w+: .*(?:context is (?:not valid|invalid)|rcl_shutdown already called"
    r"|Context must be initialized before it can be shutdown|destruction was requested|publish\(\) to a closed topic).*"
)
_INTERRUPTED = re.compile(
    rf"^(?:{_FRAMES}[\w.]+(?::.*)?\n{_LINK})*{_FRAMES}(?:[\w.]+\.)?(?:{_INTERRUPTS}|{_SHUT_DOWN})(?:\n(?!{_LINK})|\Z)",
    re.MULTILINE,
)
# rclpy's SIGINT handler wakes all executors, including those of a context that was just destroyed
_HANDLING = re.compile(r"^\[\w+\] \[[\d.]+\] \[rclpy\.signals\]: .*(?:\n|\Z)", re.MULTILINE)


def without_interrupts(output: str) -> str:
    """Remove rclpy's signal messages and the tracebacks of interrupts.

    An interrupt is a KeyboardInterrupt, or one of ROS's own exceptions for it. Other tracebacks stay, even if an
    interrupt caused the exception or came while it was being handled.
    """
    return _INTERRUPTED.sub("", _HANDLING.sub("", output))
