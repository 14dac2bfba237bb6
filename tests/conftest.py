"""Fixtures and hooks for all tests."""

import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests.slow import SLOW
from website.other_plugins import BLOCKED

pytest_plugins = ["pytester"]

# Hypothesis runs the same examples every time and has no deadline, since a loaded machine is not a defect.
settings.register_profile(
    "tarl",
    max_examples=100 if SLOW else 40,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("tarl")


def pytest_configure() -> None:
    """Handle Ctrl-C, also in the programs under test, even if a script started pytest in the background."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def _no_other_plugins() -> Iterator[None]:
    """Block other plugins in the pytest processes that tests start, but not in those of xdist that run the tests."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("PYTEST_ADDOPTS", BLOCKED)
        yield


class _Imported:
    """Plugin that stores the modules imported by a pytest run in this process, before pytester removes them."""

    def __init__(self) -> None:
        self.modules: dict[str, ModuleType] = {}

    def pytest_unconfigure(self) -> None:
        self.modules = dict(sys.modules)


@pytest.fixture
def pytester(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """Run pytest without other plugins, and keep the libraries that a run in this process imports.

    A second import would create other classes.
    """
    run = pytester.inline_run

    def inline_run(*args: Any, plugins: Any = (), **more: Any) -> Any:
        imported = _Imported()
        result = run(*args, plugins=[*plugins, imported], **more)
        for name, module in imported.modules.items():
            file = getattr(module, "__file__", None)
            if file is not None and not Path(file).is_relative_to(pytester.path):
                sys.modules.setdefault(name, module)
        return result

    monkeypatch.setattr(pytester, "inline_run", inline_run)
    monkeypatch.setenv("PYTEST_ADDOPTS", BLOCKED)
    return pytester
