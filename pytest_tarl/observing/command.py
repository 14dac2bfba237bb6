"""`pytest_tarl observe node.py`: run a node and log its missions."""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from pytest_tarl.errors import AnalysisError, LogError, text_of
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.sites import Plan, plan
from pytest_tarl.learning.fixture import Fixture, load
from pytest_tarl.observing.listeners import Topics, watched
from pytest_tarl.observing.observer import Observer
from pytest_tarl.observing.writer import Rotation
from pytest_tarl.realros.choice import libraries
from pytest_tarl.ros.argv import command_line
from pytest_tarl.sensors import binning_digest
from tarl_lint.api import analyse

# rclpy raises this exception after a signal; rospy raises KeyboardInterrupt
SHUT_DOWN = "ExternalShutdownException"


@dataclass(frozen=True)
class Order:
    """The arguments of the command line."""

    node: Path
    argv: tuple[str, ...] = ()
    entry: str | None = None  # the function that the node's entry point calls
    log: Path = Path(".tarl/missions.log")
    fixture: Path | None = None
    modules: tuple[Path, ...] = ()  # other files of the node
    reward: str = ""
    mission: str = ""
    idle: float | None = None
    step: float | None = None
    log_size: int = 0  # size in bytes at which the log is rotated; 0 for never
    log_keep: int = 0  # number of rotated logs to keep; 0 for all


def observe(order: Order) -> str:
    """Run the node until it ends; return the line to print.

    Raise LogError or AnalysisError if the node cannot be observed, FixtureError if the recording cannot be read, and
    whatever the node raises.
    """
    _check(order)
    fixture = load(order.fixture or _fixture_of(order.node))
    sites = _sites(order)
    library = next(iter(libraries([order.node, *order.modules])), None)
    if library is None:
        raise LogError(f"{order.node} imports neither rospy nor rclpy, so there is nothing to observe.")
    about = {
        "node": order.node.name,
        "test": fixture.test,
        "sensors": [sensor.name for sensor in fixture.sensors],
        "bins": binning_digest(fixture.sensors),
        "sites": [place.id for place in sites.places],
        "judged": order.step is not None,
    }
    _warn_of_mute_sensors(fixture)
    observer = Observer(
        fixture.sensors,
        order.log,
        about,
        rotation=Rotation(order.log_size, order.log_keep),
        idle=order.idle,
        signals=[signal for signal in fixture.signals if signal.topic is not None],
        following=fixture.sample.judgements is not None,
    )
    try:
        with (
            watched(library, observer, _topics(order, fixture), idle=order.idle is not None),
            _steps(order, observer),
        ):
            _run(order, observer, sites)
    finally:
        observer.close()
    return f"wrote {order.log}" + (f"; {observer.problem}" if observer.problem else "")


def _run(order: Order, observer: Observer, sites: Plan) -> None:
    positions = {Path.cwd() / path: at for path, at in sites.positions.items()}
    stream = observer.stream
    imports = NodeImports(Path.cwd(), positions, stream.hook, publishes=sites.publishes, bind=stream.bind)
    if not order.mission and order.idle is None:
        observer.begin()
    with imports, _collected_before(), command_line([str(order.node), *order.argv]):
        try:
            imports.run(order.node.resolve(), order.entry)
        except SystemExit as ended:
            observer.end(passed=ended.code in (None, 0), failure=f"exit status {text_of(ended.code)}")
            raise
        except KeyboardInterrupt:
            observer.end(passed=True)
        except BaseException as error:
            if type(error).__name__ != SHUT_DOWN:
                observer.end(passed=False, failure=f"{type(error).__name__}: {text_of(error)}")
                raise
            observer.end(passed=True)
        observer.end(passed=True)


@contextmanager
def _collected_before() -> Iterator[None]:
    """Exclude existing objects from garbage collection, which would delay the node."""
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


def _check(order: Order) -> None:
    if not order.node.is_file():
        raise LogError(f"{order.node}: no such file. Give the path of the node's script.")
    if order.mission and order.idle is not None:
        raise LogError(
            "--mission-topic and --idle cannot be used together: both define when a mission begins and ends."
        )
    if bool(order.reward) == (order.step is not None):
        raise LogError(
            "Give either --reward-topic, on which the monitor publishes its reward, or --step SECONDS, if the marker's "
            "`judge` computes the reward when the log is read."
        )


def _sites(order: Order) -> Plan:
    paths = [path.resolve() for path in (order.node, *order.modules)]
    # with the project's settings, the log has the same statements as the recording
    analysis = analyse(paths, root=Path.cwd(), with_settings=True)
    if not analysis.flows:
        raise AnalysisError(f"No flow from a subscription to a publish call was found in {order.node}.")
    return plan(analysis)


def _fixture_of(node: Path) -> Path:
    """Find the recording below the working directory whose taint lists include the node's file.

    Raise LogError unless there is exactly one.
    """
    found = [path for path in sorted(Path.cwd().glob("**/.tarl/utility/*.npz")) if _names(load(path), node)]
    if len(found) != 1:
        listed = ", ".join(str(path.relative_to(Path.cwd())) for path in found) or "none"
        raise LogError(
            f"The sensors are read from the test's recording. Recordings below {Path.cwd()} that name {node.name}: "
            f"{listed}. Choose one with --fixture."
        )
    return found[0]


def _names(fixture: Fixture, node: Path) -> bool:
    return any(Path(site.path).name == node.name for one in fixture.lists for site in one.sites)


def _topics(order: Order, fixture: Fixture) -> Topics:
    given = dict(spec.split(":", 1) for spec in (order.reward, order.mission) if ":" in spec)
    return Topics(
        types=fixture.topics,
        reward=order.reward.partition(":")[0],
        mission=order.mission.partition(":")[0],
        own=given,
    )


def _warn_of_mute_sensors(fixture: Fixture) -> None:
    mute = [sensor.name for sensor in fixture.sensors if sensor.topic is None]
    if mute:
        raise LogError(
            f"Sensor {mute[0]!r} has no topic. In a test, tarl.observe sets it; on a robot, nothing does. Give it "
            "a topic and a field in the marker and record again."
        )


@contextmanager
def _steps(order: Order, observer: Observer) -> Iterator[None]:
    """Close steps at a fixed interval, unless a reward topic closes them."""
    over = threading.Event()

    def tick() -> None:
        while not over.wait(order.step):
            observer.step(float("nan"))

    thread = threading.Thread(target=tick, name="tarl-steps", daemon=True)
    if order.step is not None:
        thread.start()
    try:
        yield
    finally:
        over.set()
        if thread.is_alive():
            thread.join()
