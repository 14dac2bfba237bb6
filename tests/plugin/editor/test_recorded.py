"""Results of comparisons in the editor: which files are read, the figures of a statement, hovers and hints."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("lsprotocol")

from pytest_tarl.editor.recorded import Figures, hint, hover, read, steps
from tarl_lint.run.runner import Result
from tests.plugin.editor.graphs import finding, flow, step

SPEED, TURN = "pilot:on_goal:speed = 2 * goal", "pilot:on_goal:turn = 3"
SITES = [
    {"site": SPEED, "offline": 9.0, "online": 2.5},
    {"site": TURN, "offline": 1.0, "online": 4.0},
]
REPAIR = {
    "accepted": True,
    "patch": ".tarl/patches/a.patch",
    "edits": [{"path": "pilot.py"}, {"path": "map.py"}, {"path": "pilot.py"}],
}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    (tmp_path / ".tarl" / "results").mkdir(parents=True)
    (tmp_path / ".tarl" / "patches").mkdir()
    (tmp_path / ".tarl" / "patches" / "a.patch").write_text("")
    return tmp_path


def written(root: Path, name: str = "a", **changed: Any) -> None:
    document = {
        "test": f"test_{name}",
        "drift": "mud",
        "sites": SITES,
        "culprits": [{"site": TURN}, {"site": "x"}, {"site": SPEED}],
        "repair": REPAIR,
        **changed,
    }
    (root / ".tarl" / "results" / f"{name}.json").write_text(json.dumps(document))


def test_site_figures_come_from_all_comparisons(root: Path) -> None:
    written(root, "b", culprits=[])
    written(root, "a")
    found = read(root).by_site
    assert set(found) == {SPEED, TURN}
    assert found[SPEED] == (
        Figures("test_a", "mud", 9.0, 2.5, rank=3),
        Figures("test_b", "mud", 9.0, 2.5, rank=None),
    )
    assert found[TURN][0].rank == 1
    assert [one.difference for one in (*found[SPEED], *found[TURN])] == [-6.5, -6.5, 3.0, 3.0]


def test_accepted_repair_belongs_to_each_edited_file_once(root: Path) -> None:
    written(root, "a")
    written(root, "b")
    patch = root / ".tarl" / "patches" / "a.patch"
    assert read(root).patches == {"pilot.py": (patch, patch), "map.py": (patch, patch)}


@pytest.mark.parametrize(
    "repair",
    [
        None,
        {},
        {**REPAIR, "accepted": False},
        {**REPAIR, "accepted": 1},
        {**REPAIR, "patch": ".tarl/patches/gone.patch"},
        {**REPAIR, "patch": ".tarl/patches"},
    ],
)
def test_rejected_repair_is_not_offered(root: Path, repair: Any) -> None:
    written(root, repair=repair)
    found = read(root)
    assert found.patches == {}
    assert set(found.by_site) == {SPEED, TURN}


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "{",
        "[" * 100_000,
        '{"culprits": [], "sites": [1]}',
        '{"culprits": 1, "sites": []}',
        "\xff",
    ],
)
def test_damaged_result_is_skipped(root: Path, text: str) -> None:
    (root / ".tarl" / "results" / "0.json").write_bytes(text.encode("latin-1"))
    written(root)
    assert set(read(root).by_site) == {SPEED, TURN}


def test_folder_without_results_has_no_sites(tmp_path: Path) -> None:
    found = read(tmp_path)
    assert (found.by_site, found.patches) == ({}, {})


def test_statements_come_from_reported_and_silenced_flows() -> None:
    first, second = step(2, "speed = 2"), step(3, "turn = 3")
    result = Result(
        findings=(finding(of=flow(steps=(first, step(1, "b", path="other.py")))), finding("TARL201")),
        silenced=(finding(of=flow(steps=(second,))),),
    )
    assert steps(result, "pilot.py") == {"pilot:<module>:speed = 2": first, "pilot:<module>:turn = 3": second}
    assert list(steps(result, "other.py")) == ["pilot:<module>:b"]


def test_a_hover_has_one_row_for_each_comparison() -> None:
    rows = hover(
        (Figures("test_a", "mud", 9.0, 2.5, 1), Figures("test_b", "ice", 0.123456, 1234.5678))
    ).split("\n")
    assert rows == [
        "| test | drift | utility as designed | under the drift | difference | rank |",
        "|---|---|---:|---:|---:|---:|",
        "| `test_a` | mud | 9 | 2.5 | -6.5 | 1 |",
        "| `test_b` | ice | 0.1235 | 1235 | +1234 |  |",
    ]


def test_a_hint_names_only_comparisons_that_rank_the_statement() -> None:
    ranked, other = Figures("a", "mud", 9.0, 2.5, 1), Figures("a", "ice", 0.0, 1.23456, 2)
    assert hint((ranked, Figures("b", "fog", 1.0, 2.0), other)) == "#1 mud -6.5, #2 ice +1.23"
    assert hint((Figures("b", "fog", 1.0, 2.0),)) == ""
    assert hint(()) == ""
