"""Candidates are written into the source and run as episodes; a broken episode counts as the worst recorded one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import NodeError, RepairError, StaleTextError
from pytest_tarl.formulas.judging import Judged
from pytest_tarl.patching.constant_definitions import Place
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing import mutants as module
from pytest_tarl.repairing.mutants import MOST_KEPT, ORIGINAL, Mutants
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from tarl_lint.api import analyse
from tests.plugin.searching.test_search import GAIN
from tests.plugin.workers.test_protocol import RUN

SOUND = replace(RUN, crashed=False, stuck=False, broken="", older=())  # earns -1.5 in one step
CANDIDATE = Candidate((Mutation(GAIN, 3.0),), ALWAYS)


class Rollout:
    """A rollout whose episodes are given, or raise an error; it keeps the plans in the order of their starts."""

    def __init__(self, run: EpisodeRun = SOUND, error: Exception | None = None, workers: int = 1) -> None:
        self.run, self.error, self.workers = run, error, workers
        self.plans: list[EpisodePlan] = []

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        return self.begin(plan).result()

    def begin(self, plan: EpisodePlan) -> Any:
        self.plans.append(plan)

        def result() -> EpisodeRun:
            if self.error is not None:
                raise self.error
            return replace(self.run, plan=plan)

        return SimpleNamespace(result=result, cancel=lambda: True)


@pytest.fixture
def texts(monkeypatch: pytest.MonkeyPatch) -> list[Candidate]:
    """Replace the writing of candidates; return the list of the mutations that were written, which grows."""
    written: list[Any] = []

    def rewrite(analysis: Any, mutations: Any, guard: Any, topics: Any, texts: Any) -> dict[str, str]:
        if any(mutation.value == 0.25 for mutation in mutations):
            raise RepairError("no")
        written.append(mutations)
        return {"node.py": f"x = {len(mutations)}\n"}

    monkeypatch.setattr(module, "rewrite", rewrite)
    return written


def mutants(rollout: Any, worst: float = -7.0) -> Mutants:
    order: Any = SimpleNamespace(
        rollout=rollout,
        root=Path("/p"),
        worst=worst,
        analysis=SimpleNamespace(sources={}),
        fixture=SimpleNamespace(topics={}),
    )
    return Mutants(order)


def many(numbers: Iterable[int]) -> list[Candidate]:
    return [Candidate((Mutation(GAIN, 2.0 + number),), ALWAYS) for number in numbers]


def test_an_episode_of_a_candidate_gives_its_outcome(texts: list[Any]) -> None:
    rollout = Rollout()
    found = mutants(rollout).run(CANDIDATE, 4, "mud")
    assert rollout.plans == [EpisodePlan(4, "mud", {Path("/p/node.py"): "x = 1\n"}, outputs=True)]
    assert found == Outcome(-1.5, True, (Judged("level < 1", 0.5, 1.5), Judged("x > 0", -1.0, 2.0)), 1)
    assert (found.rewards, found.outputs) == ((-1.5,), (("/cmd", (2.0, 5.0)),))


@pytest.mark.parametrize(("worst", "total"), [(-7.0, -7.0), (5.0, -1.5)])
def test_a_crash_earns_at_most_the_worst_recorded_total(texts: list[Any], worst: float, total: float) -> None:
    of = mutants(Rollout(replace(SOUND, crashed=True, passed=False)), worst)
    found = of.run(CANDIDATE, 4, "mud")
    assert (found.total, found.passed) == (total, False)


@pytest.mark.parametrize(
    "rollout",
    [
        Rollout(error=NodeError("it raised")),
        Rollout(replace(SOUND, stuck=True)),
        Rollout(replace(SOUND, broken="Traceback")),
    ],
    ids=["error", "stuck", "broken"],
)
def test_an_episode_that_breaks_earns_the_worst_recorded_total(texts: list[Any], rollout: Rollout) -> None:
    assert mutants(rollout, -7.0).run(CANDIDATE, 4, "mud") == Outcome(-7.0, passed=False)


@pytest.mark.parametrize("changes", [{}, {"stuck": True}])
def test_episode_that_ran_the_old_text_ends_the_search(texts: list[Any], changes: dict[str, Any]) -> None:
    stale = replace(SOUND, older=(Path("/p/node.py"), Path("/p/gains.py")), **changes)
    with pytest.raises(StaleTextError, match=r"^node\.py, gains\.py: the candidate was written"):
        mutants(Rollout(stale)).run(CANDIDATE, 4, "mud")


def test_a_candidate_that_cannot_be_written_raises_the_error(texts: list[Any]) -> None:
    rollout = Rollout()
    with pytest.raises(RepairError):
        mutants(rollout).run(Candidate((Mutation(GAIN, 0.25),), ALWAYS), 4, "mud")
    assert rollout.plans == []


def test_other_test_has_its_own_worst_total(
    texts: list[Any],
) -> None:
    of, other = mutants(Rollout()), Rollout()
    assert of.run_at(other, -9.0, CANDIDATE, 1, "ice").total == -1.5
    of.run_at(other, -9.0, None, 2)
    assert other.plans == [
        EpisodePlan(1, "ice", {Path("/p/node.py"): "x = 1\n"}),
        EpisodePlan(2, None, {}),
    ]
    broken = Rollout(error=NodeError("it raised"))
    assert of.run_at(broken, -9.0, CANDIDATE, 3) == Outcome(-9.0, passed=False)


def test_each_candidate_is_written_once(texts: list[Any]) -> None:
    of = mutants(Rollout())
    first, *others = many(range(MOST_KEPT))
    for candidate in (first, *others, first):
        of.source(candidate)
    assert len(texts) == MOST_KEPT
    (one_more,) = many([MOST_KEPT])
    of.source(one_more)
    of.source(others[0])  # the second is still kept
    assert len(texts) == MOST_KEPT + 1
    of.source(first)  # the oldest one was dropped
    assert len(texts) == MOST_KEPT + 2


def test_announced_episodes_start_early_on_workers_and_run_once(texts: list[Any]) -> None:
    rollout = Rollout(workers=2)
    of = mutants(rollout)
    unwritable = Candidate((Mutation(GAIN, 0.25),), ALWAYS)
    of.foresee([(CANDIDATE, 1), (unwritable, 2), (ORIGINAL, 3)], "mud")
    assert [(plan.seed, plan.drift, plan.outputs) for plan in rollout.plans] == [
        (1, "mud", True),
        (3, "mud", True),
    ]
    of.run(CANDIDATE, 1, "mud")
    assert [plan.seed for plan in rollout.plans] == [1, 3]
    of.run(CANDIDATE, 1, None)  # another world
    assert [plan.seed for plan in rollout.plans] == [1, 3, 1]
    alone = Rollout()
    mutants(alone).foresee([(CANDIDATE, 1)], "mud")
    assert alone.plans == []


def test_files_outside_the_analysis_are_read_once(texts: list[Any], tmp_path: Path) -> None:
    (tmp_path / "gains.yaml").write_text("gain: 2.0\n")
    of = mutants(Rollout())
    of.order.root = tmp_path  # type: ignore[misc]
    place = Place("gains.yaml", 6, 9, 1, "gain", 2.0)
    of.source(Candidate((replace(CANDIDATE.mutations[0], place=place),), ALWAYS))
    assert of.texts == {"gains.yaml": "gain: 2.0\n"}
    of.texts.clear()
    of.order.analysis.sources["gains.yaml"] = ""
    of.source(Candidate((Mutation(GAIN, 5.0, place=place),), ALWAYS))
    assert of.texts == {}


def test_a_limit_is_not_moved_beyond_the_opposite_limit(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text(
        "import rospy\nfrom std_msgs.msg import Float64\n"
        'pub = rospy.Publisher("/out", Float64, queue_size=1)\n'
        "def on(msg):\n    pub.publish(max(0.2, min(1.0, 0.5 * msg.data)))\n"
        'rospy.Subscriber("/in", Float64, on)\n'
    )
    analysis = analyse([tmp_path / "node.py"], root=tmp_path)
    operands = {one.code: one for step in analysis.sites for one in analysis.operands(step.site)}
    mutants = Mutants(SimpleNamespace(analysis=analysis, rollout=Rollout()))  # type: ignore[arg-type]
    values = {
        code: [found and found.value for factor in (0.1, 4.0, 8.0) for found in [mutants.mutate(one, factor)]]
        for code, one in operands.items()
    }
    assert values["0.2"] == [pytest.approx(0.02), pytest.approx(0.8), None]
    assert values["1.0"] == [None, 4.0, 8.0]
    assert values["0.5"] == [0.05, 2.0, 4.0]
