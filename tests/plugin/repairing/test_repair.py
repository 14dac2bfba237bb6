"""Repairs in a project: candidates that break the test, the budget, and the report."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import count
from typing import Any

import pytest

from pytest_tarl.repairing import accepting
from tests.plugin.tank import ONLINE, RECORD, TEST, changed, result
from tests.slow import slow

REPAIR = (*ONLINE, "--tarl-repair")
INTERRUPT = """
    import os, signal
    if tarl_drift:
        with open("runs", "a+") as runs:
            runs.write(".")
            if runs.tell() == 17:
                os.kill(os.getpid(), signal.SIGINT)
"""


@pytest.mark.usefixtures("quick_acceptance")
@pytest.mark.parametrize(
    "breaking",
    [
        "        assert level == level\n        if level > 1.5:\n            raise ValueError('burst')\n",
        pytest.param("        if level > 1.5:\n            tarl.reward(float('nan'))\n", marks=slow),
    ],
)
def test_candidate_that_breaks_the_test_is_refused(tank: pytest.Pytester, breaking: str) -> None:
    changed(tank, "test_tank", "        tarl.reward(", f"{breaking}        tarl.reward(")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*REPAIR).assert_outcomes(failed=1, deselected=1)
    assert result(tank)["repair"]["accepted"]


@slow
@pytest.mark.usefixtures("quick_acceptance")
def test_candidate_that_silences_the_node_is_refused(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "if level is not None:", "if level is not None and 0.5 < 1.0 - 0.1 * level:")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*REPAIR).assert_outcomes(failed=1, deselected=1)
    assert result(tank)["repair"]["accepted"]


@slow
@pytest.mark.usefixtures("quick_acceptance")
def test_each_site_names_the_search_that_found_it(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*REPAIR, "--tarl-search=epsilon-greedy")
    methods = {culprit["method"] for culprit in result(tank)["culprits"]}
    assert methods <= {"epsilon-greedy", "slices"}
    assert "epsilon-greedy" in methods


@slow
@pytest.mark.usefixtures("quick_acceptance")
def test_new_site_can_be_the_culprit(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    changed(tank, "keeper", "flow = GAIN * missing", "flow = 2.0 * missing")
    tank.runpytest(*REPAIR)
    found = result(tank)
    assert found["repair"]["accepted"]
    edited = {(edit["path"], edit["line"]) for edit in found["repair"]["edits"]}
    assert (found["culprits"][0]["path"], found["culprits"][0]["line"]) in edited


def test_timed_out_search_says_how_to_repeat_it(
    tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = count()
    monkeypatch.setattr("pytest_tarl.repairing.budget.monotonic", lambda: float(next(clock)))
    changed(tank, "test_tank", "0.1 * pump * (", "0.1 * (0.0 if tarl_drift else 1.0) * pump * (")
    tank.runpytest(*RECORD)
    done = tank.runpytest(*REPAIR, "--tarl-budget=5s")
    done.assert_outcomes(failed=1, deselected=1)
    told = " ".join(done.stdout.str().split())
    assert "none accepted: the search reached its time limit" in told
    ran = re.search(r"the search ended after 5 s and (\d) episodes; a time limit is not reproducible", told)
    assert ran is not None
    assert 1 <= int(ran[1]) <= 5  # the clock of this test advances by 1 s whenever it is read
    assert re.search(r"best so far: .+ per episode, mean of \d", told)
    assert "--tarl-budget 5s" in told
    assert not list(tank.path.glob(".tarl/patches/*.patch"))


@pytest.mark.parametrize("budget", ["0", "5 eggs", "-3", "2.5", "s"])
def test_a_budget_is_a_number_or_a_time(tank: pytest.Pytester, budget: str) -> None:
    done = tank.runpytest(*REPAIR, f"--tarl-budget={budget}")
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines(["*--tarl-budget*"])


def test_interrupted_search_reports_its_best_candidate(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "    draws = ", f"{INTERRUPT}    draws = ")
    tank.runpytest(*RECORD)
    done = tank.runpytest_subprocess(*REPAIR)
    assert done.ret == pytest.ExitCode.INTERRUPTED
    told = " ".join(done.stdout.str().split())
    assert "none accepted: the search was interrupted" in told
    assert re.search(r"best so far: .+ per episode, mean of \d", told)
    assert result(tank)["episodes"]["search"] == 4  # the fifth mission under the drift was interrupted
    assert not list(tank.path.glob(".tarl/patches/*.patch"))


@pytest.mark.usefixtures("quick_acceptance")
def test_dropped_candidates_and_the_candidates_tried_next_are_reported(
    tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, accept = [], accepting.accept

    def refusing(*given: Any) -> Any:
        found = accept(*given)
        if first:
            return found
        first.append(found)
        return replace(found, accepted=False, reason="nominal gets worse", costly=True)

    monkeypatch.setattr(accepting, "accept", refusing)
    tank.runpytest(*RECORD)
    done = tank.runpytest(*REPAIR)
    assert result(tank)["repair"]["accepted"]
    told = " ".join(done.stdout.str().split())
    assert re.search(
        r"\d tried before; the last: .+: (dropped|not run), (it gains|the designed|a smaller|200 episodes)",
        told,
    )
    tried = result(tank)["repair"]["tried"]
    assert "nominal gets worse" in [one["reason"] for one in tried if one["fresh"]]
    assert tried[-1]["reason"] is None
    (page,) = tank.path.glob(".tarl/report/*.html")
    text = page.read_text()
    history = text[text.index("Attempts, in order") :]
    assert history.index("the designed world gets worse") < history.index("accepted,")


@pytest.mark.usefixtures("quick_acceptance")
def test_edited_numbers_have_few_digits(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*REPAIR)
    for edit in result(tank)["repair"]["edits"]:
        assert len(repr(edit["value"])) <= 8


NEIGHBOUR = """

@pytest.fixture(scope="module")
def shared():
    yield 1


@pytest.mark.tarl(
    nodes=["keeper.py"], sensors=[Sensor("level", topic="/level", field="data", low=0, high=1, bins=10)], episodes=10
)
def test_{name}(tarl, shared):
    level = 0.1
    tarl.start("keeper.py")
    for _ in range(15):
        tarl.bus.publish("/level", Float64(data=level))
        tarl.step(0.1)
        valve = tarl.bus.latest("/valve")
        tarl.reward(1.0)
        assert valve is None or valve.data < {most}, "the pipe burst"
        level += 0.1 * (valve.data if valve else 0.0)
"""


@pytest.mark.usefixtures("quick_acceptance")
def test_other_test_of_the_node_must_not_lose(tank: pytest.Pytester) -> None:
    tank.makepyfile(test_pipe=TEST[: TEST.index("@pytest")] + NEIGHBOUR.format(name="pipe", most=2.3))
    tank.runpytest(*RECORD).assert_outcomes(passed=2, deselected=1)
    done = tank.runpytest(
        "--tarl-online", "--tarl-repair", "--tarl-drift=clogged", "--tarl-episodes=12", "--tarl-budget=90"
    )
    done.assert_outcomes(failed=1, deselected=2)
    told = " ".join(done.stdout.str().split())
    assert not result(tank)["repair"]["accepted"]
    assert "none accepted: the best change found makes another recorded test of the node worse" in told
    assert "it lowers the reward of another test: test_pipe.py::test_pipe: " in told
    assert not list(tank.path.glob(".tarl/patches/*.patch"))


@pytest.mark.usefixtures("quick_acceptance")
def test_patch_names_the_unharmed_tests(tank: pytest.Pytester) -> None:
    with (tank.path / "test_tank.py").open("a") as file:
        file.write(NEIGHBOUR.format(name="wide_pipe", most=99.0))
    tank.runpytest(*RECORD).assert_outcomes(passed=2, deselected=1)
    tank.runpytest(*REPAIR).assert_outcomes(failed=1, passed=1, deselected=1)
    (patch,) = tank.path.glob(".tarl/patches/*.patch")
    assert (
        "# other test: test_tank.py::test_wide_pipe: 15 per episode instead of 15 as recorded"
        in patch.read_text()
    )


@pytest.mark.usefixtures("quick_acceptance")
def test_omitted_module_of_the_flow_is_reported(tank: pytest.Pytester) -> None:
    tank.makepyfile(gains="GAIN = 2.0\n\n\ndef wanted(missing):\n    return GAIN * missing\n")
    changed(tank, "keeper", "flow = GAIN * missing", "flow = wanted(missing)")
    changed(tank, "keeper", "import rospy\n", "import rospy\nfrom gains import wanted\n")
    changed(tank, "test_tank", "import pytest\n", "import pytest\nimport sys\nsys.path.insert(0, '.')\n")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    told = " ".join(tank.runpytest(*REPAIR, "--tarl-budget=20").stdout.str().split())
    assert "a flow passes through gains.py at keeper.py:22, but the marker does not name that file" in told


OWN = """
import random


class Draws:
    batch = 3

    def __init__(self, constants, seed):
        self.constants, self.draws = constants, random.Random(seed)

    def ask(self):
        return [2.0 ** self.draws.uniform(-3, 3) for _ in self.constants]

    def tell(self, factors, gain):
        with open("told", "a") as file:
            print(factors, gain, file=file)
"""


@slow
@pytest.mark.usefixtures("quick_acceptance")
def test_a_search_from_a_plug_in_is_reproducible(tank: pytest.Pytester) -> None:
    tank.makepyfile(mine=OWN)
    tank.runpytest(*RECORD)
    told = tank.path / "told"
    search = (*REPAIR, "--tarl-search=mine:Draws")
    tank.runpytest(*search).assert_outcomes(failed=1, deselected=1)
    assert result(tank)["repair"]["accepted"]
    first, found = told.read_text(), result(tank)
    told.unlink()
    tank.runpytest(*search)
    assert told.read_text() == first
    assert result(tank) == found


def test_an_unknown_search_is_reported_before_anything_runs(tank: pytest.Pytester) -> None:
    done = tank.runpytest(*REPAIR, "--tarl-search=nowhere:Draws")
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines(["*--tarl-search=nowhere:Draws: No module named 'nowhere'*"])


def test_raising_search_fails_the_test(tank: pytest.Pytester) -> None:
    tank.makepyfile(mine="class Silent:\n    def __init__(self, constants, seed):\n        pass\n")
    tank.runpytest(*RECORD)
    done = tank.runpytest(*REPAIR, "--tarl-search=mine:Silent")
    done.assert_outcomes(failed=1, deselected=1)
    done.stdout.fnmatch_lines(["*the factory returned Silent, which has no method ask and no tell*"])


@slow
@pytest.mark.usefixtures("quick_acceptance")
def test_full_ranking_follows_the_repair(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    done = tank.runpytest(*REPAIR)
    alone, told = result(tank), " ".join(done.stdout.str().split())
    assert "lines were simulated, most of them in few runs (--tarl-localize=full ranks all)" in told
    done = tank.runpytest(*REPAIR, "--tarl-localize=full")
    full, told = result(tank), " ".join(done.stdout.str().split())
    assert full["repair"]["edits"] == alone["repair"]["edits"]
    assert full["repair"]["guard"] == alone["repair"]["guard"]
    assert full["episodes"]["search"] > alone["episodes"]["search"]
    assert re.search(
        r"ranking the repair of the first line passed on \d+ fresh seeds; 2 of 2 lines .* common seeds\)",
        told,
    )
    assert "--tarl-repair --tarl-localize full" in told
    assert {one["method"] for one in full["culprits"] if one["operands"]} == {"ranking"}
    (page,) = tank.path.glob(".tarl/report/*.html")
    assert "Confidence in this ranking: the repair of the first line passed on" in page.read_text()


def test_localize_flag_requires_repair(tank: pytest.Pytester) -> None:
    done = tank.runpytest(*ONLINE, "--tarl-localize=full")
    done.stderr.fnmatch_lines(["*--tarl-localize needs --tarl-repair*"])
    done = tank.runpytest(*REPAIR, "--tarl-localize=ful")
    done.stderr.fnmatch_lines(["*did you mean 'full'?*"])


@pytest.mark.usefixtures("quick_acceptance")
@pytest.mark.parametrize(
    "sensor",
    [
        'Sensor("thick", topic="/viscosity", field=lambda m: int(m.data > 2), expr="thick")',
        'Sensor("thick", expr="thick")',
    ],
)
def test_a_condition_reads_the_variable_that_a_sensor_names(tank: pytest.Pytester, sensor: str) -> None:
    heard = "def on_viscosity(msg):\n    global thick\n    thick = int(msg.data > 2)\n\n\ndef main():\n"
    changed(tank, "keeper", "level = None\n", "level = None\nthick = 0\n")
    changed(tank, "keeper", "def main():\n", heard)
    listening = 'rospy.Subscriber("/viscosity", Float64, on_viscosity)'
    changed(tank, "keeper", "    valve = rospy", f"    {listening}\n    valve = rospy")
    old = '[Sensor("level", topic="/level", field="data", low=0, high=1, bins=10)]'
    changed(tank, "test_tank", old, f"[{sensor}]")
    told = (
        '        tarl.bus.publish("/viscosity", Float64(data=1.0 if tarl_drift is None else 3.0))\n'
        f"{'' if 'topic' in sensor else '        tarl.observe(thick=int(tarl_drift is not None))' + chr(10)}"
        "        tarl.bus.publish("
    )
    changed(tank, "test_tank", "        tarl.bus.publish(", told)
    burst = "        tarl.reward(-5.0 if tarl_drift is None and valve and valve.data > 2.5 else -abs(1.0 - level))\n"
    changed(tank, "test_tank", "        tarl.reward(-abs(1.0 - level))\n", burst)
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*REPAIR).assert_outcomes(failed=1, deselected=1)
    found = result(tank)["repair"]
    assert found["accepted"]
    patch = (tank.path / found["patch"]).read_text()
    assert "+            if thick == 1:\n" in patch
    assert "Subscriber" not in patch
