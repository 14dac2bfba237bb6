"""What a designated test sees as `tarl`: one episode, from seed to trace."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pytest_tarl import seeds
from pytest_tarl.errors import RecordingError, SettingsError
from pytest_tarl.formulas.declared import NOTHING_REQUIRED, Requirements
from pytest_tarl.formulas.episode import EpisodeFormulas
from pytest_tarl.formulas.judging import Judged
from pytest_tarl.sensors import Sensor, as_number
from pytest_tarl.situation import Situation

if TYPE_CHECKING:
    import numpy as np

    from pytest_tarl.bags.replay import Judgement, Replay
    from pytest_tarl.instrumentation.importhook import NodeImports
    from pytest_tarl.instrumentation.recorder import Recorder
    from pytest_tarl.instrumentation.trace import Trace
    from pytest_tarl.ros import Bus, Ros

LARGEST = 1e100  # size of a reward; that of a flow value is bounded by the same number


class Tarl:
    """The fixture `tarl`: random numbers, the in-process ROS, sensors and reward of one episode."""

    def __init__(
        self,
        seed: int,
        sensors: Sequence[Sensor],
        folder: Path,
        recorder: Recorder,
        imports: NodeImports,
        *,
        kind: str = "embedded",
        nodes: Sequence[str] = (),
        replay: Replay | None = None,
        requirements: Requirements = NOTHING_REQUIRED,
        alone: bool = False,
    ) -> None:
        self.seed = seed
        self.drives_ros = False
        self._folder = folder
        self._kind = kind
        self._nodes = tuple(nodes)
        self._replay = replay
        self._recorder = recorder
        self._imports = imports
        self._rewards = 0
        self._streams: dict[str, np.random.Generator] = {}
        self._ros: Ros | None = None
        self._origin = 0  # of virtual time, in ns
        self._requirements = requirements
        self._alone = alone  # whether it is the only episode of a plain test run
        self._formulas = EpisodeFormulas(requirements, tuple(sensors), lambda: self._now)
        self._situation = Situation(tuple(sensors), requirements, self._formulas, recorder)
        self.topics = self._situation.topics
        self.values = self._situation.values
        self._open = ExitStack()
        self._open.enter_context(imports)

    def rng(self, name: str) -> np.random.Generator:
        """Return this episode's stream of random numbers with that name; asked again, it goes on where it was."""
        if name not in self._streams:
            self._streams[name] = seeds.generator(self.seed, name)
        return self._streams[name]

    @property
    def ros(self) -> Ros:
        """The ROS of this episode: the in-process one, or the real one under `--tarl-ros=real`."""
        if self._ros is None:
            from pytest_tarl.realros.choice import make_ros

            self._ros = make_ros(self._kind, [self._folder / node for node in self._nodes])
            self._open.enter_context(self._ros.installed())
            self._open.callback(self._ros.close)
            self._ros.on_delivery(self._situation.hear)
            if self._replay is not None:
                self._replay.begin(self._ros)
            self._origin = self._ros.scheduler.time
        return self._ros

    @property
    def bus(self) -> Bus:
        """The topics, as the world sees them: `publish` to the nodes, `latest` from them."""
        return self.ros.bus

    @property
    def judged(self) -> tuple[Judged, ...]:
        """What the formulas came to, once the episode is concluded."""
        return self._formulas.judged

    @property
    def now(self) -> float:
        """Virtual seconds since the episode began."""
        return self.ros.now

    def start(
        self,
        script: str,
        *,
        name: str | None = None,
        argv: Sequence[str] = (),
        parameters: Mapping[str, Any] | None = None,
        entry: str | None = None,
        launch: str | Literal[False] | None = None,
    ) -> None:
        """Start a node: a file relative to the test's folder, run as a program. Raises NodeError when it fails.

        `entry` names the function that an entry point of `setup.py` calls, where there is one: `entry="main"` for
        `driver = robot.driver:main`. `argv` as on its command line, remappings included; `parameters` are added to
        those of all nodes. Those that the test does not state come from the launch file of the workspace that starts
        the script: from `launch` if that names one, from none with `launch=False`.
        """
        path = (self._folder / script).resolve()
        if not path.is_file():
            raise SettingsError(f"tarl.start: there is no file {script!r} in {self._folder}.")
        self.drives_ros = True
        self.ros.use_definitions_around(path.parent)
        self.ros.give(parameters or {})
        if launch is not False:
            from pytest_tarl.ros.launched import given

            self.ros.launch(given(path, None if launch is None else (self._folder / launch).resolve()))
        imports = self._imports

        def program() -> None:
            imports.run(path, entry)

        self.ros.start(program, name=name or path.stem, argv=argv)

    def step(self, dt: float) -> None:
        """Let the nodes run and virtual time advance by `dt` seconds, until every node waits again."""
        seconds = as_number(dt)
        if seconds is None or not 0 <= seconds < math.inf:
            raise SettingsError(
                f"tarl.step got {dt!r}: time advances by a finite number of seconds, such as 0.1."
            )
        if self._replay is not None:
            self._replayed(self._replay, seconds)
        self.ros.step(seconds)
        self._stepped()

    def _replayed(self, replay: Replay, dt: float) -> None:
        """Let a recorded mission take the place of the rest of the test's body."""
        from pytest_tarl.bags.replay import MissionReplayed

        def close(judgement: Judgement | None) -> None:
            self._stepped()
            if isinstance(judgement, Mapping):
                self.reward(**judgement)
            elif judgement is not None:
                self.reward(judgement)

        replay.run(self.ros, dt, lambda: self._situation.known, close, self.observe)
        raise MissionReplayed("The recorded mission is over.")

    def message(self, topic: str, message: Any) -> None:
        """Tell what is being delivered to the node, in a test that delivers messages itself."""
        if not isinstance(topic, str):
            raise SettingsError(
                f"tarl.message got {topic!r} as topic: it takes the name first, tarl.message('/odom', message)."
            )
        self._situation.hear(topic, message)

    def observe(self, **values: Any) -> None:
        """Give the values of sensors that have no topic, and of signals that formulas name."""
        self._situation.observe(values)

    def require(self, formula: str) -> None:
        """Require a formula of this episode, judged with those of the marker when the body is over.

        Raises SettingsError for what is no formula over the test's signals.
        """
        self._formulas.require(formula, begun=self._situation.begun)

    def reward(self, total: float | None = None, /, **parts: float) -> None:
        """Give the monitor's judgement of this simulation step, once a step; parts are summed and reported apart."""
        if total is None and not parts:
            raise SettingsError(
                "tarl.reward needs a number, or parts such as tarl.reward(progress=0.2, clearance=-1)."
            )
        if self._requirements.rewarding:
            raise SettingsError(
                'The marker says reward="robustness", so each step has its reward by the formulas: take tarl.reward '
                "out of the test, or reward out of the marker."
            )
        given = {name: _reward(value) for name, value in parts.items()}
        amount = _reward(sum(given.values()) if total is None else total)
        self._recorder.reward(amount, given)
        self._rewards += 1

    def conclude(self, ended: BaseException | None) -> None:
        """Judge the formulas when the body is over, which `ended` ended. Raises RequirementError where one is violated.

        A body that failed by itself fails for its own reason.
        """
        whole = ended is None or (self._replay is not None and self._replay.done)
        self._formulas.conclude(whole=whole, alone=self._alone)

    def rewarded(self, trace: Trace) -> Trace:
        """Return the trace with the rewards that formulas give, where they do."""
        rewards = self._formulas.rewards()
        if rewards is None:
            return trace
        import numpy as np

        return replace(trace, reward=np.array(rewards, np.float64))

    def close(self) -> None:
        """End the nodes and forget the episode."""
        self._open.close()

    def notes(self) -> tuple[str, ...]:
        """Return what the user should hear, though the episode counts; known once it is closed."""
        late = self._ros.shutdown_errors if self._ros is not None else ()
        ended = [f"{error} It was being ended, so the episode counts all the same." for error in late]
        missing = [
            f"nothing can be recorded at {path.name}:{', '.join(map(str, sorted({line for line, _ in positions})))}: "
            "the slices there stay empty."
            for path, positions in self._imports.unrecorded.items()
        ]
        started = self._ros.notes if self._ros is not None else ()
        return (*ended, *missing, *started, *(self._replay.notes if self._replay is not None else ()))

    def problem(self) -> RecordingError | None:
        """Return why the episode cannot be learned from: no reward, a silent sensor, a mute node; None when it can."""
        if self._replay is not None:
            return self._unplayed(self._replay)
        if not self._rewards and self._requirements.rewarding:
            return RecordingError(
                'The test never called tarl.step, so there is no step to reward: reward="robustness" counts steps of '
                "virtual time."
            )
        if not self._rewards:
            return RecordingError(
                "The test never called tarl.reward: call it once a simulation step with the monitor's judgement, "
                "for instance tarl.reward(world.monitor())."
            )
        problem = self._situation.problem()
        if problem is not None:
            return problem
        if self.drives_ros and not self.ros.published:
            heard = ", ".join(sorted(self.ros.subscribed)) or "no topic"
            return RecordingError(
                "The node published nothing in the whole episode, so nothing can be learned: look whether it gets "
                f"the messages that it waits for (it subscribes to {heard})."
            )
        return None

    def _unplayed(self, replay: Replay) -> RecordingError | None:
        name = replay.bag.path.name
        if not replay.begun:
            return RecordingError(
                f"{name} was not replayed: the test ended before it called tarl.step, at which the recorded mission "
                "takes over. Only nodes that are run with tarl.start and tarl.step can be told what a bag holds."
            )
        if not self._rewards:
            return RecordingError(
                f"Nothing was learned from {name}: its sensors were never all known at the end of a step."
            )
        return None

    @property
    def _now(self) -> int:
        """Return the virtual nanoseconds since the episode, or the recorded mission, began."""
        return 0 if self._ros is None else self._ros.scheduler.time - self._origin

    def _stepped(self) -> None:
        if self._formulas.stepped():
            self._recorder.reward(0.0, {})
            self._rewards += 1


def _reward(value: Any) -> float:
    number = as_number(value)
    if number is None or not abs(number) < math.inf:
        raise SettingsError(f"tarl.reward got {reprlib.repr(value)}: rewards must be finite numbers.")
    if abs(number) > LARGEST:
        raise SettingsError(
            f"tarl.reward got {reprlib.repr(value)}: rewards are at most {LARGEST:g} in size, else sums of their "
            "squares overflow. Scale the monitor's judgement."
        )
    return number
