"""The options and settings that a worker gets from its run."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl import Sensor
from pytest_tarl.errors import TarlError
from pytest_tarl.item_episode import Instruments
from pytest_tarl.workers import protocol
from pytest_tarl.workers.executor import OFF, posted
from pytest_tarl.workers.worker import instruments

SENSORS = (Sensor("x", edges=(0.0, 1.0, 4.0), learned=2), Sensor("y", edges=(0.0, 1.0)))
PLACES = Instruments({Path("/a/node.py"): {(3, 5): 7, (4, 1): 8}}, frozenset({8, 2}))


@pytest.mark.parametrize("ini", [True, False])
def test_worker_gets_options_and_paths(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, ini: bool
) -> None:
    if ini:
        pytester.makeini("[pytest]\n")
    monkeypatch.setattr(sys, "path", [*sys.path, "", "lib", "/opt/more"])
    config = pytester.parseconfigure("--tarl-workers=3", "-x", "--junitxml=out.xml", "--basetemp=x", "-s")
    module = pytester.getmodulecol("class TestMission:\n    def test_x(self, tarl): ...")
    item: Any = pytester.genitems([module])[0]
    item.config = config
    post = posted(item, PLACES, SENSORS)
    start, first = json.loads(post.start), json.loads(post.first)
    options = start["options"]
    assert {name: options[name] for name in OFF} == dict(OFF)
    assert (options["maxfail"], options["basetemp"]) == (1, None)
    assert options["plugins"][-1] == "no:terminal"
    assert options["rootdir"] == str(config.rootpath)
    assert options.get("inifilename") == (str(pytester.path / "tox.ini") if ini else None)
    assert post.folder == str(pytester.path)
    assert start["path"][-3:] == [str(pytester.path), str(pytester.path / "lib"), "/opt/more"]
    assert start["target"] == f"{item.path}::TestMission::test_x"
    assert first["nodeid"] == item.nodeid
    assert first["edges"] == {"x": [0.0, 1.0, 4.0]}  # bins that were learned, not those of the marker
    assert post.loud


def test_a_worker_gets_only_options_that_are_plain_data(pytester: pytest.Pytester) -> None:
    item: Any = pytester.getitem("def test_x(tarl): ...", "test_x")
    item.config.option.odd, item.config.option.nested = object(), {"a": [1, None]}
    options = json.loads(posted(item, PLACES, ()).start)["options"]
    assert options["nested"] == {"a": [1, None]}
    assert "odd" not in options


def test_a_worker_without_a_configuration_reports_the_reason() -> None:
    """The first message may be larger than the buffer of a pipe."""
    size = 1 << 20
    code = "from pytest_tarl.workers.worker import serve; serve(0, 1, None, 'no such option')"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as worker:
        assert worker.stdin is not None
        assert worker.stdout is not None
        protocol.write(worker.stdin, b" " * size)
        answer = protocol.read(worker.stdout)
        assert answer is not None
        with pytest.raises(TarlError, match=r"^no such option$"):
            protocol.refused(answer)


def test_workers_capture_output_unless_the_run_disables_capturing(pytester: pytest.Pytester) -> None:
    item: Any = pytester.getitem("def test_x(tarl): ...", "test_x")
    assert not posted(item, PLACES, ()).loud


def test_sites_survive_transport_to_a_worker(pytester: pytest.Pytester) -> None:
    item: Any = pytester.getitem("def test_x(tarl): ...", "test_x")
    assert instruments(json.loads(posted(item, PLACES, ()).first)["instruments"]) == PLACES
