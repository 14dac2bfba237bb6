"""The topics that smach_viewer listens to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pytest_tarl.ros.messages import class_of
from pytest_tarl.ros.rospy.timing import get_rostime
from pytest_tarl.ros.rospy.topics import Publisher
from pytest_tarl.ros.smach.container import Container


class IntrospectionServer:
    """Publish the structure of a container and its nested ones, and the active states after each transition."""

    def __init__(self, server_name: str, state: Any, path: str) -> None:
        self._name, self._state, self._path = server_name, state, path
        self._shown: list[tuple[str, Container]] = []
        self._structure: Any = None
        self._status: Any = None

    def start(self) -> None:
        """Start publishing."""
        root = f"{self._name}/smach"
        self._structure = Publisher(
            f"{root}/container_structure", class_of("ros1", "smach_msgs/SmachContainerStructure"), latch=True,
            queue_size=10,
        )  # fmt: skip
        self._status = Publisher(
            f"{root}/container_status", class_of("ros1", "smach_msgs/SmachContainerStatus"), latch=True, queue_size=10
        )  # fmt: skip
        self._shown = list(_containers(self._path, self._state))
        for path, container in self._shown:
            self._publish_structure(path, container)
            self._publish_status(path, container)
            container.register_start_cb(self._changed, [path, container])
            container.register_transition_cb(self._changed, [path, container])

    def stop(self) -> None:
        """Stop publishing."""
        self._shown = []

    clear = stop

    def _changed(self, _userdata: Any, _labels: Any, path: str, container: Container) -> None:
        if self._shown:
            self._publish_status(path, container)

    def _publish_structure(self, path: str, container: Container) -> None:
        edges = container.get_internal_edges()
        message: Any = self._structure.data_class()
        message.header.stamp = get_rostime()
        message.path, message.children = path, list(container.get_children())
        message.internal_outcomes = [outcome for outcome, _, _ in edges]
        message.outcomes_from = [start for _, start, _ in edges]
        message.outcomes_to = [end for _, _, end in edges]
        message.container_outcomes = list(container.get_registered_outcomes())
        self._structure.publish(message)

    def _publish_status(self, path: str, container: Container) -> None:
        message: Any = self._status.data_class()
        message.header.stamp = get_rostime()
        message.path = path
        message.initial_states = container.get_initial_states()
        message.active_states = container.get_active_states() or ["None"]
        self._status.publish(message)


def _containers(path: str, state: Any) -> Iterator[tuple[str, Container]]:
    """Yield a container and those nested in it, with their paths."""
    if not isinstance(state, Container):
        return
    yield path, state
    for label, child in state.get_children().items():
        yield from _containers(f"{path}/{label}", child)
