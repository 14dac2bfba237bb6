"""Statements that run only in failures."""

from __future__ import annotations

import ast
import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.instrumentation.sites import Positions
from pytest_tarl.rollout import EpisodePlan, EpisodeRun, Rollout
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import json_result, page, words
from pytest_tarl.stressing.evaluating import RAYS
from pytest_tarl.stressing.failing_statements import (
    FAILING,
    OTHERS,
    Source,
    chosen,
    only_in_failures,
    places_in,
    source,
    statements,
)
from pytest_tarl.stressing.findings import Curve, Executed, Statements, confirmed
from pytest_tarl.stressing.rays import rays
from pytest_tarl.stressing.stress_run import along_rays
from tests.plugin.stressing.worlds import Simulated, evaluator_of, space_of, stressed
from tests.plugin.tank import RECORD, changed

SPACE = space_of(mud=Drift.range(0.0, 1.0, nominal=0.0))
PLACES = (("n.py", 1, "a"), ("n.py", 2, "b"), ("m.py", 7, "c <"))


def test_places_are_effective_statements() -> None:
    text = (
        '"""é"""\nimport a\n\n\ndef f(x):\n    "doc"\n    if x: é = 1; y = 2\n    elif x > 1:\n        pass\n'
    )
    assert [*places_in(text)] == [(7, 5), (7, 11), (7, 18), (8, 5)]


def test_own_files_have_a_place_per_statement() -> None:
    for path in sorted(Path(__file__).parents[3].glob("examples/*/*.py"))[:12]:
        text = path.read_text("utf-8")
        tree, found = ast.parse(text), {line for line, _ in places_in(text)}
        returns = {one.lineno for one in ast.walk(tree) if isinstance(one, ast.Return | ast.Assign | ast.If)}
        assert returns <= found


def test_statements_that_only_failures_run_are_sorted_by_frequency() -> None:
    failing, others = [{0, 2}, {0, 1, 2}, {1}], [{0}, set()]
    assert only_in_failures(PLACES, failing, others) == (
        Executed("n.py", 2, "b", 2),
        Executed("m.py", 7, "c <", 2),
    )
    assert only_in_failures(PLACES, failing, [{0, 1, 2}]) == ()


def test_a_file_that_cannot_be_parsed_has_no_statements(tmp_path: Path) -> None:
    (tmp_path / "bad.py").write_text("def (:\n")
    (tmp_path / "good.py").write_text("a = 1\nb = 2\n")
    files = [tmp_path / name for name in ("bad.py", "missing.py", "good.py")]
    found = source(files, tmp_path, lambda _: Simulated(world))
    assert found.places == (("good.py", 1, "a = 1"), ("good.py", 2, "b = 2"))
    assert found.positions == {files[2]: {(1, 1): 0, (2, 1): 1}}


def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    """Fail in half of the episodes beyond 0.5."""
    return point["mud"] < 0.5 or bool(draws.random() < 0.5), 1.0


@dataclass
class Recording(Simulated):
    """A world whose node runs statement 0 always and statement 1 only in failures; `plans` must request recording."""

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        run = super().__call__(plan)
        assert plan.record
        sites = [0] if run.passed else [0, 1, 1]
        return replace(run, trace=replace(run.trace, site=np.array(sites, np.int32)))


def test_failing_episodes_are_repeated_and_compared() -> None:
    evaluator = evaluator_of(world, SPACE)
    curves = [Curve(ray) for ray in rays(SPACE, {})]
    along_rays(curves, evaluator, 0.01)
    (failure,) = confirmed(curves)
    failing, others = chosen(evaluator, curves, [failure])
    assert 0 < len(failing) <= FAILING
    assert 0 < len(others) <= OTHERS
    assert {one.point["mud"] for one in failing if one.point} == {failure.point["mud"]}
    passed = [plan for plan, failed in evaluator.recalled(RAYS, failure.point) if not failed]
    assert passed
    assert all(one in others for one in passed[:4])
    assert not {(one.seed, str(one.point)) for one in failing} & {
        (one.seed, str(one.point)) for one in others
    }
    recording, asked = Recording(world), list[Mapping[Path, Positions]]()

    def rollout(positions: Mapping[Path, Positions]) -> Rollout:
        asked.append(positions)
        return recording

    spent = evaluator.spent
    given = Source(PLACES, {Path("n.py"): {(1, 1): 0}}, rollout)
    found = statements(given, evaluator, curves, [failure])
    assert found == Statements(len(failing), len(others), (Executed("n.py", 2, "b", len(failing)),))
    assert evaluator.spent == spent
    assert len(recording.plans) == len(failing) + len(others)
    assert statements(given, evaluator, curves, []) is None
    assert len(asked) == 1  # workers start only if there is something to record


@pytest.mark.parametrize("only", [(), tuple(Executed("n.py", line, "a < b", 3) for line in range(1, 9))])
def test_text_json_and_page_show_the_statements(only: tuple[Executed, ...]) -> None:
    found = replace(stressed(world, SPACE, budget=150), statements=Statements(3, 9, only))
    document = json.loads(json_result.text(found))
    jsonschema.validate(document, json_result.schema())
    assert len(document["statements"]["only"]) == len(only)
    told = [line for line in words.lines(found) if "statement" in line or "n.py" in line]
    shown = page.render(found)
    if only:
        assert told[0] == "  statements n.py:1 ran in 3 of 3 failing episodes and in none of 9 others: a < b"
        assert "3 more statements" in told[-1]
        assert shown.count("<code>a &lt; b</code>") == 8
    else:
        assert "No statement ran only in failures (3 failing episodes, 9 others)." in told[0]
        assert "No statement ran only in failures" in shown


def test_run_names_the_branch_of_failures(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "import Sensor", "import Drift, Sensor")
    space = '{"world": Drift.space(pump=Drift.range(0.1, 1.0, nominal=1.0))}'
    changed(tank, "test_tank", '{"clogged": 0.25}', space)
    changed(tank, "test_tank", "1.0 if tarl_drift is None else tarl_drift", 'tarl_drift["pump"]')
    changed(tank, "test_tank", "episodes=30,", "episodes=30, tolerance=50,")
    flow = "            flow = GAIN * missing\n"
    slow = f"{flow}            waits += 1\n            if waits > 24 and missing > 0.125:\n"
    changed(tank, "keeper", flow, f"{slow}                flow = flow * 1.0\n")
    changed(tank, "keeper", "    rate = rospy.Rate(10)", "    rate = rospy.Rate(10)\n    waits = 0")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    done = tank.runpytest("--tarl-stress", "--tarl-stress-budget=170")
    done.stdout.fnmatch_lines(["  statements keeper.py:25 ran in * of * others: flow = flow [*] 1.0"])
    (path,) = (tank.path / ".tarl").glob("stress/*-world.json")
    assert [one["line"] for one in json.loads(path.read_text())["statements"]["only"]] == [25]
