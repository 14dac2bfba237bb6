"""Fixtures for the tests of instrumentation."""

from __future__ import annotations

import threading

import pytest

from pytest_tarl.instrumentation import recorder


@pytest.fixture(autouse=True)
def no_threads_of_other_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make recorders ignore the threads that earlier tests left running, such as those of Dask."""
    before, of_tool = set(threading.enumerate()), recorder._of_tool
    monkeypatch.setattr(recorder, "_of_tool", lambda thread: thread in before or of_tool(thread))
