"""Measure how fast a recorded mission is replayed, as a multiple of real time.

    python benchmarks/bags.py [--seconds 60]

A mission of the shuttle is written to one bag of each kind, which is then replayed through the shuttle's node, with all
its sites recorded. The bag has messages of odometry, terrain and leg ten times per second. Once per second it also has
a picture of 640 × 480, to which the node does not subscribe. Times are CPU times of the process, the minimum of three
runs.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from pytest_tarl.bags.reading import opened
from pytest_tarl.bags.replay import MissionReplayed, Moment, Replay
from pytest_tarl.episode import Tarl
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.instrumentation.sites import plan
from pytest_tarl.sensors import Sensor
from tarl_lint.api import analyse

EXAMPLE = Path(__file__).resolve().parent.parent / "examples" / "shuttle"
ROUNDS = 3
BEGAN = 1_700_000_000 * 10**9  # start of the mission (ns since 1970)
SENSORS = (
    Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=12, bins=24),
    Sensor("terrain", topic="/terrain", field="data"),
    Sensor("leg", topic="/leg", field="data"),
)


def main() -> None:
    """Print a line for each kind of bag."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=int, default=60, help="length of the mission (default 60)")
    seconds = parser.parse_args().seconds
    print(f"a mission of {seconds} s, 10 Hz, replayed and recorded")
    with tempfile.TemporaryDirectory() as folder:
        for kind in (".bag", ".mcap", ".db3"):
            bag = written(Path(folder), kind, seconds)
            spent = min(replayed(bag) for _ in range(ROUNDS))
            size = bag.stat().st_size / 1e6
            print(f"{kind:6} {size:7.1f} MB  {spent:6.2f} s CPU  {seconds / spent:6.0f} × real time")


def written(folder: Path, kind: str, seconds: int) -> Path:
    """Write the mission."""
    path = folder / f"mission{kind}"
    if kind == ".bag":
        with Writer1(path) as writer:
            store = get_typestore(Stores.ROS1_NOETIC)
            fill(writer, store, store.serialize_ros1, seconds)
        return path
    plugin = StoragePlugin.MCAP if kind == ".mcap" else StoragePlugin.SQLITE3
    inside = folder / kind[1:]
    with Writer2(inside, version=9, storage_plugin=plugin) as writer2:
        store = get_typestore(Stores.LATEST)
        fill(writer2, store, store.serialize_cdr, seconds)
    return next(inside.glob(f"*{kind}"))


def fill(writer: Any, store: Any, serialize: Callable[[Any, str], Any], seconds: int) -> None:
    """Write the messages of a shuttle that drives back and forth."""
    types = {
        "/odom": "nav_msgs/msg/Odometry",
        "/terrain": "std_msgs/msg/Bool",
        "/leg": "std_msgs/msg/UInt8",
        "/camera": "std_msgs/msg/UInt8MultiArray",
    }
    connections = {
        topic: writer.add_connection(topic, kind, typestore=store) for topic, kind in types.items()
    }
    kinds = store.types
    layout = kinds["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    picture = kinds[types["/camera"]](layout=layout, data=np.zeros(640 * 480 * 3, np.uint8))

    def write(topic: str, step: int, message: Any) -> None:
        writer.write(connections[topic], BEGAN + step * 10**8, serialize(message, types[topic]))

    odometry = odometry_message(kinds)
    for step in range(seconds * 10):
        odometry.pose.pose.position.x = 6 + 5 * np.sin(step / 40)
        write("/odom", step, odometry)
        write("/terrain", step, kinds[types["/terrain"]](data=step % 100 < 30))
        write("/leg", step, kinds[types["/leg"]](data=1 + step // 125 % 2))
        if step % 10 == 0:
            write("/camera", step, picture)


def odometry_message(kinds: Any) -> Any:
    """Return an odometry message of `rosbags` at the origin."""
    geometry = {
        name: kinds[f"geometry_msgs/msg/{name}"]
        for name in ("Point", "Quaternion", "Pose", "Vector3", "Twist")
    }
    header = {"stamp": kinds["builtin_interfaces/msg/Time"](sec=0, nanosec=0), "frame_id": "odom"}
    kind = kinds["std_msgs/msg/Header"]
    fields = {**header, "seq": 0} if "seq" in kind.__dataclass_fields__ else header
    pose = geometry["Pose"](geometry["Point"](0.0, 0.0, 0.0), geometry["Quaternion"](0.0, 0.0, 0.0, 1.0))
    still = geometry["Vector3"](0.0, 0.0, 0.0)
    return kinds["nav_msgs/msg/Odometry"](
        header=kind(**fields),
        child_frame_id="base",
        pose=kinds["geometry_msgs/msg/PoseWithCovariance"](pose, np.zeros(36)),
        twist=kinds["geometry_msgs/msg/TwistWithCovariance"](geometry["Twist"](still, still), np.zeros(36)),
    )


def replayed(bag: Path) -> float:
    """Replay a bag through the shuttle's node as one episode; return CPU seconds."""
    sites = plan(analyse([EXAMPLE / "traveller.py"], root=EXAMPLE))
    positions = {EXAMPLE / path: at for path, at in sites.positions.items()}
    recorder = Recorder()
    imports = NodeImports(
        EXAMPLE, positions, recorder.hook, {}, publishes=sites.publishes, bind=recorder.bind
    )
    start = time.process_time()
    replay = Replay(opened(bag), SENSORS, judged, None)
    tarl = Tarl(0, SENSORS, EXAMPLE, recorder, imports, replay=replay)
    try:
        tarl.start("traveller.py")
        tarl.step(0.1)
    except MissionReplayed:
        pass
    finally:
        recorder.finish()
        tarl.close()
    assert replay.done
    assert not replay.notes
    return time.process_time() - start


def judged(moment: Moment) -> float:
    """Return the reward of a step."""
    newest = moment.latest("/odom")
    return -abs(11.0 - newest.pose.pose.position.x) if newest else 0.0


if __name__ == "__main__":
    main()
