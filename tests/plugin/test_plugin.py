"""The plugin end to end: record, compare, repair, and user mistakes."""

from __future__ import annotations

import json
import subprocess
import sys

import jsonschema
import pytest

from pytest_tarl.learning.fixture import load
from pytest_tarl.report import json_result
from tests.plugin.tank import ONLINE, RECORD, changed, fixture_file, result
from tests.slow import slow


@pytest.fixture(scope="module")
def record_once() -> dict[str, bytes]:
    return {}


@pytest.fixture
def recorded(tank: pytest.Pytester, record_once: dict[str, bytes]) -> pytest.Pytester:
    """The project with a recording, made once for all tests that only compare."""
    if not record_once:
        tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
        record_once[fixture_file(tank).name] = fixture_file(tank).read_bytes()
    folder = tank.path / ".tarl" / "utility"
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in record_once.items():
        (folder / name).write_bytes(content)
    return tank


def test_without_flags_a_test_runs_once_and_writes_nothing(tank: pytest.Pytester) -> None:
    tank.runpytest().assert_outcomes(passed=2)
    assert not (tank.path / ".tarl" / "utility").exists()


def test_recording_writes_a_file_and_deselects_unmarked_tests(tank: pytest.Pytester) -> None:
    result = tank.runpytest(*RECORD)
    result.assert_outcomes(passed=1, deselected=1)
    result.stdout.fnmatch_lines(
        ["*TARL*", "*test_fills: recorded ATR*16 episodes*", "*wrote .tarl/utility/*"]
    )
    assert fixture_file(tank).stat().st_size < 100_000
    assert (tank.path / ".tarl" / ".gitignore").read_text().count("!utility/") == 2


def test_equal_seeds_give_equal_bytes(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    first = fixture_file(tank).read_bytes()
    result = tank.runpytest(*RECORD)
    assert fixture_file(tank).read_bytes() == first
    result.stdout.fnmatch_lines(["*ATR * → *"])
    tank.runpytest(*RECORD, "--tarl-seed=1")
    assert fixture_file(tank).read_bytes() != first


def test_lossy_drift_is_degraded(recorded: pytest.Pytester) -> None:
    result = recorded.runpytest(*ONLINE)
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines(["*test_fills?clogged?*degraded*", "*keeper.py:*"])
    found = json.loads(next((recorded.path / ".tarl" / "results").glob("*clogged*.json")).read_text())
    jsonschema.validate(found, json_result.schema())
    assert found["verdict"]["result"] == "degraded"
    assert found["episodes"] == {"offline": 16, "online": 12, "search": 0, "acceptance": 0}
    assert found["atr"]["online"] < found["atr"]["offline"]
    assert found["culprits"][0]["path"] == "keeper.py"


def test_a_drift_without_an_effect_passes(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", '"clogged": 0.25', '"clean": 1.0')
    tank.runpytest(*RECORD)
    result = tank.runpytest(*ONLINE)
    result.assert_outcomes(passed=1, deselected=1)
    result.stdout.fnmatch_lines(["*test_fills?clean?: no difference*"])


def test_unnamed_drift_is_called_online(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", '    drifts={"clogged": 0.25},\n', "")
    tank.runpytest(*RECORD)
    tank.runpytest(*ONLINE, "-v").stdout.fnmatch_lines(["*test_fills?online?*PASSED*"])


@pytest.mark.parametrize("search", ["sweep", pytest.param("epsilon-greedy", marks=slow)])
def test_applied_repair_fixes_the_test(recorded: pytest.Pytester, search: str) -> None:
    result = recorded.runpytest(*ONLINE, "--tarl-repair", f"--tarl-search={search}")
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines(["*git apply .tarl/patches/*.patch*"])
    (patch,) = (recorded.path / ".tarl" / "patches").glob("*.patch")
    found = json.loads(next((recorded.path / ".tarl" / "results").glob("*.json")).read_text())
    assert found["repair"]["accepted"]
    assert found["repair"]["edits"][0]["path"] == "keeper.py"
    subprocess.run(["git", "apply", "--check", patch], cwd=recorded.path, check=True)
    subprocess.run(["git", "apply", patch], cwd=recorded.path, check=True)
    recorded.runpytest(*ONLINE).assert_outcomes(passed=1, deselected=1)
    recorded.runpytest().assert_outcomes(passed=2)


def test_a_drift_that_no_constant_repairs_gives_no_patch(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", '"clogged": 0.25', '"shut": 0.0')
    tank.runpytest(*RECORD)
    result = tank.runpytest(*ONLINE, "--tarl-repair", "--tarl-budget=60")
    result.assert_outcomes(failed=1, deselected=1)
    assert not list((tank.path / ".tarl").glob("patches/*.patch"))
    found = json.loads(next((tank.path / ".tarl" / "results").glob("*.json")).read_text())
    assert found["repair"]["accepted"] is False


def test_missing_recording_skips_or_fails(
    tank: pytest.Pytester,
) -> None:
    result = tank.runpytest(*ONLINE, "-rs")
    result.assert_outcomes(skipped=1, deselected=1)
    result.stdout.fnmatch_lines(
        ["*no recorded utility yet: run `pytest test_tank.py::test_fills --tarl-record`*"]
    )
    tank.runpytest(*ONLINE, "--tarl-strict").assert_outcomes(failed=1, deselected=1)


def test_unknown_drift_error_names_the_known(tank: pytest.Pytester) -> None:
    result = tank.runpytest(*ONLINE, "--tarl-drift=mud")
    result.stderr.fnmatch_lines(["*No test declares the drift 'mud' (declared: clogged).*"])
    assert result.ret == pytest.ExitCode.USAGE_ERROR


def test_a_damaged_recording_is_reported(recorded: pytest.Pytester) -> None:
    fixture_file(recorded).write_bytes(fixture_file(recorded).read_bytes()[:300])
    result = recorded.runpytest(*ONLINE)
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines(["*is damaged*--tarl-record*"])


def test_edited_node_loses_the_slices_of_edited_lines(
    recorded: pytest.Pytester,
) -> None:
    changed(recorded, "keeper", "missing = 1.0 - level", "missing = 1.0 - 1.0 * level")
    result = recorded.runpytest(*ONLINE)
    told = " ".join(result.stdout.str().split())
    assert "degraded" in told
    assert "the node was edited since the recording" in told
    assert "`missing = 1.0 - level` are lost" in told


def test_moved_lines_keep_their_slices(recorded: pytest.Pytester) -> None:
    changed(recorded, "keeper", "GAIN = 2.0", "# gains\n\n\nGAIN = 2.0")
    result = recorded.runpytest(*ONLINE)
    result.stdout.no_fnmatch_line("*was edited*")
    result.stdout.fnmatch_lines(["*degraded*"])


@pytest.mark.parametrize(
    ("file", "old", "new", "words"),
    [
        ("test_tank", "        tarl.reward(-abs(1.0 - level))\n", "", "*never called tarl.reward*"),
        (
            "test_tank",
            'topic="/level", field',
            'topic="/lvl", field',
            "*'level' received no message on /lvl*",
        ),
        ("test_tank", 'field="data"', 'field="date"', "*no field 'date'*"),
        ("test_tank", 'nodes=["keeper.py"]', 'nodes=["keepr.py"]', "*no such file*"),
        ("test_tank", 'tarl.start("keeper.py")', 'tarl.start("keepr.py")', "*'keepr.py': no such file*"),
        ("test_tank", "sensors=[Sen", "sensor=[Sen", "*did you mean 'sensors'*"),
        (
            "keeper",
            "            valve.publish(flow)\n",
            "            pass\n",
            "*No flow from a subscription*",
        ),
        (
            "keeper",
            "if level is not None",
            "if level is not None and level > 5",
            "*published nothing*/level*",
        ),
        ("keeper", "GAIN = 2.0", "GAIN = (2.0", "*keeper.py:*cannot be analysed*"),
        ("keeper", "rospy.Rate(10)", "rospy.Rate(ten)", "*NameError*ten*"),
        ("keeper", "rospy.Rate(10)", "rospy.Rait(10)", "*rospy.Rait*"),
        ("test_tank", "valve.data if valve else 0.0", "valve.dota", "*dota*"),
    ],
)
def test_every_mistake_gives_advice(tank: pytest.Pytester, file: str, old: str, new: str, words: str) -> None:
    changed(tank, file, old, new)
    result = tank.runpytest(*RECORD)
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines([words])
    result.stdout.no_fnmatch_line("*INTERNALERROR*")
    assert not list((tank.path / ".tarl").glob("utility/*"))


def test_recording_stops_if_all_first_episodes_fail(tank: pytest.Pytester) -> None:
    changed(tank, "keeper", "GAIN = 2.0", "GAIN = 0.1")
    result = tank.runpytest(*RECORD)
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines(
        ["*5 of the first 5 episodes failed*the other 11 were not run*tank not full*Fix the node or th*"]
    )


def test_a_test_that_is_not_reproducible_is_reported(tank: pytest.Pytester) -> None:
    changed(
        tank, "test_tank", "draws = tarl.rng", "import numpy; draws = numpy.random.default_rng() or tarl.rng"
    )
    tank.runpytest(*RECORD).stdout.fnmatch_lines(["*not reproducible*tarl.rng*"])


def test_function_fixtures_are_fresh_in_every_episode(
    tank: pytest.Pytester,
) -> None:
    tank.makeconftest(
        """
        import pytest
        made = []

        @pytest.fixture(scope="module", autouse=True)
        def wide():
            made.append("wide")
            yield
            print("made", made.count("wide"), made.count("narrow"), made.count("closed"))

        @pytest.fixture(autouse=True)
        def narrow(tmp_path):
            assert not list(tmp_path.iterdir())
            (tmp_path / "mark").touch()
            made.append("narrow")
            yield
            made.append("closed")
        """
    )
    result = tank.runpytest(*RECORD, "-s")
    result.assert_outcomes(passed=1, deselected=1)
    result.stdout.fnmatch_lines(["*made 1 17 17*"])  # 16 episodes, and the first seed once more


def test_a_skip_inside_the_test_skips_it(tank: pytest.Pytester) -> None:
    changed(
        tank,
        "test_tank",
        "    draws = tarl.rng",
        '    pytest.skip("no simulator here")\n    draws = tarl.rng',
    )
    result = tank.runpytest(*RECORD, "-rs")
    result.assert_outcomes(skipped=1, deselected=1)
    result.stdout.fnmatch_lines(["*no simulator here*"])


def test_fixture_without_marker_is_reported(tank: pytest.Pytester) -> None:
    tank.makepyfile("def test_it(tarl):\n    pass\n")
    tank.runpytest().stdout.fnmatch_lines(["*without the marker*@pytest.mark.tarl*"])


def test_importing_the_plugin_imports_no_heavy_package(tank: pytest.Pytester) -> None:
    code = (
        "import sys, pytest, pytest_tarl.plugin; "
        "print([m for m in ('numpy', 'libcst', 'astroid', 'greenlet', 'rosbags', 'plotly') if m in sys.modules])"
    )
    result = tank.run(sys.executable, "-c", code)
    result.stdout.fnmatch_lines(["[[]]"])


def test_learned_bins_are_saved_and_used(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "low=0, high=1, bins=10", "bins=6")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    (sensor,) = load(fixture_file(tank)).sensors
    assert (sensor.learned, len(sensor.edges)) == (6, 7)
    found = tank.runpytest(*ONLINE)
    found.assert_outcomes(failed=1, deselected=1)
    found.stdout.fnmatch_lines(["*degraded*"])
    tank.runpytest().assert_outcomes(passed=2)
    changed(tank, "test_tank", "bins=6", "bins=7")
    tank.runpytest(*ONLINE).stdout.fnmatch_lines(["*sensors of * differ from those of its recording*"])


def test_a_sensor_may_be_a_function_of_the_message(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", 'field="data", low', "field=lambda message: message.data, low")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*ONLINE).stdout.fnmatch_lines(["*degraded*"])


def test_tiles_give_the_same_verdict_as_the_table(tank: pytest.Pytester) -> None:
    regions = []
    for bins in ("bins=10", "bins=10, tilings=2"):
        changed(tank, "test_tank", "bins=10", bins)
        tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
        tank.runpytest(*ONLINE).assert_outcomes(failed=1, deselected=1)
        found = result(tank)
        regions.append((found["region"], found["culprits"][0]["line"]))
    assert regions[0] == regions[1]
