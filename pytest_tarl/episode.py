"""The fixture `tarl` of a designated test: an episode, from its seed to its trace."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pytest_tarl import seeds
from pytest_tarl.ended_episode import EndedEpisode
from pytest_tarl.errors import SettingsError, TarlError
from pytest_tarl.faults.installing import NO_FAULTS, Faults
from pytest_tarl.finalizers import run_finalizers
from pytest_tarl.formulas.judging import Judged
from pytest_tarl.formulas.marker_arguments import NOTHING_REQUIRED, Requirements
from pytest_tarl.formulas.running_episode import EpisodeFormulas
from pytest_tarl.rewards import checked_reward
from pytest_tarl.sensors import Sensor, as_number
from pytest_tarl.situation import Situation
from pytest_tarl.starting import Starter

if TYPE_CHECKING:
    import numpy as np

    from pytest_tarl.bags.replay import Judgement, Replay
    from pytest_tarl.external.arguments import Call
    from pytest_tarl.external.simulator import Simulator
    from pytest_tarl.instrumentation.importhook import NodeImports
    from pytest_tarl.instrumentation.recorder import Recorder
    from pytest_tarl.instrumentation.trace import Trace
    from pytest_tarl.outputs import Outputs
    from pytest_tarl.parameter_files import Parameters
    from pytest_tarl.ros import Bus, Ros
    from pytest_tarl.starting import Replacement

_LAST = 2**31 - 1  # largest number of seconds in a ROS 2 time (int32)


class Tarl:
    """The fixture `tarl`: random numbers, in-process ROS, sensors and reward of one episode."""

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
        faults: Faults = NO_FAULTS,
        drifted: bool = False,
        changed: bool = False,
        outputs: Outputs | None = None,
    ) -> None:
        self.seed = seed
        self.drives_ros = False
        self._folder = folder
        self._kind = kind
        self._nodes = tuple(nodes)
        self._replay = replay
        # a recorded mission already includes the faults of its robot
        self._faults = NO_FAULTS if replay is not None else faults
        # whether a drift is active; it is then not an error if nodes publish nothing
        self._drifted = drifted or bool(self._faults.active)
        self._changed = changed  # whether a repair candidate replaces the text of a file
        self._outputs = outputs
        self._recorder = recorder
        self._imports = imports
        self._rewards = 0
        self._streams: dict[str, np.random.Generator] = {}
        self._ros: Ros | None = None
        self._starter = Starter(folder, imports, lambda: self.ros)
        self._origin = 0  # virtual time (ns) at the start of the episode
        self._requirements = requirements
        self._alone = alone  # whether this is the only episode, as in a pytest run without TARL
        self._formulas = EpisodeFormulas(requirements, tuple(sensors), lambda: self._now)
        self._situation = Situation(tuple(sensors), requirements, self._formulas, recorder)
        self.topics = self._situation.topics
        self.values = self._situation.values
        self.simulator: Simulator | None = None  # the external simulator, if the test uses one
        self._open = ExitStack()
        self._open.enter_context(imports)

    def rng(self, name: str) -> np.random.Generator:
        """Return the episode's random generator of this name; the same name always gives the same object."""
        if name not in self._streams:
            self._streams[name] = seeds.generator(self.seed, name)
        return self._streams[name]

    @property
    def ros(self) -> Ros:
        """Return the ROS of this episode: the in-process one, or a real one with `--tarl-ros=real`."""
        if self._ros is None:
            from pytest_tarl.realros.choice import make_ros

            self._ros = make_ros(self._kind, [self._folder / node for node in self._nodes])
            self._open.enter_context(self._ros.installed())
            self._open.callback(self._ros.close)
            self._ros.on_delivery(self._situation.hear)
            self._ros.bus.emitted = self._outputs
            if self._replay is not None:
                self._replay.begin(self._ros)
            self._origin = self._ros.scheduler.time
            self._faults.install(self._ros)
        return self._ros

    @property
    def bus(self) -> Bus:
        """Return the simulated world's topics: `publish` to nodes, and read a node's `latest` message."""
        return self.ros.bus

    @property
    def parameters_read(self) -> Mapping[str, bool | int | float]:
        """Return the numbers that nodes have read as parameters, by absolute name; empty with a real ROS."""
        return dict(getattr(self._ros, "parameters_read", {}))

    @property
    def judged(self) -> tuple[Judged, ...]:
        """Return the results of the formulas; available after `conclude`."""
        return self._formulas.judged

    @property
    def now(self) -> float:
        """Return the virtual seconds since the episode began."""
        return self.ros.now if self.simulator is None else self._now / 1e9

    def start(
        self,
        script: str,
        *,
        name: str | None = None,
        argv: Sequence[str] = (),
        parameters: Parameters | None = None,
        entry: str | None = None,
        launch: str | Literal[False] | None = None,
    ) -> None:
        """Start a node: a file relative to the test's folder, run as a program. Raise NodeError if it fails.

        - `entry`: the function to call if the node is an entry point in `setup.py`, such as `entry="main"` for `driver
          = robot.driver:main`.
        - `argv`: the node's command line, including remappings.
        - `parameters`: parameters for all nodes of the episode, as a mapping or as the path of a YAML file relative to
          the test's folder.
        - `launch`: the launch file that provides further parameters, and the command line if `argv` is empty. By
          default, TARL looks for launch files in the workspace that start the script. With `launch=False`, it reads
          none.
        """
        self.drives_ros = True
        self._starter.start(script, name, argv, parameters, entry, launch)

    def launch(
        self,
        file: str,
        *,
        arguments: Mapping[str, Any] | None = None,
        only: Sequence[str] | None = None,
        replace: Mapping[str, Replacement] | None = None,
        parameters: Parameters | None = None,
    ) -> None:
        """Start the Python nodes of a launch file, with their names, namespaces, remappings and parameters.

        - `file`: a path relative to the test's folder, the name of a launch file in the workspace, or `package/name`.
        - `arguments`: the launch arguments.
        - `only`: the names of the nodes to start.
        - `replace`: node name → function that runs instead. The function gets a `StandIn`, which publishes and
          subscribes under the topic names in the node's code.
        - `parameters`: parameters for all nodes, as a mapping or as the path of a YAML file. They take precedence over
          those of the launch file.

        A note lists the nodes that are neither Python nor replaced.

        Raise SettingsError for an unknown file, argument or node, and NodeError if a node fails.
        """
        self.drives_ros = True
        self._starter.launch(file, arguments or {}, only, replace or {}, parameters)

    def external(
        self,
        command: str | Sequence[str],
        *,
        ready: str | Sequence[str],
        clock: str = "/clock",
        step: str | Call | None = None,
        reset: str | Call | None = None,
        every_step: Sequence[str] = (),
        environment: Mapping[str, str] | None = None,
        timeout: float = 60.0,
        patience: float = 10.0,
    ) -> Simulator:
        """Start a simulator as the world of this episode; call this before `start`.

        The simulator uses a real ROS. Nodes receive what it publishes, and it receives what they publish. `tarl.step`
        runs both.

        Args:
            command: The program, run in the test's folder. Its environment sets TARL_SEED and a private ROS domain
                or master.
            ready: Topics that the simulator publishes or subscribes to once it is ready.
            clock: The topic on which it publishes its time; the nodes' clocks show this time.
            step: The service that runs the simulator for one step. Without it, the simulator runs at its own pace.
            reset: The service that resets the simulator between episodes. Without it, each episode starts a new one.
            every_step: Topics that it publishes in each step; a step ends once a message has arrived on each of them.
            environment: Further environment variables.
            timeout: Maximum real time until the simulator is ready, in s.
            patience: Real time in s after which a simulator that neither answers nor advances its clock counts as hung.

        Raises:
            SettingsError: The arguments are invalid, no rclpy or rospy is installed, or a node is already running.
            SimulatorError: The simulator ended or did not become ready.
        """
        from pytest_tarl.external.arguments import setup
        from pytest_tarl.external.simulator import Simulator

        if self.drives_ros or self._replay is not None or self.simulator is not None:
            raise SettingsError(
                "call tarl.external once in a test, before tarl.start, and not in the replay of a bag."
            )
        arguments = setup(
            command,
            self._folder,
            environment={**(environment or {}), **({} if reset else {"TARL_SEED": str(self.seed)})},
            clock=clock,
            ready=ready,
            step=step,
            reset=reset,
            every_step=every_step,
            timeout=timeout,
            patience=patience,
        )
        self.simulator = Simulator(arguments, self.ros, [*self._situation.subscribed])
        self._open.callback(self.simulator.end)
        self.simulator.begin()
        self._origin = self.ros.scheduler.time
        return self.simulator

    def step(self, dt: float) -> None:
        """Run the nodes and advance virtual time by `dt` seconds, until every node waits again.

        Raise SettingsError if `dt` is invalid.
        """
        seconds = as_number(dt)
        if seconds is None or not 0 <= seconds < math.inf:
            raise SettingsError(f"tarl.step got {dt!r}: give a finite number of seconds, such as 0.1.")
        if self.now + seconds > _LAST:
            raise SettingsError(f"tarl.step got {dt!r}: the times of ROS end {_LAST} s after the start.")
        if self._replay is not None:
            self._replayed(self._replay, seconds)
        (self.ros.step if self.simulator is None else self.simulator.advance)(seconds)
        self._stepped()

    def _replayed(self, replay: Replay, dt: float) -> None:
        """Replay a recorded mission instead of running the rest of the test's body."""
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
        """Report a message that the test passed to the node without the bus; sensors and signals then read it.

        Raise SettingsError if the topic is not a string.
        """
        if not isinstance(topic, str):
            raise SettingsError(
                f"tarl.message got {topic!r} as topic: the topic name comes first, as in tarl.message('/odom', "
                "message)."
            )
        self._situation.hear(topic, message)

    def type(self, text: str, node: str | None = None) -> None:
        """Type text on the terminals of all running nodes, or only of `node` (a file or node name).

        Raise SettingsError if no such node is running.
        """
        self.ros.type(text, node)

    def observe(self, **values: Any) -> None:
        """Set the values of sensors without a topic, and of signals in formulas."""
        self._situation.observe(values)

    def require(self, formula: str) -> None:
        """Require that a formula holds in this episode; it is evaluated when the test's body ends.

        Raise SettingsError if it is not a formula over the test's signals.
        """
        self._formulas.require(formula, begun=self._situation.begun)

    def reward(self, total: float | None = None, /, **parts: float) -> None:
        """Set the reward of this simulation step; call this once per step.

        Named parts are summed, and the report shows each of them.

        Raise SettingsError if a value is not a finite number.
        """
        self._recorder.reward(*checked_reward(total, parts, by_formulas=self._requirements.rewarding))
        self._rewards += 1

    def at_end(self, call: Callable[[], object]) -> None:
        """Register a function to call when the episode ends, even after an error; the newest is called first."""
        self._open.callback(call)

    def conclude(self, ended: BaseException | None) -> None:
        """Evaluate the formulas after the body; `ended` is its exception. Raise RequirementError for a violation.

        If the body itself failed, raise nothing: pytest reports the body's error.
        """
        whole = ended is None or (self._replay is not None and self._replay.done)
        self._formulas.conclude(whole=whole, alone=self._alone)

    def rewarded(self, trace: Trace) -> Trace:
        """Return the trace; with the marker's `reward="robustness"`, formulas replace its rewards."""
        rewards = self._formulas.rewards()
        if rewards is None:
            return trace
        import numpy as np

        return replace(trace, reward=np.array(rewards, np.float64))

    def close(self) -> None:
        """Shut the nodes down and release the episode."""
        self._open.close()
        run_finalizers(self._folder / node for node in self._nodes)

    def notes(self) -> tuple[str, ...]:
        """Return notes for the user on a usable episode; complete only after `close`."""
        return self._ended().notes()

    @property
    def starting_notes(self) -> tuple[str, ...]:
        """Return notes for the user on how the nodes were started."""
        return self._ros.notes if self._ros is not None else ()

    def silence(self) -> str:
        """Return which sensor or node was silent in the whole episode, or an empty text."""
        return self._ended().silence()

    def problem(self) -> TarlError | None:
        """Return why the episode is unusable (such as a test without rewards), or None if it is usable."""
        return self._ended().problem()

    def _ended(self) -> EndedEpisode:
        return EndedEpisode(
            rewards=self._rewards,
            requirements=self._requirements,
            situation=self._situation,
            faults=self._faults,
            drifted=self._drifted,
            changed=self._changed,
            ros=self._ros,
            drives_ros=self.drives_ros,
            replay=self._replay,
            unrecorded=self._imports.unrecorded,
        )

    @property
    def _now(self) -> int:
        """Return the virtual time (ns) since the start of the episode or of the recorded mission."""
        return 0 if self._ros is None else self._ros.scheduler.time - self._origin

    def _stepped(self) -> None:
        if self._formulas.stepped():
            self._recorder.reward(0.0, {})
            self._rewards += 1
