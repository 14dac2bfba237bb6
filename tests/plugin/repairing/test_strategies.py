"""The constants and conditions that each search gets, and their order."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.repairing import strategies
from pytest_tarl.repairing.strategies import aside_operands, operands, strategy
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.epsilon_greedy import EpsilonGreedy
from pytest_tarl.searching.halving import Halving
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.seeds import episode_seeds
from pytest_tarl.sensors import Sensor
from tarl_lint.api import analyse

NODE = """\
import rospy
from std_msgs.msg import Float64

GAIN = 1.5


class Wheel:
    def __init__(self, radius):
        self.radius = radius

    def turn(self, speed):
        return speed / self.radius


class Keeper:
    def __init__(self):
        self.bias = 0.25
        self.left = Wheel(0.3)
        self.right = Wheel(0.4)
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_value)

    def on_value(self, msg):
        speed = GAIN * msg.data + 3.5
        turned = self.left.turn(speed) - self.right.turn(speed)
        self.out.publish(Float64(data=turned + self.bias))

    def run(self):
        rate = rospy.Rate(20.0)
        while not rospy.is_shutdown():
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper().run()
"""
WET, DARK = (
    Guard((Conjunct(Sensor(name, topic=f"/{name}", field="data"), 1, 1),)) for name in ("wet", "dark")
)


@pytest.fixture
def order(tmp_path: Path) -> Any:
    (tmp_path / "keeper.py").write_text(NODE)
    return SimpleNamespace(
        analysis=analyse([tmp_path / "keeper.py"], root=tmp_path),
        root=tmp_path,
        online=SimpleNamespace(recorded=SimpleNamespace(parameters={})),
        comparison=SimpleNamespace(culprits=(), sensors=()),
        options=SimpleNamespace(seed=3, structure=True),
        goal="goal",
    )


def ranked(order: Any, *codes: str) -> None:
    """Rank the statements that begin with these codes first."""
    ids = [
        next(str(step.site) for step in order.analysis.sites if step.code.startswith(code)) for code in codes
    ]
    order.comparison.culprits = tuple(SimpleNamespace(site=SimpleNamespace(id=one)) for one in ids)


def codes(found: Any) -> list[str]:
    return [f"{one.code} in {one.span.line}" for one in found]


def test_constants_of_the_first_slices_come_first(order: Any) -> None:
    ranked(order, "self.out.publish", "speed = ")
    late = codes(operands(order))
    ranked(order, "speed = ", "self.out.publish")
    early = codes(operands(order))
    assert sorted(late) == sorted(early)
    assert late.index("self.bias in 26") < late.index("GAIN in 24")
    assert early.index("GAIN in 24") < early.index("self.bias in 26")
    assert early.index("self.bias in 26") < early.index("3.5 in 24")  # a name is changed before a literal


def test_constants_of_several_objects_change_at_their_construction(
    order: Any,
) -> None:
    found = codes(operands(order))
    assert "0.3 in 18" in found
    assert "0.4 in 19" in found
    assert len(found) == len(set(found))


def test_loop_rate_is_set_aside(order: Any) -> None:
    assert codes(aside_operands(order, operands(order))) == ["20.0 in 29"]
    assert not set(aside_operands(order, operands(order))) & set(operands(order))


class Seen:
    """A search that keeps its arguments."""

    def __init__(self, *given: Any, **named: Any) -> None:
        self.given, self.named = given, named


def made(monkeypatch: pytest.MonkeyPatch, order: Any, method: str, *guards: Guard) -> Seen:
    for name, kind in (("Sweep", Sweep), ("Halving", Halving), ("Asking", None)):
        monkeypatch.setattr(strategies, name, Seen if kind is None else type(name, (Seen,), {}))
    monkeypatch.setattr(strategies, "charts", lambda *_: {})
    monkeypatch.setattr(strategies, "factory", lambda name, folders: (name, folders))

    class Learning(Seen):
        episodes = EpsilonGreedy.episodes

    monkeypatch.setattr(strategies, "EpsilonGreedy", Learning)
    mutants: Any = SimpleNamespace(order=order, mutate="mutate")
    trials: Any = SimpleNamespace(budget=60)
    return strategy(mutants, method, guards, trials)  # type: ignore[return-value]


def test_sweep_gets_the_constants_that_were_set_aside(monkeypatch: pytest.MonkeyPatch, order: Any) -> None:
    found = made(monkeypatch, order, "sweep", WET, ALWAYS)
    assert found.given[1:3] == ("mutate", (WET, ALWAYS))
    assert found.given[4] == "goal"
    assert codes(found.named["aside"]) == ["20.0 in 29"]
    assert found.named["structure_follows"] is True
    assert list(found.named["suggestions"].interlude(0.0)) == []
    assert {*found.given[0], *found.named["late"]} == {*operands(order)}


def test_each_search_gets_the_conditions_that_it_can_use(monkeypatch: pytest.MonkeyPatch, order: Any) -> None:
    halving = made(monkeypatch, order, "halving", WET, DARK)
    assert halving.given[:3] == (operands(order), "mutate", (WET, DARK))
    learning = made(monkeypatch, order, "epsilon-greedy", WET, DARK)
    assert learning.given[2] == (WET, ALWAYS)
    assert learning.given[5] == episode_seeds(3, "search", 40)
    assert made(monkeypatch, order, "epsilon-greedy", ALWAYS, WET).given[2] == (ALWAYS,)
    assert made(monkeypatch, order, "mine:Bayes", WET, DARK, ALWAYS).given[4] == (WET, DARK)
    assert made(monkeypatch, order, "mine:Bayes", ALWAYS, WET).given[4] == (ALWAYS,)


def test_plug_in_seed_depends_on_its_name_and_the_run_seed(
    monkeypatch: pytest.MonkeyPatch, order: Any
) -> None:
    def seed(name: str) -> int:
        found = made(monkeypatch, order, name, ALWAYS).given
        assert found[1] == (name, (Path.cwd(), order.root))
        return int(found[-1])

    first = seed("mine:Bayes")
    assert 1 <= first < 2**31
    assert first == seed("mine:Bayes") != seed("mine:Other")
    order.options.seed = 4
    assert seed("mine:Bayes") != first
