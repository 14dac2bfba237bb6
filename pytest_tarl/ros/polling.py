"""Let tasks wait that poll: they ask for the time, or whether ROS is up, again and again without a pause.

On a robot, time passes while `while rospy.Time.now() < end: …` runs. The virtual clock only moves when every task
waits, so such a loop would never end. Therefore a task that asks very often at one instant has to wait for a moment;
from then on it asks a few times per moment, until it waits by itself. The numbers are counts, so the result depends on
no other clock.
"""

from __future__ import annotations

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.scheduler import running_task

AGAIN = 10  # questions of a polling task between two waits
PAUSE = nanoseconds(0.01)  # ns that it waits


def asked() -> None:
    """Count a question of the running task that only time or other tasks can answer; wait if it keeps asking."""
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
