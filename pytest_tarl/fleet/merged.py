"""`tarl merge`: merge recordings and logs of several robots into one recording.

Every row of a recording belongs to one episode, so all rows together are the recording of all episodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pytest_tarl.errors import FixtureError
from pytest_tarl.fleet.logged_samples import checked
from pytest_tarl.learning.bounds import Range
from pytest_tarl.learning.fixture import Fixture, load
from pytest_tarl.learning.guarantees import stated, varies
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.tables import Floats, Sample
from pytest_tarl.learning.utility import batch
from pytest_tarl.model import Guarantee
from pytest_tarl.observing.log_format import MAGIC


@dataclass(frozen=True)
class Part:
    """A merged file and its number of episodes, some of which may also be in earlier files."""

    path: Path
    episodes: int
    known: int


def merged(files: Sequence[Path], fixture: Path | None = None) -> tuple[Fixture, tuple[Part, ...]]:
    """Return the recording of all episodes and missions, and what each file contributed.

    Logs are read with the sensors and statements of the first recording, or of `fixture` if given. The episodes of
    `fixture` are not added. Duplicate episodes count once. Raise FixtureError or LogError if a file cannot be read or
    does not fit the others.
    """
    recordings = {path: load(path) for path in files if not _is_log(path)}
    first = fixture or next(iter(recordings), None)
    if first is None:
        raise FixtureError(
            "A log does not state the bins of the sensors.",
            "Use --fixture FILE to name the recording that `tarl observe` used on the robots.",
        )
    design = recordings.get(first) or load(first)
    for path, one in recordings.items():
        _check(first, design, path, one)
    samples = [[recordings[path].sample] if path in recordings else checked(path, design) for path in files]
    parts = tuple(_parts(files, samples))
    whole = merge([one for some in samples for one in some])
    return _recording(design, [*recordings.values()], whole), parts


def _is_log(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return file.read(len(MAGIC)) == MAGIC
    except OSError:
        # an unreadable file is then loaded as a recording, which raises an error with the reason
        return False


def _parts(files: Sequence[Path], samples: Sequence[Sequence[Sample]]) -> Iterator[Part]:
    seen: set[int] = set()
    for path, some in zip(files, samples, strict=True):
        seeds = [seed for one in some for seed in one.seeds]
        yield Part(path, len(seeds), len(seeds) - len({*seeds} - seen))
        seen |= {*seeds}


def _check(first: Path, design: Fixture, path: Path, other: Fixture) -> None:
    """Raise FixtureError if two recordings cannot be merged."""
    differing = {
        "test": (design.test, other.test),
        "sensors or bins": (design.sensors, other.sensors),
        "statements": (design.statements, other.statements),
        "signals": (design.signals, other.signals),
        "permanent drifts": (design.design, other.design),
    }
    found = [name for name, (one, another) in differing.items() if one != another]
    if found:
        raise FixtureError(
            f"{path} and {first} cannot be merged: they differ in their {' and '.join(found)}.",
            "Merge recordings of the same test, node and sensors; record the older one again.",
        )


def _recording(design: Fixture, recordings: Sequence[Fixture], whole: Sample) -> Fixture:
    """Return the recording of all episodes; hashes of modules that differ are omitted."""
    worlds = [one.world for one in recordings] or [design.world]
    world = {path: found for path, found in worlds[0].items() if all(w.get(path) == found for w in worlds)}
    return replace(
        design,
        sample=whole,
        sarsa=utilities(whole),
        topics={key: value for one in recordings or [design] for key, value in one.topics.items()},
        stated=_stated(design.stated, whole),
        world=world,
    )


def utilities(whole: Sample) -> tuple[Floats, ...]:
    """Return the utility of each taint list, shape (cells, sites), as the fixed point of SARSA.

    Episodes of several robots have no common order, so step-by-step learning is not possible.
    """
    return tuple(batch(one, len(whole.cells), one.mean_flow) for one in whole.lists)


def _stated(before: Guarantee | None, whole: Sample) -> Guarantee | None:
    """Return bounds for future episodes from all episodes together, at the recording's confidence.

    Raise FixtureError if a total is outside the declared range.
    """
    if before is None:
        return None
    least, most = float(whole.total.min()), float(whole.total.max())
    if before.declared and not before.declared[0] <= least <= most <= before.declared[1]:
        low, high = before.declared
        raise FixtureError(
            f"The episodes earn {least:g} to {most:g}, but the recording states total_range=({low:g}, {high:g}).",
            "Correct total_range on the marker and record again.",
        )
    return stated(
        whole.passed.tolist(),
        whole.total.tolist(),
        confidence=before.success.confidence,
        declared=Range(*before.declared) if before.declared else None,
        anytime=before.needed == 0,
        varied=varies(whole),
    )


def lines(to: Path, recording: Fixture, parts: Sequence[Part]) -> Iterator[str]:
    """Yield lines that describe what was merged."""
    for one in parts:
        known = f", {one.known} of them already counted" if one.known else ""
        yield f"  {one.path}: {one.episodes} episodes{known}"
    sample = recording.sample
    yield f"{to}: {sample.episodes} episodes of {recording.test}, {len(sample.cells)} cells"
