"""Shared by all tests."""

import signal

from hypothesis import HealthCheck, settings

pytest_plugins = ["pytester"]

# Hypothesis runs the same examples every time and has no deadline, since a loaded machine is not a defect.
settings.register_profile(
    "tarl",
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("tarl")


def pytest_configure() -> None:
    """Heed Ctrl-C, and let the programs under test heed it, also where a script started us in the background."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
