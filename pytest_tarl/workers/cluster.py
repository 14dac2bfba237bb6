"""Workers on a Dask cluster; each thread of the cluster has one worker process."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager, suppress

from pytest_tarl.errors import SettingsError
from pytest_tarl.extras import install_command
from pytest_tarl.workers.pool import Pool, Post

REACHED = 10  # maximum time to wait for a connection to the scheduler (s)
RETRIES = 2  # maximum number of retries after an episode's machine was lost

_pools: list[Pool] = []  # one pool per process of the cluster


def serve_here(post: Post, request: bytes) -> bytes:
    """Run an episode request in a process on this machine of the cluster."""
    if not _pools:
        _pools.append(Pool())
    return _pools[0].serve(post, request)


def leave() -> None:
    """End the worker processes on this machine."""
    while _pools:
        _pools.pop().close()


@contextmanager
def joined(address: str) -> Iterator[tuple[Executor, int]]:
    """Connect to a cluster; return an executor and the number of parallel episodes. Raise SettingsError."""
    try:
        from distributed import Client
    except ImportError:
        raise SettingsError(f"--tarl-cluster needs Dask: run {install_command('cluster')}.") from None
    try:
        client = Client(address, timeout=REACHED, set_as_default=False)
    except (OSError, ValueError) as problem:
        raise SettingsError(
            f"--tarl-cluster: no Dask scheduler answers at {address} ({problem}). Start one with `dask scheduler` "
            "and give its address, such as tcp://192.0.2.1:8786."
        ) from None
    with client:
        workers = sum(client.nthreads().values())
        if not workers:
            raise SettingsError(
                f"--tarl-cluster: the scheduler at {address} has no workers; start some: dask worker {address}."
            )
        executor = client.get_executor(retries=RETRIES)
        try:
            yield executor, workers
        finally:
            with suppress(OSError, TimeoutError):
                executor.shutdown(wait=False)
                client.run(leave)
