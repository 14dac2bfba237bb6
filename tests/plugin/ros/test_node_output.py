"""Nodes replace, wrap and close the standard output streams; pytest can still write to them."""

from __future__ import annotations

import gc
import io
import sys

import pytest

from pytest_tarl.ros import Ros
from pytest_tarl.ros.node_output import Output, output_of_nodes
from tests.plugin.ros.conftest import Start
from tests.plugin.tank import changed

WRAPPED = (
    "sys.stdout = io.TextIOWrapper(sys.stdout.buffer, encoding='utf-8')",
    "sys.stdout = io.TextIOWrapper(sys.stdout.detach(), encoding='utf-8', write_through=True)",
    "sys.stdout = io.TextIOWrapper(sys.stdout.buffer.detach(), encoding='utf-8')",
    "sys.stdout = codecs.getwriter('utf-8')(sys.stdout.buffer)",
    "sys.stdout = sys.stderr = io.StringIO()",
    "sys.stdout = None",
    "other = io.TextIOWrapper(sys.stdout.buffer)",
    "sys.stdout.close()",
    "sys.stdout.buffer.close()",
)


@pytest.mark.parametrize("wrap", WRAPPED)
def test_the_streams_remain_after_an_episode(
    start: Start, capfd: pytest.CaptureFixture[str], wrap: str
) -> None:
    before = sys.stdout, sys.stderr
    for _ in range(2):
        ros = Ros()
        with ros.installed():
            start(f"import codecs, io, sys\n{wrap}\nprint('of a node', file=sys.stdout)", ros=ros)
            ros.close()
        ros.namespace.clear()  # type: ignore[attr-defined]
        gc.collect()
        assert (sys.stdout, sys.stderr) == before
        print("of the test")
    shown = capfd.readouterr().out
    assert shown.count("of the test\n") == 2
    assert shown.count("of a node\n") == (0 if "StringIO" in wrap or "None" in wrap else 2)


def test_several_nodes_may_wrap_a_stream(start: Start, capfd: pytest.CaptureFixture[str]) -> None:
    ros = start(f"import io, sys\n{WRAPPED[0]}\nprint('first')")
    start(f"import io, sys\n{WRAPPED[0]}\nprint('second')", ros=ros)
    gc.collect()
    sys.stdout.flush()
    assert capfd.readouterr().out.split() == ["first", "second"]


def test_a_test_closes_and_detaches_its_own_streams(monkeypatch: pytest.MonkeyPatch) -> None:
    for end in (lambda: sys.stdout.close(), lambda: sys.stdout.buffer.close(), lambda: sys.stdout.detach()):
        mine = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
        monkeypatch.setattr(sys, "stdout", mine)
        with output_of_nodes():
            assert isinstance(sys.stdout, Output)
            assert sys.stdout.encoding == "ascii"
            end()
        with pytest.raises(ValueError, match=r"closed file|detached"):
            mine.write("x")
    monkeypatch.undo()


def test_a_stream_that_pytest_sets_during_an_episode_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", io.StringIO())
    with output_of_nodes():
        sys.stdout = sys.__stdout__  # as when pytest ends the capture
    assert sys.stdout is sys.__stdout__


def test_a_test_may_replace_a_method_of_a_stream(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO()))
    with output_of_nodes():
        written: list[str] = []
        with monkeypatch.context() as patch:
            patch.setattr(sys.stdout, "write", written.append)
            sys.stdout.write("x")
        sys.stdout.write("y")
    assert written == ["x"]


@pytest.mark.parametrize("capture", [(), ("-s",)])
def test_tests_of_a_node_that_wraps_its_output_pass(tank: pytest.Pytester, capture: tuple[str, ...]) -> None:
    changed(tank, "keeper", "import rospy", f"import io\nimport sys\nimport rospy\n{WRAPPED[0]}")
    ran = tank.runpytest_subprocess(*capture, "test_tank.py")
    ran.assert_outcomes(passed=2)
    assert "closed file" not in f"{ran.stdout}{ran.stderr}"
