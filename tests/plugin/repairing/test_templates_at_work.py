"""Each template from search to running source: it repairs a node that needs exactly this structural change.

The world sends values to the node and expects the commands of a node with the change made by hand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.repairing import structural, template_forms, typical_sizes
from pytest_tarl.repairing.structural import Structures
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tarl_lint.api import analyse
from tests.plugin.patching.repairs import TinyRos

NODE = """\
import rospy
from std_msgs.msg import Float64


class Keeper:
    def __init__(self):
        self.bound = None
        self.slope = None
        self.off = False
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/bound", Float64, self.on_bound)
        rospy.Subscriber("/slope", Float64, self.on_slope)
        rospy.Subscriber("/in", Float64, self.on_value)

    def on_bound(self, msg):
        self.bound = msg.data

    def on_slope(self, msg):
        self.slope = msg.data

    def twice(self, value):
        return value + value

    def on_value(self, msg):
        {body}


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper()
"""
VALUE = "value = msg.data + msg.data\n        self.out.publish(value)"
BUILT = "sent = Float64()\n        sent.data = msg.data\n        sent.data += msg.data\n        self.out.publish(sent)"
BODIES = {  # other ways to compute the same value
    "a call": "value = self.twice(msg.data)\n        self.out.publish(value)",
    "a result": "self.out.publish(self.twice(msg.data))",
    "a message": "self.out.publish(Float64(data=msg.data + msg.data))",
    "a choice": "value = -msg.data if self.off else self.twice(msg.data)\n        self.out.publish(value)",
}
SCALED = "value = 2.0 * msg.data\n        self.out.publish(value)"
INPUT = "value = msg.data\n        self.out.publish(value)"
DIFFERENCE = "value = msg.data - self.slope\n        self.out.publish(value)"
COMPARED = (
    "value = msg.data\n        if value < self.bound:\n            self.out.publish(value)\n"
    "        else:\n            self.out.publish(-value)"
)
PAIR = "first = Float64()\n        first.x = msg.x\n        first.y = msg.y\n        self.out.publish(first)"
BOUNDS = {"comparison": 1.0, "hysteresis": 0.0}  # thresholds that the templates compare with
Command = Callable[[float, float], float]  # command of the repaired node for a value and a slope


def delayed() -> Command:
    """Return a command that sends each value three calls later."""
    values: list[float] = []

    def command(value: float, _: float) -> float:
        values.append(value)
        return values[max(len(values) - 4, 0)]

    return command


def delayed_by_travel() -> Command:
    """Return a command that sends each value after the second sensor has accumulated 6 since it arrived."""
    values: list[tuple[float, float]] = []

    def command(value: float, speed: float) -> float:
        values.append(((values[-1][0] if values else 0.0) + speed, value))
        due = [told for at, told in values if at <= values[-1][0] - 6.0]
        return due[-1] if due else values[0][1]

    return command


def fed_forward() -> Command:
    """Return a command that adds seven times the change of the value."""
    before: list[float] = []

    def command(value: float, slope: float) -> float:
        before.append(value)
        return value + 7.0 * (value - before[max(len(before) - 2, 0)]) - slope

    return command


def kept(step: Callable[[dict[str, float], float], float]) -> Command:
    """Return a command that stores state between calls."""
    state: dict[str, float] = {}
    return lambda value, _: step(state, 2.0 * value)


def integral(state: dict[str, float], x: float) -> float:
    state["sum"] = max(-6.0, min(6.0, state.get("sum", 0.0) + 0.08 * x))
    return x + state["sum"]


def derivative(state: dict[str, float], x: float) -> float:
    before, state["before"] = state.get("before", x), x
    return x + 3.5 * (x - before)


def low_pass(state: dict[str, float], x: float) -> float:
    last = state.get("smooth", x)
    state["smooth"] = last + 0.15 * (x - last)
    return state["smooth"]


def rate_limit(state: dict[str, float], x: float) -> float:
    last = state.get("last", 0.0)
    state["last"] = last + max(-0.35, min(0.35, x - last))
    return state["last"]


def prediction(state: dict[str, float], x: float) -> float:
    value = x / 2.0  # this template predicts the input itself
    change = value - state["before"] if "before" in state else 0.0
    state["before"] = value
    return value + 6.0 * change


def confirmed(state: dict[str, float], x: float) -> float:
    value = x / 2.0
    state["count"] = state.get("count", 0.0) + 1.0 if value < 0.0 else 0.0
    return value if state["count"] >= 6.0 else -value


def median() -> Command:
    """Return a command that sends the median of the last five values."""
    values: list[float] = []

    def command(value: float, _: float) -> float:
        values.append(2.0 * value)
        del values[:-5]
        return sorted(values)[len(values) // 2]

    return command


def hysteresis(state: dict[str, float], x: float) -> float:
    value = x / 2.0
    state["on"] = float(value < (0.9 if state.get("on") else 0.0))
    return value if state["on"] else -value


MENDED: dict[str, tuple[str, Callable[[], Command]]] = {
    "at_least": (VALUE, lambda: lambda value, _: max(0.8, 2 * value)),
    "term": (VALUE, lambda: lambda value, slope: 2 * value - 0.7 * slope),
    "at_most": (VALUE, lambda: lambda value, _: min(0.7, 2 * value)),
    "comparison": (COMPARED, lambda: lambda value, _: value if value <= 1.0 else -value),
    "confirmed": (COMPARED, lambda: kept(confirmed)),
    "dead_band": (VALUE, lambda: lambda value, _: 2 * value if abs(2 * value) > 1.2 else 0.0),
    "delay": (INPUT, delayed),
    "delay_by_travel": (INPUT, delayed_by_travel),
    "derivative": (VALUE, lambda: kept(derivative)),
    "feed_forward": (DIFFERENCE, fed_forward),
    "field_gain": (BUILT, lambda: lambda value, _: 3.4 * value),
    "gain": (INPUT, lambda: lambda value, _: 3.1 * value),
    "hysteresis": (COMPARED, lambda: kept(hysteresis)),
    "integral": (VALUE, lambda: kept(integral)),
    "limit": (VALUE, lambda: lambda value, _: max(-0.9, min(0.9, 2 * value))),
    "low_pass": (VALUE, lambda: kept(low_pass)),
    "median": (VALUE, median),
    "offset": (INPUT, lambda: lambda value, _: value - 0.6),
    "power": (VALUE, lambda: lambda value, slope: 2 * value * slope**2),
    "prediction": (INPUT, lambda: kept(prediction)),
    "rate_limit": (VALUE, lambda: kept(rate_limit)),
    "scale": (VALUE, lambda: lambda value, slope: 2 * value * (1.0 + 0.6 * slope)),
    "sign": (VALUE, lambda: lambda value, _: -2 * value),
    "sum": (VALUE, lambda: lambda value, slope: 2 * value + slope),
    "swapped_axes": (PAIR, lambda: lambda value, slope: slope),
}


# laws by which a constant, here 2.0, follows the slope: they are tried after a value of the constant was found
LAWS: dict[str, Command] = {
    "above": lambda value, slope: 2.0 * max(1.0, slope / 0.8) ** 0.7 * value,
    "follows": lambda value, slope: 2.0 * max(0.1, slope / 0.8) ** 0.7 * value,
    "below": lambda value, slope: 2.0 * min(1.0, slope / 0.8) ** 0.7 * value,
}


class World:
    """Thirty values per mission; the reward is ten minus the relative error of the sent commands."""

    def __init__(self, name: str, folder: Path, body: str = "") -> None:
        known = name in MENDED or name in LAWS
        assert known, f"add what a node mended by {name} sends to MENDED or LAWS in this file"
        usual, self.mended = MENDED[name] if name in MENDED else (SCALED, lambda: LAWS[name])
        self.bound = BOUNDS.get(name, 0.0)
        self.pair = name == "swapped_axes"
        self.steps = name == "comparison"
        path = folder / "keeper.py"
        path.write_text(NODE.format(body=body or usual))
        self.analysis = analyse([path], root=folder)

    def told(self, seed: int) -> Iterator[tuple[float, float]]:
        draws = np.random.default_rng(seed)
        value = float(draws.uniform(-1, 1))
        for _ in range(30):
            value = max(-1.0, min(1.0, value + float(draws.normal(0, 0.35))))
            yield (float(round(value)) if self.steps else value), float(draws.uniform(0, 2))

    def total(self, texts: dict[str, str], seed: int) -> float:
        ros, mended, off, whole = TinyRos(), self.mended(), 0.0, 0.0
        ros.run(texts, next(iter(texts)))
        ros.deliver("/bound", SimpleNamespace(data=self.bound))
        for value, slope in self.told(seed):
            ros.deliver("/slope", SimpleNamespace(data=slope))
            ros.deliver("/in", SimpleNamespace(data=value, x=value, y=slope))
            sent = ros.published[-1]
            wanted = mended(value, slope)
            off += abs((sent.x if self.pair else float(getattr(sent, "data", sent))) - wanted)
            whole += abs(wanted)
        return 10.0 - 10.0 * min(off / whole, 2.0)

    def run(self, candidate: Candidate, seed: int) -> Outcome:
        text = rewrite(
            self.analysis, candidate.mutations, candidate.guard, {"/slope": "std_msgs/msg/Float64"}
        )
        total = self.total({**self.analysis.sources, **text}, seed)
        return Outcome(total, total > 5.0)


SEARCHED = [
    path.stem for path in sorted(SHIPPED.glob("*.toml")) if path.stem not in LAWS
]  # templates that a search of its own tries


@pytest.mark.parametrize("name", SEARCHED)
def test_found_template_is_fitted_and_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    check_found(name, World(name, tmp_path), monkeypatch)


@pytest.mark.parametrize("name", LAWS)
def test_the_patch_of_a_law_of_a_constant_runs(name: str, tmp_path: Path) -> None:
    world = World(name, tmp_path)
    (factor,) = [one for step in world.analysis.sites for one in world.analysis.operands(step.site)]
    slope = Sensor("slope", topic="/slope", field="data", low=0, high=2, bins=4)
    defaults = (("power", 0.7), ("usual", 0.8))
    law = Form(template(SHIPPED / f"{name}.toml"), sensor=slope, parameter="power", defaults=defaults)
    found = Candidate((Mutation(factor, 1.0, form=law),), ALWAYS)
    assert world.run(Candidate((), ALWAYS), 1).total < 9.0, "the node needs no change"
    assert world.run(found, 1).total == pytest.approx(10.0, abs=1e-6)


@pytest.mark.parametrize("name", ["limit", "low_pass", "rate_limit", "integral"])
@pytest.mark.parametrize("body", BODIES)
def test_every_form_of_expression_has_a_template(
    name: str, body: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    world = World(name, tmp_path, BODIES[body])
    recorded = {str(step.site): 1.0 for step in world.analysis.sites}
    monkeypatch.setattr(typical_sizes, "_recorded", lambda *_: recorded)
    check_found(name, world, monkeypatch)


@pytest.mark.parametrize("usual", [0.8, 0.9, 1.15, 1.3])
def test_wrong_typical_value_of_a_sensor_is_adjusted(
    usual: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    world = World("power", tmp_path)
    world.mended = lambda: lambda value, slope: 2 * value * slope
    check_found("power", world, monkeypatch, usual)


def check_found(name: str, world: World, monkeypatch: pytest.MonkeyPatch, usual: float = 1.0) -> None:
    """Search with a single template and check the result on fresh seeds."""
    monkeypatch.setattr(structural, "templates", lambda _: (template(SHIPPED / f"{name}.toml"),))
    monkeypatch.setattr(structural, "telling", lambda _: [])
    monkeypatch.setattr(template_forms, "usual", lambda *_: usual)
    pairs = tuple(Pair(seed, world.run(Candidate((), ALWAYS), seed).total) for seed in range(8))
    online = sum(pair.total for pair in pairs) / len(pairs)
    assert online < 8.0, "the node needs no change"
    slope = Sensor("slope", topic="/slope", field="data", low=0, high=2, bins=4)
    order: Any = SimpleNamespace(
        analysis=world.analysis,
        root=Path(),
        comparison=SimpleNamespace(culprits=(), sensors=(slope,)),
        fixture=SimpleNamespace(sample=SimpleNamespace(lists=()), lists=()),
        online=SimpleNamespace(recorded=SimpleNamespace(sample=SimpleNamespace(lists=()))),
        goal=Goal(pairs, near=8.5, enough=9.0, online=online),
    )
    trials = Trials(world.run, 100)
    found = next(Structures(order, (ALWAYS,), trials).candidates())
    forms = {mutation.form.template.name for mutation in found.mutations if mutation.form is not None}
    assert forms == {name}
    fresh = [world.run(found, seed).total for seed in range(100, 110)]
    assert sum(fresh) / len(fresh) > 8.0
