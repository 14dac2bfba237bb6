"""`tarl summary`: results as Markdown."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.commands.cli import main

RESULT: dict[str, Any] = {
    "test": "test_shuttle.py::test_delivers",
    "drift": "mud",
    "verdict": {"result": "degraded", "p_drift": 0.001, "p_loss": 0.001, "loss": 8.8378},
    "region": [{"x": [5.0, 7.0], "terrain": [1, 1]}, {"x": [7.0, 7.5], "terrain": [0, 0]}],
    "sites": [
        {"site": "a", "path": "src/node.py", "line": 27, "offline": 14.1, "online": 1.5, "difference": -12.6},
        {"site": "b", "path": "src/node.py", "line": 25, "offline": 13.7, "online": 1.4, "difference": -12.3},
    ],
    "culprits": [{"site": "a", "path": "src/node.py", "line": 27, "score": 1.0}],
    "repair": {"accepted": True, "guard": "terrain", "edits": [{"code": "5", "value": 11.0}]},
}


def written(folder: Path, *documents: object) -> Path:
    results = folder / "results"
    results.mkdir()
    for number, document in enumerate(documents):
        (results / f"{number}.json").write_text(json.dumps(document), "utf-8")
    return results


def test_summary_has_a_row_per_test_and_a_chart_per_loss(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    same = copy.deepcopy(RESULT) | {"drift": "dry", "region": [], "repair": None}
    same["verdict"] = {"result": "no difference", "p_drift": 0.4, "p_loss": 0.7, "loss": 0.0}
    assert main(["summary", str(written(tmp_path, RESULT, same))]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[2] == (
        "| `test_shuttle.py::test_delivers` | mud | ❌ degraded | 8.84 (p = 0.001) | "
        "x 5 to 7, terrain 1; x 7 to 7.5, terrain 0 | `src/node.py:27` | 5 → 11 where terrain |"
    )
    assert lines[3] == "| `test_shuttle.py::test_delivers` | dry | ✅ no difference |  |  |  |  |"
    assert '  x-axis ["node.py:25", "node.py:27"]' in lines
    assert "  bar [13.7, 14.1]" in lines
    assert "  line [1.4, 1.5]" in lines
    assert lines.count("```mermaid") == 1


def test_special_characters_do_not_break_cells_or_charts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    hostile = copy.deepcopy(RESULT)
    hostile["drift"] = 'a|b`"\n```\n<script>'
    main(["summary", str(written(tmp_path, hostile))])
    said = capsys.readouterr().out
    assert said.splitlines()[2].count(" | ") == 6
    assert said.count("```") == 2
    assert "<script>" not in said


@pytest.mark.parametrize(
    "damaged", [{}, [], {"verdict": 3}, RESULT | {"sites": [{"path": 1}]}, RESULT | {"culprits": 7}]
)
def test_foreign_result_file_is_reported_in_one_sentence(
    tmp_path: Path, damaged: object, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["summary", str(written(tmp_path, damaged))]) == 2
    assert "not a result of TARL" in capsys.readouterr().err


def test_a_folder_without_results_is_reported_in_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["summary", str(tmp_path)]) == 2
    assert "no result found. Run pytest --tarl-online or --tarl-stress first." in capsys.readouterr().err
