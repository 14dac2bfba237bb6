"""What a designated test sees as `tarl`: one episode, from seed to trace."""

from __future__ import annotations

import difflib
import math
import reprlib
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pytest_tarl import seeds
from pytest_tarl.errors import RecordingError, RequirementError, SettingsError, TarlError
from pytest_tarl.formulas.declared import NOTHING_REQUIRED, Requirements, check_texts
from pytest_tarl.formulas.judging import Judge, Judged
from pytest_tarl.formulas.signals import Signal
from pytest_tarl.sensors import Cell, Sensor, as_number, reading

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
        self.topics: dict[str, str] = {}
        self.drives_ros = False
        self._sensors = tuple(sensors)
        self.values: dict[str, list[float]] = {}  # of sensors whose bins are yet to be learned
        self._bins: dict[str, int | None] = {}
        self._situated = False  # whether there ever was a cell
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
        self._judge = Judge(requirements.names, requirements.formulas) if requirements.followed else None
        self.judged: tuple[Judged, ...] = ()
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
            self._ros.on_delivery(self._latch)
            if self._replay is not None:
                self._replay.begin(self._ros)
            self._origin = self._ros.scheduler.time
        return self._ros

    @property
    def bus(self) -> Bus:
        """The topics, as the world sees them: `publish` to the nodes, `latest` from them."""
        return self.ros.bus

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
    ) -> None:
        """Start a node: a file relative to the test's folder, run as a program. Raises NodeError when it fails.

        `entry` names the function that an entry point of `setup.py` calls, where there is one: `entry="main"` for
        `driver = robot.driver:main`. `argv` as on its command line, remappings included; `parameters` are added to
        those of all nodes.
        """
        path = (self._folder / script).resolve()
        if not path.is_file():
            raise SettingsError(f"tarl.start: there is no file {script!r} in {self._folder}.")
        self.drives_ros = True
        self.ros.use_definitions_around(path.parent)
        self.ros.parameters.update(parameters or {})
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

        replay.run(self.ros, dt, lambda: self._situated, close, self.observe)
        raise MissionReplayed("The recorded mission is over.")

    def message(self, topic: str, message: Any) -> None:
        """Tell what is being delivered to the node, in a test that delivers messages itself."""
        if not isinstance(topic, str):
            raise SettingsError(
                f"tarl.message got {topic!r} as topic: it takes the name first, tarl.message('/odom', message)."
            )
        self._latch(topic, message)

    def observe(self, **values: Any) -> None:
        """Give the values of sensors that have no topic, and of signals that formulas name."""
        declared = {sensor.name: sensor for sensor in self._sensors}
        signals = {signal.name for signal in self._requirements.signals}
        for name, value in values.items():
            if name in declared:
                self._read(declared[name], value)
            elif name in signals:
                self._give(name, value)
            else:
                known = [*declared, *sorted(signals)]
                close = difflib.get_close_matches(name, known, 1)
                hint = (
                    f"; did you mean {close[0]!r}?" if close else f"; the marker declares {', '.join(known)}."
                )
                raise SettingsError(f"tarl.observe: no sensor and no signal is named {name!r}{hint}")
        if not signals.issuperset(values):
            self._latch_cell()

    def require(self, formula: str) -> None:
        """Require a formula of this episode, judged with those of the marker when the body is over.

        Raises SettingsError for what is no formula over the test's signals.
        """
        check_texts("tarl.require", formula, self._sensors)
        if self._judge is None:
            if self._bins or self._now:
                raise SettingsError(
                    "tarl.require: the episode has begun and its signals were not followed until now: call it before "
                    "the world moves, or say requires=[] in the marker."
                )
            self._judge = Judge(self._requirements.names, ())
        self._judge.require(formula)

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
        if self._judge is None:
            return
        whole = ended is None or (self._replay is not None and self._replay.done)
        try:
            self.judged = self._judge.conclude(self._now)
        except TarlError:
            if whole:
                raise
            return
        if not whole:
            return
        too_short = self._judge.unjudged(self._now) if self._alone else ""
        if too_short:
            raise SettingsError(too_short)
        violation = self._judge.violation(self.judged)
        if violation:
            raise RequirementError(violation)

    def rewarded(self, trace: Trace) -> Trace:
        """Return the trace with the rewards that formulas give, where they do."""
        if not self._requirements.rewarding or self._judge is None:
            return trace
        import numpy as np

        rewards = self._judge.rewards(self._now, self._requirements.cap)
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
        return (*ended, *missing, *(self._replay.notes if self._replay is not None else ()))

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
        silent = [sensor for sensor in self._sensors if sensor.name not in self._bins]
        if silent:
            return RecordingError(_silence(silent[0]))
        if not self._situated:
            return RecordingError(
                f"Sensor {next(name for name, value in self._bins.items() if value is None)!r} was NaN whenever the "
                "others were known, which tells nothing: look at what the world gives it."
            )
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

    def _latch(self, topic: str, message: Any) -> None:
        """Hold the sensors' bins until the next message on their topic."""
        changed = False
        for sensor in self._sensors:
            if sensor.topic is not None and same_topic(sensor.topic, topic):
                self._read(sensor, _value(sensor, message))
                self.topics[sensor.topic] = message_type_name(message)
                changed = True
        for signal in self._requirements.signals:
            if signal.topic is not None and same_topic(signal.topic, topic):
                self._give(signal.name, _value(signal, message))
                self.topics[signal.topic] = message_type_name(message)
        if changed:
            self._latch_cell()

    @property
    def _now(self) -> int:
        """Return the virtual nanoseconds since the episode, or the recorded mission, began."""
        return 0 if self._ros is None else self._ros.scheduler.time - self._origin

    def _give(self, name: str, value: Any) -> None:
        if self._judge is not None:
            self._judge.give(name, value, self._now)

    def _stepped(self) -> None:
        """Close a step for the formulas; what it earns by them is known when the episode is over."""
        if self._judge is None:
            return
        self._judge.steps.append(self._now)
        if self._requirements.rewarding:
            self._recorder.reward(0.0, {})
            self._rewards += 1

    def _read(self, sensor: Sensor, value: Any) -> None:
        if self._judge is not None and not sensor.categories:
            self._give(sensor.name, value)
        self._bins[sensor.name] = sensor.bin(value)
        if sensor.to_learn:
            self.values.setdefault(sensor.name, []).append(float(value))

    def _latch_cell(self) -> None:
        bins = [self._bins.get(sensor.name) for sensor in self._sensors]
        known = [value for value in bins if value is not None]
        cell: Cell | None = tuple(known) if len(known) == len(bins) else None
        self._situated = self._situated or cell is not None
        self._recorder.latch(cell)


def same_topic(first: str, second: str) -> bool:
    """Compare topic names; a leading slash makes no difference."""
    return first.lstrip("/") == second.lstrip("/")


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


def message_type_name(message: Any) -> str:
    """Name a message's type as ROS 2 does: `std_msgs/msg/Bool`. Empty for what is no ROS message."""
    kind = type(message)
    package = kind.__module__.split(".")[0]
    return f"{package}/msg/{kind.__name__}" if hasattr(kind, "__slots__") or hasattr(kind, "_type") else ""


def _value(sensor: Sensor | Signal, message: Any) -> Any:
    if callable(sensor.field):
        return sensor.field(message)
    try:
        return reading(message, sensor.field or "")
    except (AttributeError, IndexError, KeyError, TypeError) as problem:
        raise SettingsError(
            f"{type(sensor).__name__} {sensor.name!r}: a message on {sensor.topic} ({type(message).__name__}) has no "
            f"field {sensor.field!r}. Mend the field in the marker."
        ) from problem


def _silence(sensor: Sensor) -> str:
    if sensor.topic is None:
        return f"Sensor {sensor.name!r} was never observed: call tarl.observe({sensor.name}=…) in each step."
    return (
        f"Sensor {sensor.name!r} heard nothing on {sensor.topic}: publish it with tarl.bus.publish({sensor.topic!r}, "
        f"…), or tell its message with tarl.message({sensor.topic!r}, message), or mend the topic in the marker."
    )
