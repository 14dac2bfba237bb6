"""A data set on an S3 server: no failure loses a mission or makes one count twice."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from pytest_tarl.commands.cli import main
from pytest_tarl.errors import FleetError
from pytest_tarl.fleet import json_result
from pytest_tarl.fleet.ingest import Order, ingest
from pytest_tarl.fleet.question import Question, answer
from tests.plugin.fleet import faulty_s3
from tests.plugin.fleet.faulty_s3 import Faults
from tests.plugin.fleet.test_ingest import log, world
from tests.plugin.monitoring import missions

HOW = 'needs moto: pip install "moto[s3]" flask flask-cors'
pytest.importorskip("moto.moto_server.werkzeug_app", reason=HOW)
s3fs = pytest.importorskip("s3fs")

DATA = "s3://fleet/missions"


@pytest.fixture(scope="module")
def server() -> Iterator[tuple[Faults, str]]:
    with faulty_s3.served() as found:
        yield found


@pytest.fixture
def s3(server: tuple[Faults, str], monkeypatch: pytest.MonkeyPatch) -> Iterator[Faults]:
    """Return the faults of a server with an empty bucket, which s3fs finds by the usual variables."""
    import fsspec

    faults, address = server
    faults.next, faults.unlisted = (lambda method, path: ""), []
    for name, value in (("ENDPOINT_URL", address), ("ACCESS_KEY_ID", "a"), ("SECRET_ACCESS_KEY", "b")):
        monkeypatch.setenv(f"AWS_{name}", value)
    short = {"config_kwargs": {"read_timeout": faulty_s3.READ_TIMEOUT, "retries": {"max_attempts": 0}}}
    monkeypatch.setitem(fsspec.config.conf, "s3", short)
    monkeypatch.setattr(s3fs.S3FileSystem, "retries", 3)
    s3fs.S3FileSystem.clear_instance_cache()
    fs = s3fs.S3FileSystem()
    if fs.exists("fleet"):
        fs.rm("fleet", recursive=True)
    fs.mkdir("fleet")
    yield faults
    s3fs.S3FileSystem.clear_instance_cache()


@pytest.fixture(scope="module")
def fleet(tmp_path_factory: pytest.TempPathFactory) -> tuple[Order, str]:
    """Return the order that ingests the logs, and the answer from their data set on this machine."""
    folder = tmp_path_factory.mktemp("fleet")
    test, logs = world(folder)
    order = Order(tuple(logs), str(folder / "local"), test, "{folder}", "1.2", "north")
    list(ingest(order))
    return replace(order, to=DATA), json_result.text(answer(Question(order.to)))


def said(copies: bool = False) -> str:
    found = answer(Question(DATA))
    assert copies or not found.copies
    return json_result.text(replace(found, copies=0))


def test_object_store_equals_a_folder(s3: Faults, fleet: tuple[Order, str]) -> None:
    order, expected = fleet
    assert sum(one.missions for one in ingest(order)) == 15
    assert said() == expected
    assert [(one.missions, one.known) for one in ingest(order)] == [(0, 5)] * 3


@pytest.mark.parametrize("fault", ["503", "lost", "half", "late"])
def test_a_request_that_fails_once_is_repeated(s3: Faults, fleet: tuple[Order, str], fault: str) -> None:
    order, expected = fleet
    seen: set[tuple[str, str]] = set()
    chosen = "/cells/" if fault == "late" else "/"  # each late answer costs a second

    def once(method: str, path: str) -> str:
        if method != "PUT" or chosen not in path or (fault == "late" and seen) or (method, path) in seen:
            return ""
        seen.add((method, path))
        return fault

    s3.next = once
    list(ingest(order))
    assert seen
    s3.next = lambda method, path: ""
    assert said() == expected


@pytest.mark.parametrize("fault", ["503", "expired", "half", "lost"])
def test_failed_ingest_is_completed_by_the_next_run(s3: Faults, fleet: tuple[Order, str], fault: str) -> None:
    order, expected = fleet
    for left in (1, 3, 2):
        puts: list[str] = []

        def failing(method: str, path: str, left: int = left, puts: list[str] = puts) -> str:
            if method == "PUT" and path not in puts:
                puts.append(path)
            return fault if len(puts) > left else ""

        s3.next = failing
        with pytest.raises(FleetError, match="counted twice"):
            list(ingest(order))
        s3.next = lambda method, path: ""
        if fault == "half" and "/missions/test=" in puts[-1]:
            name = puts[-1].removeprefix("/")
            with pytest.raises(FleetError, match=r"is damaged or cannot be read.*delete it and ingest"):
                list(ingest(order))
            s3fs.S3FileSystem().rm(name)
    list(ingest(order))
    assert said() == expected


def test_store_refusal_is_reported_in_one_sentence(
    s3: Faults, fleet: tuple[Order, str], capsys: pytest.CaptureFixture[str]
) -> None:
    order, expected = fleet
    list(ingest(order))
    for fault, path in (("expired", "/cells/"), ("expired", ""), ("503", "/recordings/")):
        s3.next = lambda method, where, fault=fault, path=path: fault if path in where else ""
        assert main(["fleet", DATA]) == 2
        err = capsys.readouterr().err
        assert "s3://fleet/missions" in err
        assert err.count("\n") == 1
    s3.next = lambda method, path: ""
    assert said() == expected


def test_files_missing_from_a_stale_listing_are_counted_once(
    s3: Faults, fleet: tuple[Order, str], tmp_path: Path
) -> None:
    order, expected = fleet
    list(ingest(order))
    s3.unlisted = ["/cells/"]
    assert said() == expected
    s3.unlisted = [".parquet"]
    assert sum(one.missions for one in ingest(order)) == 15  # the same objects again
    logs = [log(tmp_path, f"r{n}", missions.walks(5, 10 + n)[:3]) for n in range(3)]
    list(ingest(replace(order, logs=tuple(logs))))  # a part of the missions, in other objects
    s3.unlisted = []
    assert said(copies=True) == expected
    assert answer(Question(DATA)).copies > 0


@pytest.mark.parametrize("seed", range(2))
def test_random_failures_lose_no_mission(s3: Faults, fleet: tuple[Order, str], seed: int) -> None:
    order, expected = fleet
    random = Random(seed)
    s3.next = lambda method, path: random.choice(["503", "lost", "expired"]) if random.random() < 0.15 else ""
    for _ in range(40):
        try:
            list(ingest(order))
            break
        except FleetError:
            continue
    s3.next = lambda method, path: ""
    list(ingest(order))
    assert said(copies=True) == expected
