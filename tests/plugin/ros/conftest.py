from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import Ros
from pytest_tarl.ros.process import Network
from pytest_tarl.ros.scheduler import Scheduler, Task

Start = Callable[..., Ros]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Return a function that starts the source of a node in a new or given episode, which is closed after the test."""
    open_episodes = []

    def start_node(
        source: str,
        *,
        ros: Ros | None = None,
        argv: tuple[str, ...] = (),
        name: str = "node.py",
        **options: Any,
    ) -> Ros:
        path = tmp_path / "node.py"
        path.write_text(dedent(source))
        code = compile(path.read_text(), str(path), "exec")
        if ros is None:
            ros = Ros(**options)
            installed = ros.installed()
            installed.__enter__()
            open_episodes.append((ros, installed))
        namespace = {"__name__": "__main__", "__file__": str(path)}
        ros.start(lambda: exec(code, namespace), name=name, argv=argv)
        ros.namespace = namespace  # type: ignore[attr-defined]
        return ros

    yield start_node
    for ros, installed in reversed(open_episodes):
        ros.close()
        installed.__exit__(None, None, None)


class Program:
    """A process of tasks that notes how they end."""

    label = "program"

    def __init__(self, scheduler: Scheduler) -> None:
        self.scheduler = scheduler
        self.tasks: list[Task] = []
        self.ending = False
        self.errors: list[BaseException] = []
        self.refused = 0

    def failed(self, task: Task, error: BaseException) -> None:
        self.errors.append(error)

    def finished(self, task: Task) -> None:
        self.tasks.remove(task)

    def spins(self, place: Any) -> NodeError:
        return NodeError(f"spins at {place}")

    def refuse_to_wait(self) -> None:
        self.refused += 1


@pytest.fixture
def clock() -> Scheduler:
    return Scheduler()


@pytest.fixture
def program(clock: Scheduler) -> Program:
    return Program(clock)


@pytest.fixture
def network() -> Network:
    """Return the clock, topics, services and parameters of an episode without nodes."""
    made: list[Network] = []

    def run(job: Callable[..., None], *given: Any) -> None:
        job(*given)
        made[0].scheduler.settle()

    made.append(Network(run, {"gain": 2.0}, {"old": "new"}, 10.0))
    return made[0]


def heard(ros: Ros, topic: str) -> list[Any]:
    """Collect the messages that nodes publish on a topic from now on."""
    messages: list[Any] = []
    ros.bus.subscribe(topic, messages.append)
    return messages
