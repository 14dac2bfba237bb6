"""Ctrl-C while several processes run."""

import os
import signal
import subprocess
import sys

import pytest


@pytest.mark.skipif(os.name != "posix", reason="signals of a group of processes")
@pytest.mark.parametrize("ready", ["Analysing in 2 processes", "worker"])
def test_ctrl_c_ends_all_processes_with_one_message(in_directory, ready):
    nodes = {f"node{n}.py": f"import rospy\nx = {n}\nrospy.Subscriber('a', B, c)\n" for n in range(2)}
    root = in_directory({**nodes, "slow.py": SLOW})
    done = subprocess.run(
        [sys.executable, "slow.py", ready], cwd=root, capture_output=True, check=False, text=True,
        timeout=60, start_new_session=True,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "tarl-lint: interrupted.\n")


SLOW = f"""
import os, signal, sys, time
from pathlib import Path
from tarl_lint.run import groups
from tarl_lint.run import runner
from tarl_lint.cli import main

def perform(task, config, *parsed):
    if sys.argv[1] == "worker":
        os.killpg(0, signal.{signal.SIGINT.name})
    time.sleep(60)

groups.perform = perform

def interrupted(text):
    if text == sys.argv[1]:
        os.killpg(0, signal.{signal.SIGINT.name})

if __name__ == "__main__":
    run = runner.run
    runner.run = lambda chosen, config, tell: run(chosen, config, interrupted)
    sys.exit(main(["--jobs", "2", "--no-cache", "node0.py", "node1.py"]))
"""
