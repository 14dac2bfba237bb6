"""What another process has not read of a connection, and calls of services of ROS 1 that wait for it."""

from __future__ import annotations

import socket
import sys
from collections.abc import Iterator
from types import SimpleNamespace

import pytest

from pytest_tarl.external import link_ros1, unread
from tests.plugin.external.test_link_ros1 import Linked, linked  # noqa: F401 (a fixture)

pytestmark = pytest.mark.skipif(
    sys.platform != "linux", reason="the tables of connections are those of Linux"
)


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    """Return both ends of a connection."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        near = socket.create_connection(server.getsockname())
        far, _ = server.accept()
        with near, far:
            yield near, far


def ports(near: socket.socket) -> tuple[int, int]:
    return near.getsockname()[1], near.getpeername()[1]


def test_bytes_count_until_the_other_end_has_read_them(ends: tuple[socket.socket, socket.socket]) -> None:
    near, far = ends
    assert unread.unread([ports(near)]) == 0
    near.sendall(b"x" * 1000)
    assert unread.unread([ports(near)]) == 1000
    assert unread.unread([]) == 0
    assert unread.unread([(1, 2)]) == 0
    far.recv(400)
    assert unread.unread([ports(near)]) == 600
    far.recv(600)
    assert unread.unread([ports(near)]) == 0


def test_received_bytes_do_not_count_as_unread(
    ends: tuple[socket.socket, socket.socket],
) -> None:
    near, far = ends
    far.sendall(b"x" * 10)
    assert unread.unread([ports(near)]) == 0
    assert unread.unread([ports(far)]) == 10


def test_service_is_called_after_commands_were_read(
    linked: Linked,  # noqa: F811
    ends: tuple[socket.socket, socket.socket],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    link, _, master = linked
    near, far = ends
    master.subscribing = [("/cmd", ["/sim"])]
    link.look()
    link._publishers["/cmd"].impl.connections = [SimpleNamespace(socket=near), SimpleNamespace(socket=None)]
    link.send("/cmd", {"data": 1.0})
    near.sendall(b"command")
    waits: list[float] = []

    def wait(seconds: float) -> None:
        waits.append(seconds)
        if len(waits) == 3:
            assert far.recv(100) == b"command"

    monkeypatch.setattr(link_ros1, "sleep", wait)
    link.call({"id": 1, "service": "/step", "request": {}})
    assert waits == [link_ros1.LOOK] * 3 + [0.0]
    link.call({"id": 2, "service": "/step", "request": {}})
    assert len(waits) == 4


def test_unread_messages_delay_a_call_only_briefly(
    linked: Linked,  # noqa: F811
    ends: tuple[socket.socket, socket.socket],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    link, _, master = linked
    master.subscribing = [("/cmd", ["/sim"])]
    link.look()
    link._publishers["/cmd"].impl.connections = [SimpleNamespace(socket=ends[0])]
    link.send("/cmd", {"data": 1.0})
    ends[0].sendall(b"command")
    waits: list[float] = []
    monkeypatch.setattr(link_ros1, "sleep", waits.append)
    monkeypatch.setattr(link_ros1, "monotonic", lambda: float(len(waits)))
    link.call({"id": 1, "service": "/step", "request": {}})
    assert waits == [link_ros1.LOOK] * int(link_ros1.READING) + [0.0]
