"""Damaged and forged recordings give one sentence or valid data, never a traceback, and can be replaced."""

from __future__ import annotations

import io
import json
import os
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from pytest_tarl.commands import diff, show
from pytest_tarl.design import adopted
from pytest_tarl.errors import FixtureError
from pytest_tarl.learning import fixture as fixtures
from pytest_tarl.learning.fixture import load, save, sizes
from tests.plugin.learning.test_fixture import example as sound_fixture

TIMES = 3000 if os.environ.get("TARL_SLOW") else 80
FUZZ = settings(max_examples=TIMES, deadline=None, suppress_health_check=[HealthCheck.too_slow])
Arrays = dict[str, np.ndarray[Any, Any]]


def _whole() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        save(sound_fixture(), Path(folder, "a.npz"))
        return Path(folder, "a.npz").read_bytes()


WHOLE = _whole()


def parts(content: bytes = WHOLE) -> tuple[dict[str, Any], Arrays]:
    """Return header and columns of a recording."""
    with np.load(io.BytesIO(content)) as archive:
        columns = dict(archive)
    return json.loads(columns.pop("header").tobytes()), columns


def forged(header: dict[str, Any], columns: Arrays) -> bytes:
    """Return a recording file with this header and these columns and a valid digest."""
    header = {key: value for key, value in header.items() if key != "digest"}
    header["digest"] = fixtures._digest(header, columns)
    return archived(header, columns)


def archived(header: dict[str, Any], columns: Arrays) -> bytes:
    """Return a recording file with exactly this header and these columns."""
    text = np.frombuffer(json.dumps(header, ensure_ascii=False, sort_keys=True).encode(), dtype=np.uint8)
    buffer = io.BytesIO()
    np.savez_compressed(buffer, header=text, **columns)
    return buffer.getvalue()


def loaded(path: Path) -> fixtures.Fixture | FixtureError:
    try:
        return load(path)
    except FixtureError as refused:
        return refused


def survived(content: bytes) -> bytes | None:
    """Load a recording and use it as `tarl show` and `tarl diff` do; return how it is saved again, None if refused."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.npz")
        path.write_bytes(content)
        found = loaded(path)
        assert all(isinstance(name, str) for name in adopted(path))
        if isinstance(found, FixtureError):
            assert "--tarl-record" in str(found)
            assert "\n" not in str(found)
            assert found.what.endswith(".")
            return None
        shown = list(show.lines(found, len(content), sizes(path, len(found.lists)), every=True))
        assert shown
        assert list(diff.lines(found, found, diff.compared(found, found)))
        save(found, path)
        return path.read_bytes()


@FUZZ
@given(st.integers(0, len(WHOLE) * 8 - 1))
@example(WHOLE.index(b"PK\x01\x02") * 8 + 8 * 8)  # damaged flags of a zip member raise NotImplementedError
@example(WHOLE.index(b"PK\x01\x02") * 8 + 10 * 8 + 1)  # damaged compression method of a zip member
def test_recording_with_a_flipped_bit_is_refused_or_unchanged(bit: int) -> None:
    content = bytearray(WHOLE)
    content[bit // 8] ^= 1 << bit % 8
    assert survived(bytes(content)) in (None, WHOLE)


def test_numbers_changed_within_their_range_are_refused() -> None:
    header, columns = parts()
    assert survived(archived(header, columns)) == WHOLE
    for name, column in columns.items():
        if column.size:
            changed = column.copy()
            changed.ravel()[0] += 1
            assert survived(archived(header, {**columns, name: changed})) is None


@FUZZ
@given(st.integers(0, len(WHOLE)), st.binary(max_size=30), st.integers(0, 30))
def test_truncated_recording_is_refused_or_unchanged(at: int, put: bytes, skipped: int) -> None:
    assert survived(WHOLE[:at] + put + WHOLE[at + skipped :]) in (None, WHOLE)


def stored(**members: bytes) -> bytes:
    """Return the recording with some zip members replaced."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(WHOLE)) as old, zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            new.writestr(name, members.pop(name.removesuffix(".npy"), old.read(name)))
        for name, content in members.items():
            new.writestr(name, content)
    return buffer.getvalue()


def npy(header: str, body: bytes = b"") -> bytes:
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() + body


def header_of(shape: str, kind: str = "'<i8'") -> bytes:
    return npy(f"{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}}}\n")


DAMAGED: dict[str, Callable[[], bytes]] = {
    "empty": lambda: b"",
    "text": lambda: b"hello",
    "huge shape": lambda: stored(steps=header_of("(1000000000000,)")),
    "many huge dimensions": lambda: stored(steps=header_of("(10000000000, 10000000000, 10000000000)")),
    "negative dimensions": lambda: stored(steps=header_of("(-1, -8)")),
    "no tuple": lambda: stored(steps=header_of("3")),
    "unended token": lambda: stored(steps=npy("{'descr': '''")),
    "deep header": lambda: stored(steps=npy("(" * 5000 + ")" * 5000)),
    "objects": lambda: stored(steps=header_of("(1,)", "'|O'")),
    "records": lambda: stored(steps=header_of("(1,)", "[('a', '<i8')]")),
    "texts": lambda: stored(steps=header_of("(0,)", "'<U5'")),
    "not an array": lambda: stored(steps=b"these are no steps"),
    "a member that is not an array": lambda: stored(**{"notes.txt": b"hello"}),
    "a folder": lambda: stored(**{"folder/": b""}),
    "no header": lambda: stored(header=b""),
    "header of floats": lambda: stored(header=header_of("(0,)", "'<f8'")),
    "deep JSON": lambda: forged_text(b"[" * 200_000 + b"]" * 200_000),
    "deep JSON inside": lambda: forged_text(
        b'{"format": 2, "digest": "", "test": ' + b"[" * 900 + b"]" * 900 + b"}"
    ),
    "huge number": lambda: forged_text(b'{"format": ' + b"9" * 10_000 + b"}"),
    "list as header": lambda: forged_text(b"[1, 2]"),
    "a format that is a list": lambda: forged_text(b'{"format": [2]}'),
    "bomb": lambda: stored(bomb=npy("", bytes(600_000_000))),
    "many members": lambda: stored(**{f"m{i}": b"" for i in range(3000)}),
    "a name twice": lambda: twice(),
}


def forged_text(text: bytes) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, header=np.frombuffer(text, dtype=np.uint8))
    return buffer.getvalue()


def twice() -> bytes:
    buffer = io.BytesIO(WHOLE)
    with zipfile.ZipFile(buffer, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr("steps.npy", archive.read("steps.npy"))
    return buffer.getvalue()


@pytest.mark.parametrize("kind", DAMAGED)
def test_known_kinds_of_damage_are_reported_in_one_sentence(kind: str) -> None:
    assert survived(DAMAGED[kind]()) is None


VALUES = st.sampled_from([-(2**62), -2, -1, 0, 1, 7, 10**6, 2**62])


@FUZZ
@given(st.data())
def test_inconsistent_recording_is_refused_or_usable(data: st.DataObject) -> None:
    header, columns = parts()
    name = data.draw(st.sampled_from(sorted(columns)))
    column = columns[name]
    match data.draw(st.sampled_from(["value", "cut", "drop", "turn", "type", "empty", "deepen"])):
        case "value" if column.size:
            changed = column.astype(np.int64) if column.dtype.kind in "iu" else column.copy()
            at = data.draw(st.integers(0, column.size - 1))
            values = VALUES if changed.dtype.kind == "i" else st.sampled_from([0, 1, np.nan, np.inf, 1e308])
            changed.ravel()[at] = data.draw(values)
            columns[name] = changed
        case "cut":
            columns[name] = column[..., : column.shape[-1] // 2]
        case "drop":
            del columns[name]
        case "turn":
            columns[name] = column.T
        case "type":
            columns[name] = column.astype(data.draw(st.sampled_from(["f8", "i1", "u8", "?"])))
        case "empty":
            columns[name] = column[:0]
        case _:
            columns[name] = column[None]
    with np.errstate(all="ignore"):
        survived(forged(header, columns))


@pytest.mark.parametrize("kind", ["f8", "f4", "i1", "i8", "u8", ">i8", "?"])
def test_columns_of_another_type_are_refused_or_usable(kind: str) -> None:
    for name in parts()[1]:
        header, columns = parts()
        columns[name] = columns[name].astype(kind)
        with np.errstate(all="ignore"):
            survived(forged(header, columns))


JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 3) | st.floats() | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=5,
)


@FUZZ
@given(st.data())
def test_headers_with_other_values_are_refused_or_usable(data: st.DataObject) -> None:
    header, columns = parts()
    place: Any = header
    key = data.draw(st.sampled_from(sorted(set(header) - {"format", "digest"})))
    while place[key] and isinstance(place[key], dict | list) and data.draw(st.booleans()):
        place = place[key]
        key = data.draw(st.sampled_from(sorted(place) if isinstance(place, dict) else range(len(place))))
    if data.draw(st.booleans()):
        del place[key]
    else:
        place[key] = data.draw(JSON)
    survived(forged(header, columns))


@pytest.mark.parametrize("old", ["bits", "folder"])
def test_damaged_recording_is_reported_before_any_episode(tank: pytest.Pytester, old: str) -> None:
    tank.runpytest("--tarl-record", "--tarl-episodes=4").assert_outcomes(passed=1)
    (path,) = (tank.path / ".tarl" / "utility").glob("*.npz")
    good = path.read_bytes()
    if old == "folder":
        path.unlink()
        path.mkdir()
        done = tank.runpytest("--tarl-record", "--tarl-episodes=4")
        done.assert_outcomes(failed=1)
        done.stdout.fnmatch_lines(
            ["*cannot be written (Is a directory): something other than a regular file is at this path*"]
        )
        assert "replaces it" not in done.stdout.str()
        return
    for broken in (good[: len(good) // 2], DAMAGED["deep JSON"](), DAMAGED["not an array"]()):
        path.write_bytes(broken)
        online = tank.runpytest("--tarl-online", "--tarl-episodes=4")
        online.stdout.fnmatch_lines(["*recording*is damaged*--tarl-record*"])
        assert "Traceback" not in online.stdout.str()
        done = tank.runpytest("--tarl-record", "--tarl-episodes=4")
        done.assert_outcomes(passed=1)
        told = done.stdout.str()
        sentence = "The new recording replaces it."
        assert told.index(sentence) < told.index("recorded ATR")
        assert path.read_bytes() == good
