"""Convert missions of logs to samples; each mission gets an ID computed from its content."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from pytest_tarl.errors import LogError, SettingsError
from pytest_tarl.formulas.lookback import judgeable, looked_back
from pytest_tarl.formulas.marker_arguments import NOTHING_REQUIRED, Requirements
from pytest_tarl.formulas.parsing import formula
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.judgements import judgements
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.logged import Mission, missions, trace

# length of a mission ID in bytes; the ID is stored in the seed's field
BYTES = 8


def logged_samples(log: Path, fixture: Fixture) -> Iterator[tuple[float, Sample]]:
    """Yield start and statistics of each finished mission with rewards, in a log and its rotated files.

    The start is in seconds since 1970. A mission that violates a formula of the recording counts as failed. Raise
    LogError if the log does not fit the recording or has no rewards.
    """
    plan = plan_of(fixture)
    number = {place.id: n for n, place in enumerate(plan.places)}
    required = requirements_of(fixture)
    for mission in missions(log, fixture):
        if mission.ended and any(chunk["step_cell"] for chunk in mission.chunks):
            found = trace(mission, number, fixture, None)
            judged = looked_back(mission.followed, judgeable([mission.followed], required), required)
            passed = mission.passed and not judged.violation
            one = sample(found, identity(mission), passed, plan.members)
            yield mission.time, replace(one, judgements=judgements(judged.judged))


def requirements_of(fixture: Fixture) -> Requirements:
    """Return the formulas of a recording; none if the formula parser does not support this Python version."""
    if fixture.sample.judgements is None:
        return NOTHING_REQUIRED
    sensors = (sensor.name for sensor in fixture.sensors if not sensor.categories)
    names = (*sensors, *(signal.name for signal in fixture.signals))
    try:
        formulas = tuple(formula(fixture.test, text, names) for text in fixture.sample.judgements.formulas)
    except SettingsError:
        return NOTHING_REQUIRED
    return Requirements(signals=fixture.signals, formulas=formulas, names=names)


def plan_of(fixture: Fixture) -> Plan:
    """Return a recording's sites as a plan without source positions."""
    places = {place.id: place for one in fixture.lists for place in one.sites}
    number = {site: n for n, site in enumerate(places)}
    members = tuple(tuple(number[place.id] for place in one.sites) for one in fixture.lists)
    return Plan(fixture.lists, tuple(places.values()), members, {})


def identity(mission: Mission) -> int:
    """Return the ID of a mission; copies of it have the same ID."""
    content = json.dumps(
        [mission.time, mission.passed, mission.failure, [*mission.sites], mission.chunks],
        ensure_ascii=False,
        sort_keys=True,
    )
    return int.from_bytes(hashlib.sha256(content.encode()).digest()[:BYTES], "big")


def checked(log: Path, fixture: Fixture) -> list[Sample]:
    """Return the missions of a log. Raise LogError if there are none."""
    found = [one for _, one in logged_samples(log, fixture)]
    if not found:
        raise LogError(
            f"{log} holds no finished mission with rewards: separate the missions with --mission-topic or --idle, and "
            "check that the reward arrives."
        )
    return found
