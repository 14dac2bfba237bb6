"""Helpers and wrappers that a node imports are recorded and re-executed in each episode, or reported."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from pytest_tarl.errors import StaleTextError
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.patching.dependencies import undeclared
from pytest_tarl.repairing.mutants import _outcome
from pytest_tarl.rollout import EpisodePlan, EpisodeRun
from tests.plugin.tank import ONLINE, RECORD, changed, result

GAINS = "GAIN = 2.0\n\n\ndef flow_of(missing):\n    flow = GAIN * missing\n    return flow\n"
WRAPPER = """\
import rospy

COUNTED = []
_publisher = rospy.Publisher


class Publisher(_publisher):
    def __init__(self, *given, **more):
        super().__init__(*given, **more)
        COUNTED.append(self)


rospy.Publisher = Publisher
"""


@pytest.fixture
def installed(tank: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    folder = tank.path.parent / f"{tank.path.name}-installed" / "site-packages"
    folder.mkdir(parents=True)
    monkeypatch.syspath_prepend(str(folder))
    yield folder
    for name in ("counted_ros", "counted_facade", "gains", "helpers", "helpers.gains"):
        sys.modules.pop(name, None)


def helped(tank: pytest.Pytester, module: str) -> None:
    changed(tank, "keeper", "import rospy\n", f"import rospy\nfrom {module} import flow_of\n")
    changed(tank, "keeper", "flow = GAIN * missing", "flow = flow_of(missing)")


def test_rospy_wrapper_package_is_instrumented(tank: pytest.Pytester, installed: Path) -> None:
    (installed / "counted_ros.py").write_text(WRAPPER)
    (installed / "counted_facade.py").write_text("from counted_ros import COUNTED\n")
    changed(tank, "keeper", "import rospy\n", "import rospy\nfrom counted_facade import COUNTED\n")
    changed(
        tank,
        "keeper",
        "    rate = rospy",
        "    assert len(COUNTED) == 1 and COUNTED[0] is valve\n    rate = rospy",
    )
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)


@pytest.mark.usefixtures("quick_acceptance")
def test_constant_of_a_helper_outside_rootdir_is_changed(
    tank: pytest.Pytester,
) -> None:
    source = tank.path / "src"
    tests = tank.path / "tests"
    for folder in (source, tests):
        folder.mkdir()
    (tank.path / ".git").mkdir()
    helped(tank, "gains")
    (tank.path / "keeper.py").rename(source / "keeper.py")
    (source / "gains.py").write_text("from inner import flow_of\n")
    (source / "inner.py").write_text(GAINS)
    changed(
        tank,
        "test_tank",
        'nodes=["keeper.py"]',
        'nodes=["../src/keeper.py", "../src/gains.py", "../src/inner.py"]',
    )
    changed(tank, "test_tank", 'tarl.start("keeper.py")', 'tarl.start("../src/keeper.py")')
    (tank.path / "test_tank.py").rename(tests / "test_tank.py")
    (tests / "pytest.ini").write_text("[pytest]\n")
    where = (f"--rootdir={tests}", "-c", str(tests / "pytest.ini"), str(tests))
    tank.runpytest(*RECORD, *where).assert_outcomes(passed=1, deselected=1)
    tank.runpytest(*ONLINE, "--tarl-repair", *where).assert_outcomes(failed=1, deselected=1)
    (found,) = (tests / ".tarl" / "results").glob("*.json")
    culprits = json.loads(found.read_text())["culprits"]
    effects = [one["effect"] for each in culprits if "inner.py" in each["path"] for one in each["operands"]]
    assert any(abs(effect) > 1.0 for effect in effects)


@pytest.mark.usefixtures("quick_acceptance")
def test_helper_without_an_init_file_is_reported(tank: pytest.Pytester) -> None:
    helped(tank, "helpers.gains")
    (tank.path / "helpers").mkdir()
    (tank.path / "helpers" / "gains.py").write_text(GAINS)
    changed(tank, "test_tank", 'nodes=["keeper.py"]', 'nodes=["keeper.py", "helpers/gains.py"]')
    told = "helpers/gains.py is named in nodes, but no flow"
    done = tank.runpytest(*RECORD)
    assert told in " ".join(done.stdout.str().split())
    assert "helpers, which has no __init__.py" in " ".join(done.stdout.str().split())
    done = tank.runpytest(*ONLINE)
    assert told in " ".join(done.stdout.str().split())
    (tank.path / "helpers" / "__init__.py").touch()
    assert "is named in nodes" not in tank.runpytest(*RECORD).stdout.str()


def test_a_named_file_of_constants_is_not_reported(tank: pytest.Pytester) -> None:
    (tank.path / "settings.py").write_text("GAIN = 2.0\n")
    (tank.path / "unused.py").write_text("GAIN = 2.0\n")
    changed(tank, "keeper", "import rospy\n", "import rospy\nimport settings\nimport unused\n")
    changed(tank, "keeper", "flow = GAIN * missing", "flow = settings.GAIN * missing")
    changed(tank, "test_tank", 'nodes=["keeper.py"]', 'nodes=["keeper.py", "settings.py", "unused.py"]')
    told = tank.runpytest(*RECORD).stdout.str()
    assert "unused.py is named in nodes, but no flow" in told
    assert "settings.py is named in nodes" not in told


def test_episode_of_older_text_is_an_error() -> None:
    ended = EpisodeRun(EpisodePlan(1), Recorder().finish(), passed=True, older=(Path("gains.py"),))
    with pytest.raises(StaleTextError, match=r"gains\.py: the candidate was written into the file"):
        _outcome(lambda: ended, -1.0)


MANIFEST = (
    '<package format="3"><name>pilot</name><depend>rospy</depend><!-- <depend>std_msgs</depend> --></package>'
)


@pytest.mark.parametrize(
    ("manifest", "new", "told"),
    [
        (MANIFEST, "from std_msgs.msg import Bool\n", "add <exec_depend>std_msgs</exec_depend>"),
        (MANIFEST, "import std_msgs.msg\n", "add <exec_depend>std_msgs</exec_depend>"),
        (MANIFEST.replace("rospy", "std_msgs"), "from std_msgs.msg import Bool\n", ""),
        (MANIFEST, "from pilot.msg import Bool\n", ""),
        (MANIFEST, "from nav_msgs.msg import Odometry, Path\n", ""),
        (
            MANIFEST.replace(' format="3"', ""),
            "from std_msgs.msg import Bool\n",
            "<run_depend>std_msgs</run_depend>",
        ),
        ("not even <xml", "from std_msgs import msg\n", "add <exec_depend>std_msgs</exec_depend>"),
    ],
)
def test_an_undeclared_dependency_of_a_patch_is_reported(
    tmp_path: Path, manifest: str, new: str, told: str
) -> None:
    (tmp_path / "pilot" / "scripts").mkdir(parents=True)
    (tmp_path / "pilot" / "package.xml").write_text(manifest)
    node = tmp_path / "pilot" / "scripts" / "node.py"
    node.write_text("from nav_msgs.msg import Odometry\n")
    sentences = undeclared(
        {node: f"from nav_msgs.msg import Odometry\n{new}", tmp_path / "x.yaml": "a: ["}, tmp_path
    )
    assert len(sentences) == bool(told)
    assert told in "".join(sentences)
    assert all("pilot/package.xml does not depend on" in one for one in sentences)


@pytest.mark.usefixtures("quick_acceptance")
def test_a_repair_without_new_imports_reports_no_package(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*ONLINE, "--tarl-repair")
    assert "package.xml" not in (tank.path / result(tank)["repair"]["patch"]).read_text()
