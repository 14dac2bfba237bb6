"""The fixture `tarl` in a test: random streams, cells, and messages for mistakes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl
from pytest_tarl.errors import SettingsError
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.recorder import Recorder

SENSORS = (
    Sensor("x", topic="/odom", field="data", low=0, high=10, bins=10),
    Sensor("wet"),
)


@contextmanager
def episode(folder: Path, seed: int = 7) -> Iterator[tuple[Tarl, Recorder]]:
    recorder = Recorder()
    tarl = Tarl(seed, SENSORS, folder, recorder, NodeImports(folder, {}, recorder.hook))
    try:
        yield tarl, recorder
    finally:
        tarl.close()


def test_random_stream_depends_only_on_its_name(tmp_path):
    with episode(tmp_path) as (tarl, _):
        first = tarl.rng("wind").random(4).tolist()
        tarl.rng("noise").random(100)
        assert tarl.rng("wind").random() not in first
    with episode(tmp_path) as (tarl, _):
        tarl.rng("noise").random(3)
        assert tarl.rng("wind").random(4).tolist() == first
    with episode(tmp_path, seed=8) as (tarl, _):
        assert tarl.rng("wind").random(4).tolist() != first


def test_cell_lasts_until_the_next_message(tmp_path):
    with episode(tmp_path) as (tarl, recorder):
        tarl.message("odom", SimpleNamespace(data=3.5))
        tarl.reward(0.0)
        tarl.observe(wet=True)
        tarl.reward(0.0)
        tarl.message("/other", SimpleNamespace(data=9.0))
        tarl.reward(0.0)
        tarl.message("/odom", SimpleNamespace(data=float("nan")))
        tarl.reward(0.0)
        tarl.message("/odom", SimpleNamespace(data=8.5))
        tarl.reward(0.0)
        trace = recorder.finish()
    cells = [*trace.cells, None]
    assert [cells[i] for i in trace.step_cell] == [None, (3, 1), (3, 1), None, (8, 1)]


@pytest.mark.parametrize(
    "value", [2, 1.5, True, np.float32(0.5), np.int64(3), np.array(1.0)], ids=lambda v: type(v).__name__
)
def test_rewards_may_be_numbers_of_any_type(tmp_path, value):
    with episode(tmp_path) as (tarl, recorder):
        tarl.reward(value)
        tarl.reward(progress=value, clearance=-1)
        trace = recorder.finish()
    assert trace.reward.tolist() == [float(value), float(value) - 1]
    assert trace.parts["clearance"].tolist() == [0.0, -1.0]


MISTAKES: dict[str, Any] = {
    "a text as reward": (
        lambda t: t.reward("good"),
        r"tarl.reward got 'good': rewards must be finite numbers",
    ),
    "a text as part": (lambda t: t.reward(progress="good"), "tarl.reward got 'good'"),
    "a list as reward": (lambda t: t.reward([1.0]), r"tarl.reward got \[1.0\]"),
    "an array as reward": (lambda t: t.reward(np.array([1.0])), "tarl.reward got array"),
    "infinity as reward": (lambda t: t.reward(float("-inf")), "tarl.reward got -inf"),
    "a reward whose square overflows": (lambda t: t.reward(-1e101), "at most 1e[+]100 in magnitude"),
    "parts that are too much together": (lambda t: t.reward(a=9e99, b=9e99), "at most 1e[+]100 in magnitude"),
    "a huge whole number as reward": (lambda t: t.reward(10**400), "finite numbers"),
    "nothing as reward": (lambda t: t.reward(None), "needs a number, or parts"),
    "a text as time": (lambda t: t.step("0.1"), "tarl.step got '0.1': give a finite number"),
    "time backwards": (lambda t: t.step(-0.1), "tarl.step got -0.1"),
    "no time": (lambda t: t.step(float("nan")), "tarl.step got nan"),
    "a time that ROS cannot express": (lambda t: t.step(1e300), "the times of ROS end 2147483647 s after"),
    "a message without topic": (
        lambda t: t.message(SimpleNamespace(data=1), None),
        "the topic name comes first",
    ),
    "a sensor that is not declared": (
        lambda t: t.observe(y=1),
        "no such sensor or signal: 'y'; .* x, wet",
    ),
    "a measurement for flags": (lambda t: t.observe(wet=0.5), "low, high and bins for a measurement"),
    "not a number for a sensor": (lambda t: t.observe(x="far"), "'x' got 'far', which is not a number"),
    "a message without the field": (lambda t: t.message("/odom", SimpleNamespace()), "has no field 'data'"),
    "a script whose name has a NUL": (lambda t: t.start("no\0de.py"), "no such file"),
    "a script whose name has a lone surrogate": (lambda t: t.start("\ud800.py"), "no such file"),
    "a script whose name is too long": (lambda t: t.start("n" * 5000), "no such file"),
    "a launch file whose name has a NUL": (lambda t: t.launch("a\0.launch"), "no such file"),
    "a folder as script": (lambda t: t.start("."), "no such file"),
    "a script that is not there": (lambda t: t.start("nod.py"), "'nod.py': no such file"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_test_mistake_is_reported_in_one_sentence(tmp_path, mistake):
    call, words = MISTAKES[mistake]
    with episode(tmp_path) as (tarl, recorder):
        with pytest.raises(SettingsError, match=words):
            call(tarl)
        assert not recorder.finish().steps


STARTS: dict[str, dict[str, Any]] = {
    "argv takes a list of strings, not 'a'": {"argv": "a"},
    r"argv takes a list of strings, not \['a', 3\]": {"argv": ["a", 3]},
    "parameters maps names to values; 3 is not a name": {"parameters": {3: 1}},
    "parameters maps names to values; '' is not a name": {"parameters": {"": 1}},
    "there is no launch file .*gone.launch": {"launch": "gone.launch"},
    "there is no launch file .*\0": {"launch": "\0"},
}


@pytest.mark.parametrize("words", STARTS)
def test_wrong_argument_of_start_is_a_test_error(tmp_path, words):
    (tmp_path / "node.py").write_text("1 / 0\n")
    with episode(tmp_path) as (tarl, _), pytest.raises(SettingsError, match=f"^tarl.start: {words}"):
        tarl.start("node.py", **STARTS[words])


def test_any_text_names_a_random_stream(tmp_path):
    with episode(tmp_path) as (tarl, _):
        assert tarl.rng("\ud800\0").random() != tarl.rng("\ud801\0").random()


def test_errors_during_shutdown_of_a_node_become_a_note(tmp_path):
    (tmp_path / "node.py").write_text(
        "import rospy\nrospy.init_node('late')\nrospy.on_shutdown(lambda: 1 / 0)\nrospy.spin()\n"
    )
    with episode(tmp_path) as (tarl, _):
        tarl.start("node.py")
        tarl.step(0.1)
    (note,) = tarl.notes()
    assert "ZeroDivisionError" in note
    assert "the episode still counts" in note


def test_positions_that_cannot_be_recorded_become_a_note(tmp_path):
    node = tmp_path / "node.py"
    node.write_text("x = 1.0\nimport math\n")
    recorder = Recorder()
    imports = NodeImports(
        tmp_path, {node: {(1, 1): 0, (2, 1): 1, (12, 1): 2, (9, 5): 3, (9, 1): 4}}, recorder.hook
    )
    tarl = Tarl(1, SENSORS, tmp_path, recorder, imports)
    tarl.start("node.py")
    tarl.close()
    assert tarl.notes() == ("cannot record node.py:9, 12: slices of these lines stay empty.",)
