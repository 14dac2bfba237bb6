"""Repairs in a project: candidates that break the test, the budget, what is told of them."""

from __future__ import annotations

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed, result

REPAIR = (*ONLINE, "--tarl-repair")


@pytest.mark.parametrize(
    "breaking",
    [
        "        assert level == level\n        if level > 1.5:\n            raise ValueError('burst')\n",
        "        if level > 1.5:\n            tarl.reward(float('nan'))\n",
    ],
)
def test_a_candidate_that_breaks_the_test_is_a_bad_candidate_and_no_error(
    tank: pytest.Pytester, breaking: str
) -> None:
    changed(tank, "test_tank", "        tarl.reward(", f"{breaking}        tarl.reward(")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*REPAIR).assert_outcomes(failed=1, deselected=1)
    assert result(tank)["repair"]["accepted"]


def test_a_node_that_a_candidate_silences_is_a_bad_candidate_and_no_error(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "if level is not None:", "if level is not None and 0.5 < 1.0 - 0.1 * level:")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*REPAIR).assert_outcomes(failed=1, deselected=1)
    assert result(tank)["repair"]["accepted"]


def test_sites_say_by_which_search_they_were_found(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*REPAIR, "--tarl-search=epsilon-greedy")
    methods = {culprit["method"] for culprit in result(tank)["culprits"]}
    assert methods <= {"epsilon-greedy", "slices"}
    assert "epsilon-greedy" in methods


def test_a_site_that_is_new_since_the_recording_can_be_the_culprit(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    changed(tank, "keeper", "flow = GAIN * missing", "flow = 2.0 * missing")
    tank.runpytest(*REPAIR)
    found = result(tank)
    assert found["repair"]["accepted"]
    edited = {(edit["path"], edit["line"]) for edit in found["repair"]["edits"]}
    assert (found["culprits"][0]["path"], found["culprits"][0]["line"]) in edited
