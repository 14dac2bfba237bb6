"""Fixtures and hooks for all tests."""

import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from tests.slow import SEED, SLOW
from website.other_plugins import BLOCKED

pytest_plugins = ["pytester"]


@pytest.hookimpl(tryfirst=True)  # before Hypothesis reads its options
def pytest_configure(config: pytest.Config) -> None:
    """Load the profile of Hypothesis; handle Ctrl-C even if a script started pytest in the background.

    Hypothesis runs the same examples every time, unless a run has a seed. It has no deadline, since a loaded machine is
    not a defect, and keeps no examples, so that a seed always draws the same ones.
    """
    given = getattr(config.option, "hypothesis_seed", None)  # the plugin of Hypothesis may be blocked
    if SEED and given is None:
        config.option.hypothesis_seed = str(SEED)
    settings.register_profile(
        "tarl",
        max_examples=100 if SLOW else 40,
        deadline=None,
        derandomize=not SEED and given is None,
        database=None,
        suppress_health_check=[HealthCheck.too_slow],
    )
    settings.load_profile("tarl")
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_sessionstart(session: pytest.Session) -> None:
    """Print the seed, also with `-q`."""
    terminal = session.config.pluginmanager.get_plugin("terminalreporter")
    if SEED and terminal is not None and not hasattr(session.config, "workerinput"):
        terminal.write_line(f"random cases: repeat them with TARL_SEED={SEED}")


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
