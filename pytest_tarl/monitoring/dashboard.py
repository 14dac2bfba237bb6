"""Write the status of `tarl watch` as JSON (see `watch.schema.json`)."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path
from typing import Any

from pytest_tarl.errors import MonitorError
from pytest_tarl.monitoring.status import Evidence, Moment, Status
from pytest_tarl.monitoring.watch import Watch
from pytest_tarl.report.sensor_regions import Vocabulary
from tarl_lint.files import write_atomically

FORMAT_VERSION = 1  # 1: first version


def write(document: dict[str, Any], path: Path) -> None:
    """Write a document atomically. Raise MonitorError if the file cannot be written."""
    try:
        text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
        write_atomically(path, f"{text}\n".encode(), parents=True)
    except OSError as problem:
        raise MonitorError(
            f"{path} cannot be written ({problem.strerror}): name another file with --json."
        ) from problem


def line(document: dict[str, Any]) -> str:
    """Return a document as one line of ASCII, which is safe to print on a terminal."""
    return json.dumps(document, allow_nan=False)


def schema() -> dict[str, Any]:
    """Return the JSON schema of the document."""
    loaded: dict[str, Any] = json.loads(
        resources.files(__package__).joinpath("watch.schema.json").read_text("utf-8")
    )
    return loaded


def document(watch: Watch, status: Status) -> dict[str, Any]:
    """Return the status as JSON-compatible values.

    Evidence is given as log10; -log10(alpha) raises an alarm.
    """
    words = Vocabulary(watch.fixture.sensors, {*watch.fixture.sample.cells, *status.new})
    lead = status.lead
    return {
        "format": FORMAT_VERSION,
        "test": watch.fixture.test,
        "fixture": watch.digest,
        "missions": status.missions,
        "passed": status.passed,
        "alpha": status.alpha,
        "error": status.error,
        "alarm": status.alarm,
        "bounds": [
            {
                "of": bound.what,
                "at_least": bound.least,
                "confidence": bound.confidence,
                "evidence": _evidence(evidence),
            }
            for bound, evidence in status.bounds
        ],
        "world": {
            "evidence": _evidence(status.world),
            "lead": lead
            and {
                "score": lead.name,
                "cell": None if lead.cell is None else list(lead.cell),
                "side": lead.side,
            },
        },
        "where": {
            "words": words.words(status.cells) if status.cells else "",
            "cells": [list(cell) for cell in status.cells],
            "new": [list(cell) for cell in status.new],
        },
        "logs": [
            {"path": one.path, "missions": one.missions, "unfinished": one.unfinished}
            for one in watch.known.values()
        ],
        "problems": list(watch.problems),
        "notes": list(status.notes),
    }


def _evidence(found: Evidence | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {
        "log10_now": found.now,
        "log10_highest": found.highest,
        "since": _moment(found.since),
        "alarm": _moment(found.alarm),
    }


def _moment(found: Moment | None) -> dict[str, Any] | None:
    return None if found is None else {"mission": found.mission, "time": found.time}
