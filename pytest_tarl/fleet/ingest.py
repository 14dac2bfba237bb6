"""`tarl ingest`: add the missions of logs and bags to a data set, each mission once."""

from __future__ import annotations

import hashlib
import hmac
import json
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytest_tarl.errors import LogError, RepairError, SettingsError
from pytest_tarl.fleet import dataset
from pytest_tarl.fleet.bag_missions import Replay, identified, is_bag, replayed
from pytest_tarl.fleet.data_folder import Store, store
from pytest_tarl.fleet.logged_samples import logged_samples
from pytest_tarl.fleet.mission_rows import Row, date, files, formulas_of
from pytest_tarl.fleet.schema import TABLES, Origin, origin, partition, repair_path
from pytest_tarl.learning.fixture import Fixture, load
from pytest_tarl.monitoring.assembling import valid_time
from pytest_tarl.patching.patch_reader import read

TOGETHER = 20_000  # number of missions held in memory before they are written
PATCH = ".patch"
REPAIRS_KEEP = ("test", "drift")
FOLDER, FILE = "{folder}", "{file}"


@dataclass(frozen=True)
class Order:
    """The arguments of the command line."""

    logs: tuple[Path, ...]
    to: str
    fixture: Path
    robot: str  # {folder} and {file} are replaced by the names of a log's folder and file
    version: str = "unknown"
    site: str = "unknown"
    salt: str = ""  # if given, robot names are replaced by salted hashes
    repair: str = ""  # name of the repair that the robots run, or of a patch file in .tarl/patches
    replay: Replay | None = None  # replays bags


@dataclass(frozen=True)
class Ingested:
    """How many new and known missions a log has, or why it was not read."""

    log: Path
    robot: str
    missions: int = 0
    known: int = 0
    problem: str = ""
    unjudged: int = 0  # number of missions in which some formula of the recording has no verdict
    notes: tuple[str, ...] = ()  # notes on the replay of a bag


def ingest(order: Order) -> Iterator[Ingested]:
    """Add the missions of all logs; yield the result for each log.

    Logs that do not fit the recording are skipped. Raise FixtureError, FleetError or SettingsError if no log can be
    added.
    """
    _check(order)
    fixture = load(order.fixture)
    recording = order.fixture.read_bytes()
    into = _Writer(store(order.to), order.version, origin(fixture, recording), fixture, recording)
    repair = repair_of(order.repair)
    keep_origin(into.store, order.repair, repair)
    for log in order.logs:
        robot = named(order, log)
        try:
            if is_bag(log):
                yield _bag(order, log, robot, repair, into)
                continue
            rows = list(_rows(log, fixture, robot, order.site, repair))
            added = into.add(rows)
        except LogError as problem:
            yield Ingested(log, robot, problem=str(problem))
            continue
        yield Ingested(log, robot, added, len(rows) - added, unjudged=_unjudged(rows, fixture))
    into.write()


def _bag(order: Order, log: Path, robot: str, repair: str, into: _Writer) -> Ingested:
    """Replay a bag and add its mission, unless it is already known. Raise LogError on failure."""
    found = identified(log, into.fixture)
    time = valid_time(found.time)
    if into.holds(date(time), found.mission, robot):
        return Ingested(log, robot, known=1)
    if order.replay is None:
        raise SettingsError(f"{log} is a bag, but no way to replay it was given.")
    sample, notes = replayed(log, found.mission, into.fixture, order.replay)
    row = Row(robot, order.site, time, sample, repair)
    into.add([row])
    return Ingested(log, robot, 1, unjudged=_unjudged([row], into.fixture), notes=notes)


def _unjudged(rows: Sequence[Row], fixture: Fixture) -> int:
    formulas = fixture.sample.judgements.formulas if fixture.sample.judgements else ()
    return sum(len(formulas_of(row.sample)) < len(formulas) for row in rows)


def repair_of(name: str) -> str:
    """Return the name of a repair; for a patch file, this is its name without the suffix.

    Raise SettingsError if there is no such file.
    """
    if not name.endswith(PATCH):
        return name.strip()
    if not Path(name).is_file():
        raise SettingsError(
            f"{name}: no such patch. Give --repair a file of .tarl/patches or the name of a repair."
        )
    return Path(name).stem


def named(order: Order, log: Path) -> str:
    """Return the robot name to store for a log."""
    name = order.robot.replace(FOLDER, log.resolve().parent.name).replace(FILE, log.stem)
    if not order.salt:
        return name
    return hmac.new(order.salt.encode(), name.encode(), hashlib.sha256).hexdigest()[:16]


def keep_origin(to: Store, given: str, repair: str) -> None:
    """Store the test and the drift of an accepted patch, but not the patch itself."""
    if not given.endswith(PATCH):
        return
    try:
        facts = dict(read(Path(given)).facts)
    except RepairError:
        return  # the patch is not TARL's, so only its name is known
    known = {key: facts[key] for key in REPAIRS_KEEP if key in facts}
    to.write(repair_path(repair), json.dumps(known, ensure_ascii=False, sort_keys=True).encode())


@dataclass
class _Writer:
    """Collect new missions and write them in batches."""

    store: Store
    version: str
    origin: Origin
    fixture: Fixture
    recording: bytes
    rows: dict[str, list[Row]] = field(default_factory=lambda: defaultdict(list))  # day → its rows
    known: dict[str, dict[int, str]] = field(default_factory=dict)  # day → mission → its robot
    waiting: int = 0

    def add(self, rows: Sequence[Row]) -> int:
        """Queue the missions that are not in the data set yet; return their number.

        Raise LogError if one of the missions is already stored for another robot.
        """
        for row in rows:
            self.holds(row.date, row.mission, row.robot)
        before = self.waiting
        for row in rows:
            held = self._held(row.date)
            if row.mission not in held:
                held[row.mission] = row.robot
                self.rows[row.date].append(row)
                self.waiting += 1
        added = self.waiting - before
        if self.waiting >= TOGETHER:
            self.write()
        return added

    def holds(self, day: str, mission: int, robot: str) -> bool:
        """Return whether a robot's mission is already stored or queued.

        Raise LogError if the mission belongs to another robot.
        """
        other = self._held(day).get(mission)
        if other is not None and other != robot:
            raise LogError(
                f"A mission of {robot} is already in {self.store.shown('')}, as a mission of {other}: correct "
                f"--robot, or delete the files of {other} and ingest its logs again."
            )
        return other is not None

    def _held(self, day: str) -> dict[int, str]:
        """Return mission ID → robot for all missions of a day."""
        if day not in self.known:
            found = dataset.known(self.store, self.origin.folder, day)
            self.known[day] = dict(found)
        return self.known[day]

    def write(self) -> None:
        """Write the recording, then the queued missions, with one set of files per day."""
        if self.rows and not self.store.holds(kept := f"recordings/{self.origin.recording}.npz"):
            self.store.write(kept, self.recording)
        for day, rows in sorted(self.rows.items()):
            name, contents = files(rows, self.origin, self.fixture.lists)
            for table in TABLES:
                path = f"{table}/{partition(self.origin, self.version, day)}/{name}.parquet"
                self.store.write(path, contents[table])
        self.rows.clear()
        self.waiting = 0


def _rows(log: Path, fixture: Fixture, robot: str, site: str, repair: str) -> Iterator[Row]:
    for time, sample in logged_samples(log, fixture):
        yield Row(robot, site, valid_time(time), sample, repair)


def _check(order: Order) -> None:
    for name, value in (("robot", order.robot), ("version", order.version), ("site", order.site)):
        if not value.strip():
            raise SettingsError(f"--{name} is empty: give it a name.")
    parts = (FOLDER in order.robot) or (FILE in order.robot)
    if len(order.logs) > 1 and not parts:
        raise SettingsError(
            f"--robot {order.robot} would be the robot of all {len(order.logs)} logs: use --robot {FOLDER} to name "
            f"each robot by the folder of its log, {FILE} by the name of its log, or ingest one log at a time."
        )
