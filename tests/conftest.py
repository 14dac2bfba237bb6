"""Shared by all tests."""

from hypothesis import HealthCheck, settings

pytest_plugins = ["pytester"]

# The same examples in every run, and no verdict by the clock: a loaded machine is no defect.
settings.register_profile(
    "tarl",
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("tarl")
