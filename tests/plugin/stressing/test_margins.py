"""Files of margins: written by stress runs, compared between revisions, reported in comments."""

from __future__ import annotations

import json
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pytest_tarl import Drift
from pytest_tarl.commands.cli import main
from pytest_tarl.commands.margins_diff import lines
from pytest_tarl.errors import FixtureError
from pytest_tarl.spaces import Point
from pytest_tarl.stressing.margin_changes import compared, words
from pytest_tarl.stressing.margins import Margin, Margins, margins, read, text
from tests.plugin.stressing.worlds import space_of, stressed

MUD = Margin("mud", 1.0, 0.05, 0.3, 0.2)
DOWN = Margin("camera='down'", 0.0, 1.0, 1.0, None)
FOUND = Margins("test_it.py::test_it", "world", 0.98, 0.466, 0.9, (MUD, DOWN))

numbers = st.floats(-1e6, 1e6)
sides = st.builds(
    Margin,
    st.text(min_size=1),
    st.just(0.0),
    st.floats(0.1, 9.0),
    st.none() | numbers,
    st.none() | numbers,
)


@given(st.builds(Margins, st.text(), st.text(), numbers, numbers, numbers, st.lists(sides).map(tuple)))
def test_margins_read_back_as_written(found: Margins) -> None:
    assert read(text(found).encode(), "a.json") == found


@given(
    st.binary()
    | st.recursive(st.none() | st.text() | st.floats(), st.lists).map(lambda one: repr(one).encode())
)
def test_files_without_margins_are_refused_with_one_sentence(content: bytes) -> None:
    with pytest.raises(FixtureError, match=r"a\.json: not a file of margins"):
        read(content, "a.json")


KEYS: list[tuple[Any, ...]] = [(key,) for key in json.loads(text(FOUND))] + [
    ("guarantee", "loss"),
    ("directions", 0),
]
KEYS += [("directions", 1, key) for key in ("name", "nominal", "end", "holds_to", "fails_at")]
VALUES = (
    None,
    True,
    0,
    1,
    -1,
    10**400,
    -(10**400),
    1e308,
    float("nan"),
    float("inf"),
    "",
    "1",
    [],
    [[]],
    {},
    {"end": 1},
)


@given(st.sampled_from(KEYS), st.sampled_from(VALUES))
@example(("guarantee", "loss"), 10**400)
def test_any_file_value_is_read_or_refused(key: tuple[Any, ...], value: Any) -> None:
    document = json.loads(text(FOUND))
    place = document
    for part in key[:-1]:
        place = place[part]
    place[key[-1]] = value
    try:
        found = read(json.dumps(document).encode(), "a.json")
    except FixtureError as refused:
        message = str(refused)
    else:
        message = ""
        assert read(text(found).encode(), "a.json") == found
        assert all(isinstance(line, str) for line in lines(compared([FOUND], [found])))
    assert message == "" or message.startswith("a.json: not a file of margins")


def test_margins_contain_the_shown_values() -> None:
    def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
        return point["mud"] > 0.4 and point["camera"] != 1.0, float(draws.normal(1.0, 0.01))

    space = space_of(mud=Drift.range(0.0, 1.0, nominal=1.0), camera=Drift.choice("up", "down", "left"))
    found = stressed(world, space, budget=4000)
    mud, down, left = margins(found).sides
    assert mud.fails_at is not None
    assert mud.holds_to is not None
    assert mud.fails_at <= 0.4 < mud.holds_to < 0.5
    assert (down.name, words(down)) == ("camera='down'", "fails")
    assert (left.name, words(left)) == ("camera='left'", "holds")


@pytest.mark.parametrize(
    ("after", "change"),
    [
        (replace(MUD, holds_to=0.5, fails_at=0.35), "more fragile"),
        (replace(MUD, holds_to=0.5, fails_at=0.3), "more fragile"),
        (replace(MUD, holds_to=None, fails_at=0.4), "more fragile"),
        (replace(MUD, holds_to=0.35, fails_at=0.25), "no significant change"),
        (replace(MUD, holds_to=0.15, fails_at=0.1), "more robust"),
        (replace(MUD, holds_to=0.05, fails_at=None), "more robust"),
        (replace(MUD, holds_to=None, fails_at=None), "no significant change"),
        (replace(MUD, nominal=0.9), "not comparable"),
        (replace(MUD, end=0.1), "not comparable"),
        (replace(MUD, end=2.0), "new"),
    ],
)
def test_only_shown_values_make_a_direction_more_fragile(after: Margin, change: str) -> None:
    row, *_ = compared([replace(FOUND, sides=(MUD,))], [replace(FOUND, sides=(after,))])
    assert row.change == change


def repository(folder: Path, before: Margins, after: Margins) -> None:
    """Make a repository whose branch has the margins `before`, and its working tree those `after`."""
    path = folder / ".tarl" / "margins" / "it.json"
    path.parent.mkdir(parents=True)
    path.write_text(text(before), "utf-8")
    who = ("-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false")
    for arguments in (("init", "-q", "-b", "main"), ("add", "-A"), (*who, "commit", "-qm", "a")):
        subprocess.run(("git", *arguments), cwd=folder, check=True, capture_output=True)
    path.write_text(text(after), "utf-8")


def test_diff_compares_with_a_revision(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    worse = replace(
        FOUND, success=0.97, sides=(replace(MUD, holds_to=0.5, fails_at=0.35), replace(DOWN, fails_at=1.0))
    )
    repository(tmp_path, FOUND, worse)
    monkeypatch.chdir(tmp_path)
    assert main(["diff", "main"]) == 0
    told = capsys.readouterr().out
    assert "mud to 0.05      0.2 to 0.3 → 0.35 to 0.5: more fragile" in told
    assert "camera='down'    holds → fails: more fragile" in told
    assert "the guarantee changed from a success rate of 98 % and a loss of 0.466 to 97 % and 0.466" in told
    assert main(["diff", "main", "--fail-if-worse"]) == 1
    assert main(["diff", ".tarl/margins", "main:.tarl/margins", "--fail-if-worse"]) == 0
    assert main(["diff", ".tarl/margins/it.json", "main:.tarl/margins/it.json", "--format", "markdown"]) == 0
    assert "| mud to 0.05 | 0.35 to 0.5 | 0.2 to 0.3 | ✅ more robust |" in capsys.readouterr().out
    assert main(["summary"]) == 0
    assert "| `test_it.py::test_it[world]` | mud to 0.05 | 0.35 to 0.5 |" in capsys.readouterr().out
    assert main(["summary", "--since", "main"]) == 0
    assert "| mud to 0.05 | 0.2 to 0.3 | 0.35 to 0.5 | ❌ more fragile |" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("nowhere:.tarl/margins", ".tarl/margins"), "git does not know this revision"),
        (("--", "-x:.tarl/margins", ".tarl/margins"), "is not a git revision"),
        (("nosuch.json", ".tarl/margins"), "nosuch.json: no such file or folder"),
        (("broken.json", ".tarl/margins"), "broken.json: not a file of margins"),
    ],
)
def test_an_unknown_revision_or_path_is_a_user_error(
    arguments: tuple[str, ...],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    repository(tmp_path, FOUND, FOUND)
    (tmp_path / "broken.json").write_text(json.dumps({"format": 9}))
    monkeypatch.chdir(tmp_path)
    assert main(["diff", *arguments]) == 2
    assert told in capsys.readouterr().err


def test_a_revision_without_margins_has_only_new_directions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    repository(tmp_path, FOUND, FOUND)
    (tmp_path / "sub" / ".tarl" / "margins").mkdir(parents=True)
    (tmp_path / "sub" / ".tarl" / "margins" / "b.json").write_text(text(FOUND), "utf-8")
    monkeypatch.chdir(tmp_path / "sub")
    assert main(["diff", "main", "--fail-if-worse"]) == 0
    assert "camera='down'    - → holds: new" in capsys.readouterr().out
