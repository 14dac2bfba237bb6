"""The script that starts a worker; it imports pytest before TARL."""

from __future__ import annotations

import json
import os
import signal
import sys


def main() -> None:
    """Move the pipes to other descriptors, configure pytest and serve requests."""
    # the parent run handles Ctrl-C and ends its workers
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    pipes = _pipes()
    start = json.loads(sys.argv[1])
    sys.path[:] = start["path"]
    from _pytest.config import Config, _prepareconfig

    problem = ""
    config = None
    try:
        # the arguments of the command line, which pytest parses here
        if "arguments" in start:
            config = _prepareconfig(start["arguments"])
            vars(config.option).update(start["options"])
        else:  # pytest reads `-p no:` from these options too late, after importing the plugins
            blocked = [f"-p{name}" for name in start["options"]["plugins"] if name.startswith("no:")]
            config = Config.fromdictargs(start["options"], [start["target"], *blocked])
    except (Exception, SystemExit) as refused:
        problem = f"{type(refused).__name__}: {refused}"
    from pytest_tarl.workers.worker import serve

    serve(*pipes, config, problem)


def _pipes() -> tuple[int, int]:
    """Move stdin and stdout to descriptors that nodes cannot use."""
    requests, answers = os.dup(0), os.dup(1)
    nowhere = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nowhere, 0)
    os.dup2(2, 1)
    os.close(nowhere)
    return requests, answers


if __name__ == "__main__":
    main()
