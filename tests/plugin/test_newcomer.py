"""Problems of new users: wrong folder, missing permissions, no terminal, no marker, no recording yet."""

from __future__ import annotations

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed, fixture_file


@pytest.mark.parametrize("start", ["inside", "above"])
def test_results_do_not_depend_on_the_current_folder(
    tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, start: str
) -> None:
    tank.runpytest(*RECORD)
    here = fixture_file(tank).read_bytes()
    (tank.path / "launch").mkdir()
    monkeypatch.chdir(tank.path.parent if start == "above" else tank.path / "launch")
    test = tank.path / "test_tank.py"
    tank.runpytest(*RECORD, test).assert_outcomes(passed=1, deselected=1)
    assert fixture_file(tank).read_bytes() == here
    told = tank.runpytest(*ONLINE, "--tarl-repair", test)
    told.stdout.fnmatch_lines(["*slices*keeper.py*", "*repair*accepted*"])


def test_missing_recordings_are_reported_without_an_option(tank: pytest.Pytester) -> None:
    told = tank.runpytest(*ONLINE, "-q")
    told.assert_outcomes(skipped=1, deselected=1)
    told.stdout.fnmatch_lines(
        [
            "*run `pytest test_tank.py::test_fills --tarl-record` first*",
            "*1 skipped*",
            "NOTHING WAS COMPARED: 1 of 1 tests, since it has no recording.*",
        ]
    )


def test_tests_with_and_without_a_recording_are_counted_separately(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*ONLINE).stdout.no_fnmatch_line("*NOT*COMPARED*")
    source = (tank.path / "test_tank.py").read_text()
    (tank.path / "test_other.py").write_text(source)
    told = tank.runpytest(*ONLINE)
    told.stdout.fnmatch_lines(["NOT COMPARED: 1 of 2 tests, since it has no recording.*"])


def test_an_unwritable_folder_is_reported_before_the_first_episode(tank: pytest.Pytester) -> None:
    (tank.path / ".tarl").write_text("a file where the folder should be")
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*.tarl*cannot be written*"])
    told.stdout.no_fnmatch_line("*mkdir*")


def test_all_modes_work_without_the_terminal_plugin_of_pytest(tank: pytest.Pytester) -> None:
    assert tank.runpytest(*RECORD, "-p", "no:terminal").ret == pytest.ExitCode.OK
    ended = tank.runpytest(*ONLINE, "--tarl-repair", "-p", "no:terminal")
    assert ended.ret == pytest.ExitCode.TESTS_FAILED
    assert list((tank.path / ".tarl" / "patches").glob("*.patch"))


def test_missing_marker_is_reported_in_one_sentence(tank: pytest.Pytester) -> None:
    tank.makepyfile(test_bare="def test_bare(tarl):\n    pass\n")
    told = tank.runpytest("test_bare.py")
    told.assert_outcomes(errors=1)
    told.stdout.fnmatch_lines(["test_bare.py::test_bare uses the fixture `tarl` without the marker*"])
    told.stdout.no_fnmatch_line("*repeating.py*")


@pytest.mark.parametrize("flag", ["--tarl-rekord", "--tarl-onlin=1"])
def test_misspelt_flag_suggests_the_closest(tank: pytest.Pytester, flag: str) -> None:
    told = tank.runpytest(flag)
    assert told.ret == pytest.ExitCode.USAGE_ERROR
    meant = "--tarl-record" if "rek" in flag else "--tarl-online"
    said = f"ERROR: There is no option {flag.partition('=')[0]}: did you mean '{meant}'? Run pytest --help*"
    told.stderr.fnmatch_lines([said])


def test_a_flag_defined_in_conftest_is_accepted(tank: pytest.Pytester) -> None:
    tank.makeconftest("def pytest_addoption(parser):\n    parser.addoption('--tarl-recorder')\n")
    tank.makepyfile(test_plain="def test_plain():\n    pass\n")
    tank.runpytest("--tarl-recorder", "x", "test_plain.py").assert_outcomes(passed=1)


@pytest.mark.parametrize("mode", [RECORD, ONLINE])
def test_run_without_marked_tests_says_so(tank: pytest.Pytester, mode: tuple[str, ...]) -> None:
    tank.makepyfile(test_plain="def test_plain():\n    pass\n")
    told = tank.runpytest(*mode, "test_plain.py")
    told.assert_outcomes(deselected=1)
    told.stdout.fnmatch_lines(["NOTHING WAS RUN: *@pytest.mark.tarl(nodes=[[]…], sensors=[[]…])*"])


@pytest.mark.parametrize("helper", [False, True])
def test_mistake_outside_a_test_is_reported_with_its_line(tank: pytest.Pytester, helper: bool) -> None:
    wrong = "from pytest_tarl.ros import message_type\n\nScan = message_type('sensor_msgs/msg/Skan')\n"
    tank.makepyfile(**({"laser": wrong, "test_laser": "import laser\n"} if helper else {"test_laser": wrong}))
    told = tank.runpytest("test_laser.py")
    told.assert_outcomes(errors=1)
    told.stdout.fnmatch_lines(
        [f"{'laser' if helper else 'test_laser'}.py:3: Message type sensor_msgs/Skan *"]
    )
    told.stdout.no_fnmatch_line("*definitions.py*")


def test_the_verdict_is_the_failure_message(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*ONLINE).stdout.fnmatch_lines(
        ["degraded: In the drift scenario 'clogged' an episode earns *"]
    )


def test_file_of_another_kind_is_not_to_be_trusted(
    tank: pytest.Pytester,
) -> None:
    tank.runpytest(*RECORD)
    fixture_file(tank).write_text("x")
    told = tank.runpytest(*ONLINE)
    told.stdout.fnmatch_lines(["*is damaged or is not a recording*--tarl-record*"])
    told.stdout.no_fnmatch_line("*pickle*")


def test_failure_message_gets_no_second_full_stop(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "flow = GAIN * missing", "flow = GAIN / 0 * missing")
    tank.runpytest(*RECORD).stdout.fnmatch_lines(["*ZeroDivisionError*keeper.py, line*[!.]. Fix the node*"])


def test_interrupt_keeps_the_old_recording(
    tank: pytest.Pytester,
) -> None:
    tank.runpytest(*RECORD)
    before = fixture_file(tank).read_bytes()
    changed(
        tank, "keeper", "    main()", "    try:\n        main()\n    except KeyboardInterrupt:\n        pass"
    )
    changed(
        tank,
        "keeper",
        "flow = GAIN * missing",
        # another process sends the signal, as Ctrl-C does: a signal that a node sends to itself ends only the node
        'flow = GAIN * missing\n            subprocess.run(["kill", "-INT", str(os.getpid())])',
    )
    changed(tank, "keeper", "import rospy", "import os, subprocess\nimport rospy")
    ended = tank.runpytest_subprocess(*RECORD)  # in-process, the interrupt would end the outer pytest run
    assert ended.ret == pytest.ExitCode.INTERRUPTED
    ended.stdout.fnmatch_lines(["Interrupted in episode 1 of 16: .tarl/utility/*.npz is unchanged."])
    assert fixture_file(tank).read_bytes() == before
    fixture_file(tank).unlink()
    tank.runpytest_subprocess(*RECORD).stdout.fnmatch_lines(["Interrupted *: no recording was written.*"])


def test_direct_publish_callback_counts_as_driven(
    tank: pytest.Pytester,
) -> None:
    copy = 'rospy.Subscriber("/level", Float64, rospy.Publisher("/copy", Float64, queue_size=1).publish)'
    changed(tank, "keeper", "    rate = rospy.Rate(10)", f"    {copy}\n    rate = rospy.Rate(10)")
    told = tank.runpytest(*RECORD)
    told.stdout.fnmatch_lines(
        ["*no statement runs when a message passes /level → /copy, since the callback is*"]
    )
    told.stdout.no_fnmatch_line("*was executed*")


def test_undriven_node_is_reported(tank: pytest.Pytester) -> None:
    tank.makepyfile(idle=(tank.path / "keeper.py").read_text())
    changed(tank, "test_tank", 'nodes=["keeper.py"]', 'nodes=["idle.py"]')
    tank.runpytest(*RECORD).stdout.fnmatch_lines(["*no step of /level → /valve was executed*"])


LAUNCHED = """
    from pytest import mark
    from pytest_tarl import Sensor

    @mark.tarl(nodes=["keeper.py"], sensors=[Sensor("level", topic="/level", field="data", low=0, high=1, bins=2)])
    def test_fills(tarl):
        tarl.launch("tank.launch")
        assert tarl.bus.latest("/valve") is not None
    """


def test_failed_test_names_unlaunched_nodes(tank: pytest.Pytester) -> None:
    nodes = '<node pkg="tank" type="keeper.py" name="keeper"/><node pkg="sick" type="driver" name="laser"/>'
    (tank.path / "package.xml").write_text("<package><name>tank</name></package>")
    (tank.path / "tank.launch").write_text(f"<launch>{nodes}</launch>")
    tank.makepyfile(test_launched=LAUNCHED)
    told = tank.runpytest("test_launched.py")
    told.assert_outcomes(failed=1)
    told.stdout.fnmatch_lines(["*note: tank.launch also starts nodes that did not run*: /laser (*"])
