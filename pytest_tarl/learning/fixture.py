"""The recording of a test: `--tarl-record` writes it, `--tarl-online` reads it.

A recording is a single `.npz` file, loaded without pickle: a JSON header with a format version and a hash, and the
packed columns of the statistics. It is written to a temporary file first and then renamed. Equal episodes give equal
bytes.

Format versions: 1 Columns of float64. 2 Sums as logarithms (packing.py), which take a sixth of the size; Σ|f| per
episode and site. If the test has formulas, the header also has `formulas` and `signals`, and there are columns
`robustness` and `lost`. Older readers of format 2 ignore these additions. They also ignore `stated` (bounds) and
`world` (hashes of the test's modules).
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from pytest_tarl.errors import FixtureError
from pytest_tarl.files import advice_on, check_writable, read_regular
from pytest_tarl.formulas.signals import Signal
from pytest_tarl.learning.archive import DamagedError, TooLargeError, numbers, read_arrays
from pytest_tarl.learning.packing import (
    narrowed,
    packed_chain,
    packed_list,
    packed_table,
    unpacked_chain,
    unpacked_list,
    unpacked_table,
)
from pytest_tarl.learning.soundness import check
from pytest_tarl.learning.tables import Floats, Judgements, Sample
from pytest_tarl.model import Bound, Guarantee, SitePlace, TaintList
from pytest_tarl.sensors import Sensor
from tarl_lint.files import write_atomically

FORMAT_VERSION = 2
HEADER = "header"
RECORD_AGAIN = "Record it again with `pytest --tarl-record`."
TUPLES = ("categories", "edges")  # fields of a sensor that are tuples, which JSON stores as lists


@dataclass(frozen=True)
class Fixture:
    """The recording of a test; `sarsa` has the learned table of each taint list, shape (cells, sites).

    A taint list names the statements (sites) that a message passes on its way from a source to a sink.
    """

    test: str
    seed: int
    sensors: tuple[Sensor, ...]
    lists: tuple[TaintList, ...]
    topics: Mapping[str, str]  # sensor topic → message type
    sample: Sample
    sarsa: tuple[Floats, ...]
    learner: str = "sarsa"  # name of the learning rule, a key of sarsa.LEARNERS
    design: tuple[str, ...] = ()  # names of permanent drifts that belong to the design
    signals: tuple[Signal, ...] = ()  # signals from messages that formulas use
    stated: Guarantee | None = None
    # file → definition → hash (see modules_of_tests.py)
    world: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def statements(self) -> list[tuple[str, str, list[str]]]:
        """Return the source, the sink, and the ids of the statements of each taint list."""
        return [(one.source, one.sink, [place.id for place in one.sites]) for one in self.lists]


def save(fixture: Fixture, path: Path) -> None:
    """Write the recording atomically. Raise FixtureError if it cannot be written."""
    columns = _columns(fixture)
    header = {
        "format": FORMAT_VERSION,
        "test": fixture.test,
        "seed": fixture.seed,
        "learner": fixture.learner,
        "sensors": [asdict(sensor) for sensor in fixture.sensors],
        "lists": [asdict(taint_list) for taint_list in fixture.lists],
        "topics": dict(sorted(fixture.topics.items())),
        "seeds": [str(seed) for seed in fixture.sample.seeds],
        "parts": list(fixture.sample.part_names),
    }
    if fixture.design:
        header["design"] = list(fixture.design)
    if fixture.sample.judgements is not None:
        header["formulas"] = list(fixture.sample.judgements.formulas)
        header["signals"] = [asdict(signal) for signal in fixture.signals]
    if fixture.stated is not None:
        header["stated"] = asdict(fixture.stated)
    if fixture.world:
        header["world"] = {path: dict(found) for path, found in fixture.world.items()}
    header["digest"] = _digest(header, columns)
    text = np.frombuffer(json.dumps(header, ensure_ascii=False, sort_keys=True).encode(), dtype=np.uint8)
    buffer = io.BytesIO()
    arrays: dict[str, Any] = {HEADER: text, **columns}
    np.savez_compressed(buffer, **arrays)  # pass no options: numpy before 2.1 stores them as arrays
    try:
        write_atomically(path, buffer.getvalue(), parents=True)
    except OSError as problem:
        raise _unwritable(path, problem) from problem


def prepare(path: Path) -> None:
    """Check that the recording can be written. Raise FixtureError if it cannot."""
    try:
        check_writable(path)
    except OSError as problem:
        raise _unwritable(path, problem) from problem


def _unwritable(path: Path, problem: OSError) -> FixtureError:
    return FixtureError(f"{path} cannot be written ({problem.strerror}):", advice_on(problem))


def load(path: Path) -> Fixture:
    """Read a recording. Raise FixtureError if it cannot be read."""
    try:
        content = read_regular(path)
    except FileNotFoundError:
        raise FixtureError(f"{path}: no such recording.", RECORD_AGAIN) from None
    except IsADirectoryError:
        raise FixtureError(f"{path} is a folder.", "Name a file in it, such as NAME.npz.") from None
    except OSError as problem:
        raise FixtureError(
            f"The recording {path} cannot be read: {problem.strerror}.", RECORD_AGAIN
        ) from problem
    return parsed(content, str(path))


def parsed(content: bytes, path: str) -> Fixture:
    """Return the recording from a file's content; `path` is the file's name in messages.

    Raise FixtureError if the file is damaged, too large for the memory, or in another format.
    """
    try:
        columns = read_arrays(content)
        header = json.loads(numbers(columns, HEADER, None).tobytes().decode())
        del columns[HEADER]
        found = header["format"]
    except TooLargeError as problem:
        raise FixtureError(
            f"The recording {path} {problem}.",
            "Read it on a machine with more memory, or record fewer episodes with --tarl-episodes.",
        ) from problem
    except Exception as problem:  # damaged zip, npy and JSON raise undocumented exceptions
        raise FixtureError(
            f"The recording {path} is damaged or is not a recording{_why(problem)}.",
            "Restore it from version control, or record it again with `pytest --tarl-record`.",
        ) from problem
    if found != FORMAT_VERSION:
        newer = isinstance(found, int) and found > FORMAT_VERSION
        what = "Use the version of tarl that recorded it, or record" if newer else "Record"
        raise FixtureError(
            f"The recording {path} has format {str(found)[:20]}, but this version of tarl reads "
            f"{FORMAT_VERSION}.",
            f"{what} it again with `pytest --tarl-record`.",
        )
    try:
        if header.pop("digest", None) != _digest(header, columns):
            raise FixtureError(
                f"The recording {path} is damaged: its digest does not match its content.", RECORD_AGAIN
            )
        with np.errstate(all="ignore"):
            fixture = _fixture(header, columns)
            check(fixture.sample, len(fixture.sensors), fixture.sarsa)
    except FixtureError:
        raise
    except Exception as problem:  # content can be invalid even if the digest matches
        raise FixtureError(
            f"The recording {path} is not valid in format {FORMAT_VERSION}{_why(problem)}.",
            RECORD_AGAIN,
        ) from problem
    return fixture


def _why(problem: Exception) -> str:
    if isinstance(problem, MemoryError):
        return " (or there is too little memory to read it)"
    return f" ({problem})" if isinstance(problem, DamagedError) else ""


def sizes(path: Path, lists: int) -> tuple[int, ...]:
    """Return the size on disk of each taint list's columns, in bytes."""
    with ZipFile(path) as archive:
        entries = archive.infolist()
    return tuple(
        sum(
            one.compress_size
            for one in entries
            if one.filename.partition(".")[0] in (f"list{i}", f"sarsa{i}")
        )
        for i in range(lists)
    )


def _columns(fixture: Fixture) -> dict[str, np.ndarray[Any, Any]]:
    sample = fixture.sample
    width = len(fixture.sensors)
    columns: dict[str, np.ndarray[Any, Any]] = {
        "cells": narrowed(np.array(sample.cells, dtype=np.int64).reshape(len(sample.cells), width)),
        "passed": sample.passed,
        "total": sample.total,
        "steps": narrowed(sample.steps),
    }
    if sample.judgements is not None:
        columns |= {"robustness": sample.judgements.robustness, "lost": sample.judgements.lost}
    columns |= packed_chain(sample.chain)
    for i, one in enumerate(sample.lists):
        columns |= packed_list(f"list{i}", one) | packed_table(f"sarsa{i}", fixture.sarsa[i])
    return columns


def _digest(header: Mapping[str, Any], columns: Mapping[str, np.ndarray[Any, Any]]) -> str:
    digest = hashlib.sha256(json.dumps(header, ensure_ascii=False, sort_keys=True).encode())
    for name in sorted(columns):
        digest.update(f"{name}:{columns[name].dtype.str}:{columns[name].shape}".encode())
        digest.update(np.ascontiguousarray(columns[name]).tobytes())
    return digest.hexdigest()


def _fixture(header: Mapping[str, Any], columns: Mapping[str, np.ndarray[Any, Any]]) -> Fixture:
    _check_header(header)
    lists = tuple(
        TaintList(one["source"], one["sink"], tuple(SitePlace(**site) for site in one["sites"]))
        for one in header["lists"]
    )
    sensors = tuple(
        Sensor(**one | {name: tuple(one.get(name, ())) for name in TUPLES}) for one in header["sensors"]
    )
    return Fixture(
        test=header["test"],
        seed=header["seed"],
        learner=header["learner"],
        design=tuple(header.get("design", ())),
        signals=tuple(Signal(**one) for one in header.get("signals", ())),
        stated=_guarantee(header["stated"]) if "stated" in header else None,
        world=header.get("world", {}),
        sensors=sensors,
        lists=lists,
        topics=header["topics"],
        sample=Sample(
            cells=tuple(tuple(row) for row in columns["cells"].tolist()),
            seeds=tuple(int(seed) for seed in header["seeds"]),
            passed=columns["passed"],
            total=columns["total"],
            steps=columns["steps"].astype(np.int64),
            part_names=tuple(header["parts"]),
            chain=unpacked_chain(columns),
            lists=tuple(unpacked_list(f"list{i}", columns, len(one.sites)) for i, one in enumerate(lists)),
            judgements=_judgements(header, columns),
        ),
        sarsa=tuple(unpacked_table(f"sarsa{i}", columns) for i in range(len(lists))),
    )


def _guarantee(told: Mapping[str, Any]) -> Guarantee:
    """Return the bounds in a header. Raise DamagedError if they are not numbers."""
    declared = None if told.get("declared") is None else tuple(told["declared"])
    bounds = {"success": Bound(**told["success"]), "mean": Bound(**told["mean"])}
    found = Guarantee(**{**told, **bounds, "declared": declared})
    numbers = [
        *(
            getattr(bound, name)
            for bound in (found.success, found.mean)
            for name in ("low", "high", "confidence")
        ),
        *(found.average, found.share, found.episodes, found.passed, found.needed),
        *(() if found.quantile is None else (found.quantile,)),
        *((found.declared or ()) if len(found.declared or (0, 0)) == 2 else (None,)),
    ]
    texts = [found.success.method, found.mean.method]
    if not all(type(one) in (int, float) for one in numbers) or not all(type(one) is str for one in texts):
        raise DamagedError("the bounds in its header are not numbers")
    return found


def _judgements(header: Mapping[str, Any], columns: Mapping[str, np.ndarray[Any, Any]]) -> Judgements | None:
    formulas = tuple(header.get("formulas", ()))
    if not formulas:
        return None
    return Judgements(formulas, columns["robustness"], columns["lost"])


def _check_header(header: Mapping[str, Any]) -> None:
    """Raise DamagedError if a value in the header has the wrong type."""
    plain = [
        header["test"],
        header["learner"],
        *header["topics"],
        *header["topics"].values(),
        *header["parts"],
        *header.get("design", []),
        *header.get("formulas", []),
    ]
    for path, found in dict(header.get("world", {})).items():
        plain += [path, *found, *found.values()]
    plain += [text for one in header["lists"] for text in (one["source"], one["sink"])]
    plain += [
        site[name]
        for one in header["lists"]
        for site in one["sites"]
        for name in ("id", "path", "code", "dependence", "role", "qualname")
    ]
    lines = [header["seed"], *(site["line"] for one in header["lists"] for site in one["sites"])]
    listed = all(
        isinstance(header.get(name, []), list) for name in ("parts", "design", "formulas", "signals")
    )
    if (
        not listed
        or not all(type(text) is str for text in plain)
        or not all(type(line) is int for line in lines)
    ):
        raise DamagedError("its header does not describe a recording")
