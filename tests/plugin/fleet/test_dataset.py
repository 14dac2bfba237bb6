"""Unusual failures of a store are reported in one sentence."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

pytest.importorskip("pyarrow")

from pytest_tarl.errors import FleetError
from pytest_tarl.fleet import dataset
from pytest_tarl.fleet.data_folder import Store


class ClientError(Exception):
    """An error that, like those of HTTP clients, is not an OSError."""


@pytest.mark.parametrize("reads", [False, True])
def test_store_failure_names_the_file(reads: bool) -> None:
    def fail(*_: object) -> None:
        raise ClientError("An HTTP client failed:\n  data after the end")

    file = SimpleNamespace(read=fail, seek=fail, tell=fail, close=lambda: None, closed=False)
    fs = SimpleNamespace(open=(lambda *_: Opened(file)) if reads else fail)
    with pytest.raises(FleetError) as told:
        dataset.columns(Store(fs, "fleet/data", "s3"), "missions/a.parquet", ["mission"])
    text = str(told.value)
    assert text.startswith(
        "s3://fleet/data/missions/a.parquet cannot be read (An HTTP client failed:): check "
    )
    assert "\n" not in text


def test_exception_without_a_message_is_named_by_class() -> None:
    def fail(*_: object) -> None:
        raise TimeoutError

    with pytest.raises(FleetError, match=r"a\.parquet is damaged or cannot be read \(TimeoutError\): "):
        dataset.columns(Store(SimpleNamespace(open=fail), "fleet", "s3"), "a.parquet", ["mission"])


class Opened:
    """A file that is used in a `with` statement."""

    def __init__(self, file: object) -> None:
        self.file = file

    def __enter__(self) -> object:
        return self.file

    def __exit__(self, *_: object) -> None: ...
