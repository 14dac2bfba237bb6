"""Make polling tasks wait: those that read the time or the state of ROS in a loop that never waits.

On a robot, time passes while `while rospy.Time.now() < end: …` runs. The virtual clock advances only when every task
waits, so such a loop would never end. A task that polls PATIENCE times without time passing therefore waits for PAUSE.
From then on, it waits after every AGAIN polls, until it waits by itself. These limits are counts, so the result does
not depend on real time.
"""

from __future__ import annotations

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.scheduler import running_task

AGAIN = 10  # number of polls between two waits of a polling task
PAUSE = nanoseconds(0.01)  # virtual time for which a polling task waits (ns)


def asked() -> None:
    """Count a poll of the running task: a query whose result only time or other tasks change. Wait after too many."""
    task = running_task()
    if task is None:
        return
    task.patience -= 1
    if task.patience > 0:
        return
    process = task.process
    if process.ending:
        process.refuse_to_wait()
    else:
        process.scheduler.wait(process.scheduler.time + PAUSE)
    task.patience = AGAIN
