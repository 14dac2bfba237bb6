"""Start a private ROS 1 master on a free port of the loopback device."""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import xmlrpc.client
from contextlib import ExitStack
from time import monotonic, sleep

from pytest_tarl.errors import RecordingError

_ATTEMPTS = 3
_PATIENCE = 60.0  # maximum real time until a master answers on a busy machine (s)
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)


class Master:
    """A process `rosmaster --core`, and the environment in which nodes find it.

    The master ends with `close`, or with this process.
    """

    def __init__(self) -> None:
        self._open = ExitStack()
        self._folder = self._open.enter_context(tempfile.TemporaryDirectory(prefix="tarl-ros-"))
        self.uri = ""
        try:
            self._process = self._started()
        except BaseException:
            self._open.close()
            raise
        self._open.callback(self._stop)
        self._set_environment()

    @property
    def answers(self) -> bool:
        """Return whether the master answers."""
        try:
            with xmlrpc.client.ServerProxy(self.uri) as server:
                return bool(server.getPid("/tarl")[0] == 1)  # type: ignore[index]
        except OSError:
            return False

    def close(self) -> None:
        """Stop the master and restore the environment."""
        self._open.close()

    def _started(self) -> subprocess.Popen[bytes]:
        if shutil.which("rosmaster") is None:
            raise RecordingError(
                "ROS 1 needs `rosmaster`, which is not on the PATH: apt-get install python3-rosmaster, or "
                "source the setup.bash of your ROS."
            )
        for _ in range(_ATTEMPTS):
            port = _free_port()
            self.uri = f"http://127.0.0.1:{port}"
            process = self._spawned(port)
            deadline = monotonic() + _PATIENCE
            while process.poll() is None and monotonic() < deadline:
                if self.answers:
                    return process
                sleep(0.02)
            _end(process)
        raise RecordingError(f"rosmaster did not answer within {_PATIENCE:g} s, {_ATTEMPTS} times in a row.")

    def _spawned(self, port: int) -> subprocess.Popen[bytes]:
        environment = {**os.environ, **self.variables}
        return subprocess.Popen(
            ["rosmaster", "--core", "-p", str(port)],
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # Ctrl-C goes to pytest, which stops the master
            preexec_fn=_die_with_parent,
        )

    @property
    def variables(self) -> dict[str, str]:
        """Return the environment variables by which nodes find the master."""
        return {
            "ROS_MASTER_URI": self.uri,
            "ROS_IP": "127.0.0.1",
            "ROS_LOG_DIR": self._folder,
            "ROS_HOME": self._folder,
        }

    def _set_environment(self) -> None:
        variables = self.variables
        before = {name: os.environ.get(name) for name in (*variables, "ROS_HOSTNAME", "ROS_NAMESPACE")}
        self._open.callback(_restore, before)
        os.environ.update(variables)
        for name in ("ROS_HOSTNAME", "ROS_NAMESPACE"):
            os.environ.pop(name, None)

    def _stop(self) -> None:
        _end(self._process)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _restore(variables: dict[str, str | None]) -> None:
    for name, value in variables.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value


_LIBC = ctypes.CDLL(None, use_errno=True) if os.name == "posix" else None


def _die_with_parent() -> None:
    """Make the kernel end the master if pytest is killed. Called in the child before exec."""
    if _LIBC is not None and hasattr(_LIBC, "prctl"):
        _LIBC.prctl(_DIE_WITH_PARENT, signal.SIGTERM)
