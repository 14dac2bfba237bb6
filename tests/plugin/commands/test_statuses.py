"""The exit status of `tarl` for each way in which a command ends, and the default values of options."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from pytest_tarl.commands import cli
from pytest_tarl.errors import RefusedError, TarlError


def raising(problem: BaseException) -> Callable[[Namespace], int]:
    def run(_: Namespace) -> int:
        raise problem

    return run


@pytest.mark.parametrize(
    ("run", "missing", "status", "said"),
    [
        (lambda _: 1, None, 1, ""),
        (lambda _: 0, "tarl show needs numpy.", 2, "tarl: tarl show needs numpy.\n"),
        (raising(RefusedError("no\x1b[2J")), None, 1, "tarl: no\\x1b[2J\n"),
        (raising(TarlError("bad\x1b[2J")), None, 2, "tarl: bad\\x1b[2J\n"),
        (raising(KeyboardInterrupt()), None, 130, "tarl: interrupted.\n"),
    ],
    ids=["check", "extra", "refused", "error", "interrupted"],
)
def test_the_exit_status_shows_how_a_command_ended(
    run: Callable[[Namespace], int],
    missing: str | None,
    status: int,
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    parsed = Namespace(command="show", needs=lambda _: missing, run=run)
    monkeypatch.setattr(cli, "parser", lambda: SimpleNamespace(parse_args=lambda _: parsed))
    assert cli.main(["show"]) == status
    assert capsys.readouterr().err == said


def test_ingest_stores_missing_metadata_as_unknown() -> None:
    given = cli.parser().parse_args(["ingest", "a.log", "--to", "d", "--fixture", "f", "--robot", "r"])
    assert (given.version, given.site) == ("unknown", "unknown")
    assert (given.repair, given.hash_robots) == ("", "")
    assert given.logs == [Path("a.log")]
