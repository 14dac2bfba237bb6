"""Bags with missions of the tank, as recorded on a robot, in every format."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

Message = tuple[str, str, dict[str, Any]]  # topic, type, fields
Step = tuple[float, Sequence[Message]]

BEGAN = 1_700_000_000.0  # s
NUMBER = "std_msgs/msg/Float64"


def mission(pump: float, seed: int, also: Sequence[Message] = (), steps: int = 25) -> Iterator[Step]:
    """Yield the messages of the tank at 10 Hz while it is filled, and `also` further messages each time.

    The node receives a noisy `/level`; the true level is published as `/gauge` after the pump has run.
    """
    draws = random.Random(seed)
    level = draws.uniform(0.0, 0.2)
    for step in range(steps):
        told = level + draws.gauss(0, 0.005)
        yield 0.1 * step, [("/level", NUMBER, {"data": told}), *also]
        level += 0.1 * pump * 2.0 * (1.0 - told)
        yield 0.1 * step + 0.09, [("/gauge", NUMBER, {"data": level})]


def write_bag(path: Path, steps: Iterator[Step]) -> Path:
    """Write a bag of ROS 1 or 2 in the format of its name: .bag, .mcap, .db3, or a folder."""
    return _write1(path, steps) if path.suffix == ".bag" else _write2(path, steps)


def _write1(path: Path, steps: Iterator[Step]) -> Path:
    store = get_typestore(Stores.ROS1_NOETIC)
    with Writer1(path) as writer:
        writer.chunk_threshold = 256
        _fill(writer, store, steps, store.serialize_ros1)
    return path


def _write2(path: Path, steps: Iterator[Step]) -> Path:
    store = get_typestore(Stores.LATEST)
    folder = path.with_name(path.name.replace(".", "-"))
    plugin = StoragePlugin.SQLITE3 if path.suffix == ".db3" else StoragePlugin.MCAP
    with Writer2(folder, version=9, storage_plugin=plugin) as writer:
        _fill(writer, store, steps, store.serialize_cdr)
    if not path.suffix:
        return folder
    (inside,) = folder.glob(f"*{path.suffix}")
    return inside.replace(path)


def _fill(writer: Any, store: Any, steps: Iterator[Step], serialize: Callable[[Any, str], Any]) -> None:
    connections: dict[str, Any] = {}
    for time, messages in steps:
        for topic, kind, fields in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            data = serialize(store.types[kind](**fields), kind)
            writer.write(connections[topic], int((BEGAN + time) * 1e9), data)
