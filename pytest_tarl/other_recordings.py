"""Notes on recordings of other tests that run the same node, and on drifts of the design."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from pathlib import Path

from pytest_tarl.design import replaced
from pytest_tarl.designation import Designation
from pytest_tarl.errors import FixtureError
from pytest_tarl.instrumentation.sites import Plan
from pytest_tarl.learning import fixture as fixtures
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.model import Repair


def adopted(run: Mapping[str, Designation], tarl: Path, recording: Path, sites: Plan) -> Iterator[str]:
    """Yield lines that name the new design, and the node's other tests that still use the old one.

    `run` has the other tests of this run, `tarl` is the folder `.tarl`, and `recording` is the new recording.
    """
    new = fixtures.load(recording)
    design = new.design
    if not design:
        return
    named = " and ".join(repr(name) for name in design)
    yield f"  the design now includes the drift {named}: runs without flags get it as tarl_drift, too"
    nodes = {place.path for place in sites.places}
    # tests that this run records under the same drift
    recorded = {test for test, other in run.items() if {*design} <= other.drifts.keys()}
    for path in sorted((tarl / "utility").glob("*.npz")):
        with suppress(FixtureError):
            other = fixtures.load(path)
            paths = {site.path for one in other.lists for site in one.sites}
            known = other.test == new.test or other.test in recorded
            if not known and paths & nodes and not {*design} <= {*other.design}:
                yield (
                    f"  {other.test} has a recording of the same node in the old world: declare {named} there, "
                    "too, and record it under that drift"
                )


def lost_design(designation: Designation, fixture: Fixture, drift: str | None) -> Iterator[str]:
    """Yield a note if a scenario replaces the design's drift because the two cannot be merged."""
    lost = replaced(designation.drifts, fixture.design, drift)
    if lost:
        yield (
            f"the design has the drift {lost!r}, but tarl_drift held only {drift!r}: write both as "
            "dictionaries, so that TARL merges them"
        )


def unchecked(found: Repair | None, run: Collection[str], tarl: Path) -> Iterator[str]:
    """Yield a note for each recorded test that runs a repaired file and was not used to check the repair.

    `run` has the names of this run's tests, and `tarl` is the folder `.tarl`.
    """
    if found is None or not found.accepted:
        return
    edited = {edit.path for edit in found.edits}
    for path in sorted((tarl / "utility").glob("*.npz")):
        try:
            fixture = fixtures.load(path)
        except FixtureError as problem:
            yield (
                f"{problem.what} If the test of this recording runs the same node, the repair was not checked "
                "on that test"
            )
            continue
        sites = {site.path for one in fixture.lists for site in one.sites}
        if fixture.test not in run and sites & edited:
            yield f"{fixture.test} has a recording of the same node but was not in this run: run it, too"
