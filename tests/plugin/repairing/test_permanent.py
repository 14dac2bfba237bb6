"""Permanent drifts: repaired without a condition, recorded again, and from then on the design."""

from __future__ import annotations

import re
import sys

import pytest

from pytest_tarl.design import adopted
from tests.plugin.tank import ONLINE, RECORD, changed, fixture_file, result

REPAIR = (*ONLINE, "--tarl-repair")
TARL = (sys.executable, "-m", "pytest_tarl")
WORN = ("--tarl-drift", "worn")
# The gain that a clogged pump needs floods the tank with an intact pump, and no sensor distinguishes the two.
OVERFLOW = """\
        if level > 1.3:
            tarl.reward(-40.0)
            pytest.fail("the tank is flooded")
        tarl.reward("""


@pytest.fixture
def worn(tank: pytest.Pytester) -> pytest.Pytester:
    """A tank whose pump is permanently worn out and whose inflow must not exceed that of the old pump."""
    changed(
        tank,
        "test_tank",
        "import pytest\nfrom pytest_tarl import Sensor",
        "import pytest\nfrom pytest_tarl import Drift, Sensor",
    )
    changed(tank, "test_tank", '{"clogged": 0.25}', '{"worn": Drift(0.1, permanent=True), "clogged": 0.25}')
    changed(tank, "test_tank", "        tarl.reward(", OVERFLOW)
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    return tank


@pytest.mark.usefixtures("quick_acceptance")
def test_permanent_drift_is_repaired_unconditionally(
    worn: pytest.Pytester,
) -> None:
    done = worn.runpytest(*REPAIR, *WORN)
    done.assert_outcomes(failed=1, deselected=1)
    found = result(worn)
    assert found["repair"]["accepted"]
    assert found["repair"]["guard"] == ""
    assert found["atr"]["nominal_repaired"] < found["atr"]["offline"] - 5  # the old world floods, as expected
    told = " ".join(done.stdout.str().split())
    assert re.search(r"old world repaired -\d", told)
    assert "pytest test_tank.py::test_fills --tarl-record --tarl-drift worn" in told
    (patch,) = worn.path.glob(".tarl/patches/*.patch")
    header = patch.read_text()
    assert re.search(r"# old world and repaired: -\d.*not required, because the drift is permanent", header)
    assert "# record: pytest test_tank.py::test_fills --tarl-record --tarl-drift worn\n" in header


def test_same_repair_of_a_temporary_drift_is_refused(worn: pytest.Pytester) -> None:
    changed(worn, "test_tank", "Drift(0.1, permanent=True)", "0.1")
    done = worn.runpytest(*REPAIR, *WORN, "--tarl-budget=60")
    assert not result(worn)["repair"]["accepted"]
    told = " ".join(done.stdout.str().split())
    assert "but makes the designed world worse. Declare a sensor that distinguishes the two worlds" in told
    assert 'drifts={"worn": Drift(…, permanent=True)}' in told
    (page,) = worn.path.glob(".tarl/report/*.html")
    assert "Declare a sensor that distinguishes the two worlds" in page.read_text()


@pytest.mark.usefixtures("quick_acceptance")
def test_applied_repair_makes_the_drift_the_design(worn: pytest.Pytester) -> None:
    worn.runpytest(*REPAIR, *WORN)
    (patch,) = worn.path.glob(".tarl/patches/*.patch")
    applied = worn.run(*TARL, "apply", str(patch))
    applied.stdout.fnmatch_lines(
        [
            "then:  pytest test_tank.py::test_fills --tarl-record --tarl-drift worn",
            "then:  commit keeper.py and .tarl/utility together: the drift is now part of the design",
        ]
    )
    worn.runpytest().assert_outcomes(
        passed=1, failed=1
    )  # repaired for the new world, recorded in the old one
    done = worn.runpytest(*RECORD, *WORN)
    done.assert_outcomes(passed=1, deselected=1)
    done.stdout.fnmatch_lines(["*the design now includes the drift 'worn': runs without flags get it*"])
    assert adopted(fixture_file(worn)) == ("worn",)
    worn.runpytest().assert_outcomes(passed=2)
    worn.runpytest(*ONLINE, *WORN).assert_outcomes(passed=1, deselected=1)
    shown = worn.run(*TARL, "show", str(fixture_file(worn)))
    shown.stdout.fnmatch_lines(["*design*with the drift worn, permanent"])
    worn.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)  # the drift remains part of the design
    assert adopted(fixture_file(worn)) == ("worn",)
    other = worn.runpytest(*ONLINE, "--tarl-drift=clogged")
    told = " ".join(other.stdout.str().split())
    assert "the design has the drift 'worn', but tarl_drift held only 'clogged'" in told


def test_workers_record_a_permanent_drift_identically(worn: pytest.Pytester) -> None:
    changed(worn, "keeper", "GAIN = 2.0", "GAIN = 20.0")
    worn.runpytest(*RECORD, *WORN).assert_outcomes(passed=1, deselected=1)
    alone = fixture_file(worn).read_bytes()
    worn.runpytest(*RECORD, *WORN, "--tarl-workers=2").assert_outcomes(passed=1, deselected=1)
    assert fixture_file(worn).read_bytes() == alone
    worn.runpytest(*RECORD, "--tarl-workers=2").assert_outcomes(passed=1, deselected=1)
    assert fixture_file(worn).read_bytes() == alone


def test_recording_can_return_to_the_world_without_drift(worn: pytest.Pytester) -> None:
    before = fixture_file(worn).read_bytes()
    changed(worn, "keeper", "GAIN = 2.0", "GAIN = 20.0")
    worn.runpytest(*RECORD, *WORN)
    changed(worn, "keeper", "GAIN = 20.0", "GAIN = 2.0")
    worn.runpytest(*RECORD, "--tarl-drift=none").assert_outcomes(passed=1, deselected=1)
    assert fixture_file(worn).read_bytes() == before


def test_only_a_permanent_drift_can_be_recorded(worn: pytest.Pytester) -> None:
    done = worn.runpytest(*RECORD, "--tarl-drift=clogged")
    told = " ".join(done.stdout.str().split())
    assert "but 'clogged' is not permanent" in told
    assert 'drifts={"clogged": Drift(0.25, permanent=True)}' in told
    assert adopted(fixture_file(worn)) == ()
    done = worn.runpytest(*RECORD, "--tarl-drift=wrn")
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines(["*No test declares the drift 'wrn' (declared: clogged, worn).*"])


OTHER = """

@pytest.mark.tarl(
    nodes=["keeper.py"],
    sensors=[Sensor("level", topic="/level", field="data", low=0, high=1, bins=10)],
    drifts={declared},
)
def test_keeps_full(tarl, tarl_drift):
    level, pump = 0.95, 1.0 if tarl_drift is None else tarl_drift
    tarl.start("keeper.py")
    for _ in range(10):
        level -= 0.01
        tarl.bus.publish("/level", Float64(data=level))
        tarl.step(0.1)
        valve = tarl.bus.latest("/valve")
        level += 0.1 * pump * (valve.data if valve else 0.0)
        tarl.reward(-abs(1.0 - level))
        assert level < 1.5
"""


@pytest.mark.usefixtures("quick_acceptance")
@pytest.mark.parametrize(
    ("declared", "words"),
    [
        ('{"worn": Drift(0.1, permanent=True)}', "without the repair under the same drift"),
        ("{}", "so it ran in the old world, in which losses are allowed"),
    ],
)
def test_tests_that_declare_the_drift_run_in_its_world(
    worn: pytest.Pytester, declared: str, words: str
) -> None:
    path = worn.path / "test_tank.py"
    path.write_text(path.read_text() + OTHER.replace("{declared}", declared))
    worn.runpytest(*RECORD).assert_outcomes(passed=2, deselected=1)
    worn.runpytest(*REPAIR, *WORN)
    (patch,) = worn.path.glob(".tarl/patches/*-fills-worn-*.patch")
    assert "test_keeps_full: " in patch.read_text()
    assert words in patch.read_text()
    worn.run(*TARL, "apply", str(patch))
    done = worn.runpytest(*RECORD, *WORN)
    told = " ".join(done.stdout.str().split())
    lagging = "test_keeps_full has a recording of the same node in the old world" in told
    assert lagging == (declared == "{}")
