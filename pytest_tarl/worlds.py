"""Adapters for common simulators as the world of a test: Gymnasium environments, with the node as the agent."""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.extras import install_command

if TYPE_CHECKING:
    from pytest_tarl.episode import Tarl

LARGEST_SEED = 2**31  # seeds are below this; every version of Gymnasium accepts such seeds


class GymnasiumWorld:
    """A Gymnasium environment: each step publishes an observation and takes the latest action.

    Attributes: `observation`, `reward` (of the last step), `terminated`, `truncated`, `info`, as Gymnasium names them.
    """

    def __init__(
        self,
        tarl: Tarl,
        environment: Any,
        *,
        observations: str,
        observe: Callable[[Any], Any],
        actions: str,
        act: Callable[[Any], Any],
        idle: Any,
        dt: float | None = None,
        options: Mapping[str, Any] | None = None,
    ) -> None:
        """Reset the environment with a seed from the episode; close it when the episode ends.

        Args:
            tarl: The fixture of the test.
            environment: A Gymnasium environment, or the id of a registered one.
            observations: The topic that observations are published on.
            observe: A function that converts an observation to a message.
            actions: The topic that the node publishes actions on.
            act: A function that converts a message to an action. Numbers outside a Box are clipped, as actuators
                saturate.
            idle: The action before the node's first message.
            dt: The duration of a step in s; by default, the environment's own `dt` or `tau`.
            options: The options of the environment's `reset`.

        Raises:
            SettingsError: Gymnasium is not installed, the environment does not exist, or it has no time step.
        """
        self._tarl = tarl
        self._environment = _made(environment) if isinstance(environment, str) else environment
        tarl.at_end(self._environment.close)
        self._topics = observations, actions
        self._observe, self._act, self._idle = observe, act, idle
        self.dt = _time_step(self._environment) if dt is None else dt
        self.reward = 0.0
        self.terminated = self.truncated = False
        draws = tarl.rng("gymnasium")
        self._environment.action_space.seed(int(draws.integers(LARGEST_SEED)))
        seed = int(draws.integers(LARGEST_SEED))
        self.observation, self.info = self._environment.reset(seed=seed, options=options and dict(options))

    @property
    def over(self) -> bool:
        """Return whether the environment's episode has ended."""
        return bool(self.terminated or self.truncated)

    def step(self) -> float:
        """Publish the observation, run the node for a step, take its action, and return the environment's reward.

        Raise SettingsError if the environment does not have this action.
        """
        observations, actions = self._topics
        self._tarl.bus.publish(observations, self._observe(self.observation))
        self._tarl.step(self.dt)
        message = self._tarl.bus.latest(actions)
        action = self._action(self._idle if message is None else self._act(message), actions)
        self.observation, reward, self.terminated, self.truncated, self.info = self._environment.step(action)
        self.reward = float(reward)
        return self.reward

    def _action(self, asked: Any, topic: str) -> Any:
        """Convert an action to the environment's action space. Raise SettingsError if it does not fit."""
        import numpy as np

        space = self._environment.action_space
        action = asked
        if all(hasattr(space, name) for name in ("low", "high", "shape", "dtype")):
            action = np.asarray(asked, np.float64)
            if action.shape == space.shape and not np.isnan(action).any():
                action = np.clip(action, space.low, space.high).astype(space.dtype)
        if not space.contains(action):
            raise SettingsError(
                f"GymnasiumWorld: the action {reprlib.repr(asked)} from {topic} is not in the environment's "
                f"{space}: change `act`, which makes actions from messages."
            )
        return action


def _made(name: str) -> Any:
    try:
        import gymnasium
    except ImportError:
        raise SettingsError(
            f"GymnasiumWorld({name!r}) needs Gymnasium: run {install_command('gymnasium')}."
        ) from None
    try:
        return gymnasium.make(name)
    except gymnasium.error.Error as problem:
        raise SettingsError(f"GymnasiumWorld: {name!r} cannot be made: {problem}") from None


def _time_step(environment: Any) -> float:
    """Return the environment's time step `dt` or `tau` in s. Raise SettingsError if it has neither."""
    inner = environment.unwrapped
    for name in ("dt", "tau"):
        value = getattr(inner, name, None)
        if isinstance(value, (int, float)) and value > 0:
            return float(value)
    raise SettingsError(
        f"GymnasiumWorld: {type(inner).__name__} does not say how long a step is: pass dt, in seconds."
    )
