"""Gymnasium environments as worlds of tests: a small one defined here, and installed real ones."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.seeds import generator
from pytest_tarl.worlds import GymnasiumWorld


class Box:
    """A space as Gymnasium's Box."""

    def __init__(self, low: float, high: float) -> None:
        self.low, self.high, self.shape, self.dtype = low, high, (1,), np.dtype(np.float32)
        self.seeded: int | None = None

    def seed(self, seed: int) -> None:
        self.seeded = seed

    def contains(self, action: Any) -> bool:
        return getattr(action, "shape", None) == (1,) and bool(
            ((self.low <= action) & (action <= self.high)).all()
        )


class Environment:
    """Integrates actions from a random start, and ends beyond 1."""

    dt = 0.1

    def __init__(self) -> None:
        self.action_space, self.unwrapped, self.closed = Box(-0.5, 0.5), self, False
        self.seed: int | None = None
        self.taken: list[float] = []

    def reset(self, *, seed: int, options: Any) -> tuple[float, dict[str, Any]]:
        self.seed, self.options = seed, options
        self.state = float(np.random.default_rng(seed).uniform(0.0, 0.1))
        return self.state, {}

    def step(self, action: Any) -> tuple[float, float, bool, bool, dict[str, Any]]:
        self.taken.append(float(action[0]))
        self.state += float(action[0])
        return self.state, np.float32(-self.state), self.state > 1.0, False, {}

    def close(self) -> None:
        self.closed = True


class Episode:
    """The part of the fixture `tarl` that a world uses; the node publishes one of `answers` in each step."""

    def __init__(self, answers: list[Any], seed: int = 0) -> None:
        self.seed, self.answers, self.ends, self.heard, self.time = seed, answers, [], [], 0.0
        self.bus = SimpleNamespace(
            publish=lambda topic, message: self.heard.append((topic, message)),
            latest=lambda _: self.answers.pop(0),
        )

    def rng(self, name: str) -> np.random.Generator:
        return generator(self.seed, name)

    def at_end(self, call: Any) -> None:
        self.ends.append(call)

    def step(self, dt: float) -> None:
        self.time += dt


def world(episode: Episode, environment: Any, **more: Any) -> GymnasiumWorld:
    ends = {"observations": "/x", "observe": lambda x: f"x={x:.3f}", "actions": "/u", "act": lambda u: [u]}
    return GymnasiumWorld(episode, environment, **{**ends, "idle": [0.0], **more})  # type: ignore[arg-type]


def test_environment_receives_actions_until_it_ends() -> None:
    episode, environment = Episode([None, 0.25, 9.0, 9.0]), Environment()
    ours = world(episode, environment, options={"a": 1})
    begun = ours.observation
    assert (ours.over, ours.terminated, ours.truncated, ours.reward) == (False, False, False, 0.0)
    rewards = [ours.step() for _ in range(4)]
    assert environment.taken == [0.0, 0.25, 0.5, 0.5]  # idle, inside, clipped twice
    assert episode.heard[:2] == [("/x", f"x={begun:.3f}")] * 2
    assert rewards == pytest.approx([-begun, -begun - 0.25, -begun - 0.75, -begun - 1.25], rel=1e-6)
    assert all(type(one) is float for one in rewards)
    assert (ours.over, environment.options) == (True, {"a": 1})
    assert episode.time == pytest.approx(0.4)
    episode.ends[0]()
    assert environment.closed


def test_an_environment_may_end_by_its_limit_of_time() -> None:
    environment = Environment()
    ours = world(Episode([0.25, 0.25]), environment)
    ended: Any = iter([(0.0, 1, False, False, {}), (0.0, 1, False, True, {})])
    environment.step = lambda _: next(ended)  # type: ignore[assignment,method-assign]
    over = []
    for _ in range(2):
        ours.step()
        over.append((ours.over, ours.terminated, ours.truncated))
    assert over == [(False, False, False), (True, False, True)]


def test_the_seeds_of_an_episode_determine_the_environment() -> None:
    first, again, other = Environment(), Environment(), Environment()
    for environment, seed in ((first, 3), (again, 3), (other, 4)):
        world(Episode([], seed), environment)
    assert (first.seed, first.action_space.seeded) == (again.seed, again.action_space.seeded)
    assert (first.seed, first.action_space.seeded) != (other.seed, other.action_space.seeded)


@pytest.mark.parametrize("answer", [float("nan"), [0.1, 0.2]])
def test_the_action_none_is_refused(answer: Any) -> None:
    with pytest.raises(SettingsError, match="from /u is not in the environment's"):
        world(Episode([answer]), Environment()).step()


def test_environment_needs_a_time_step() -> None:
    environment = Environment()
    environment.unwrapped = object()  # type: ignore[assignment]
    with pytest.raises(SettingsError, match="does not say how long a step is: pass dt"):
        world(Episode([]), environment)
    assert world(Episode([]), environment, dt=0.5).dt == 0.5


def test_a_missing_gymnasium_gives_the_install_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "gymnasium", None)
    with pytest.raises(SettingsError, match=r"needs Gymnasium: run pip install .*\[gymnasium\]"):
        world(Episode([]), "CartPole-v1")


def test_environments_of_gymnasium_can_be_used_as_worlds() -> None:
    pytest.importorskip("gymnasium")
    cart = world(Episode([1.0, -1.0]), "CartPole-v1", act=lambda u: int(u > 0), observe=list)
    assert (cart.dt, cart.step(), cart.step()) == (0.02, 1.0, 1.0)
    pendulum = world(Episode([99.0]), "Pendulum-v1", observe=list)
    assert pendulum.step() <= 0.0
    with pytest.raises(SettingsError, match="'NoSuch-v1' cannot be made"):
        world(Episode([]), "NoSuch-v1")
