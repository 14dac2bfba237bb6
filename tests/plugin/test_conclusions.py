"""Results other than the verdict: output for CI, several drifts, parts of the reward."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.plugin.tank import ONLINE, RECORD, changed

PARTS = "tarl.reward(level=-abs(1.0 - level), time=-0.01)"


@pytest.fixture(scope="module")
def record_once() -> dict[str, bytes]:
    return {}


@pytest.fixture
def drifting(tank: pytest.Pytester, record_once: dict[str, bytes]) -> pytest.Pytester:
    """The project with a reward in parts and two drifts, one of which has no effect."""
    changed(tank, "test_tank", "tarl.reward(-abs(1.0 - level))", PARTS)
    changed(tank, "test_tank", '{"clogged": 0.25}', '{"clogged": 0.25, "fine": 1.0}')
    folder = tank.path / ".tarl" / "utility"
    if not record_once:
        tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
        record_once.update({file.name: file.read_bytes() for file in folder.glob("*.npz")})
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in record_once.items():
        (folder / name).write_bytes(content)
    return tank


def properties(path: Path) -> dict[str, dict[str, str]]:
    cases = ElementTree.parse(path).getroot().iter("testcase")
    return {
        str(case.get("name")): {str(one.get("name")): str(one.get("value")) for one in case.iter("property")}
        for case in cases
    }


@pytest.mark.parametrize("workers", ["-n0", "-n2"])
def test_junit_has_the_findings_as_properties_of_the_test(drifting: pytest.Pytester, workers: str) -> None:
    drifting.runpytest(*ONLINE, "--junitxml=found.xml", workers)
    found = properties(drifting.path / "found.xml")
    clogged, fine = found["test_fills[clogged]"], found["test_fills[fine]"]
    assert clogged["tarl_verdict"] == "degraded"
    assert float(clogged["tarl_p_loss"]) < 0.05
    low, high = map(float, clogged["tarl_loss_interval"].split(" to "))
    assert low < float(clogged["tarl_loss"]) < high
    assert clogged["tarl_region"].startswith("level ")
    assert clogged["tarl_culprit"].startswith("keeper.py:")
    assert fine["tarl_verdict"] == "no difference"
    assert "tarl_culprit" not in fine


@pytest.mark.usefixtures("quick_acceptance")
def test_the_patch_is_also_a_junit_property(drifting: pytest.Pytester) -> None:
    drifting.runpytest(*ONLINE, "--tarl-repair", "--tarl-drift=clogged", "--junitxml=found.xml")
    (found,) = properties(drifting.path / "found.xml").values()
    assert (drifting.path / found["tarl_patch"]).is_file()


def test_github_annotation_is_at_the_culprit(
    drifting: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = drifting.runpytest(*ONLINE)
    told.stdout.no_fnmatch_line("::error*")
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    monkeypatch.setenv("GITHUB_WORKSPACE", str(drifting.path.parent))
    told = drifting.runpytest(*ONLINE)
    (line,) = [one for one in told.outlines if one.startswith("::")]
    command, message = line.removeprefix("::").split("::", 1)
    assert command.startswith(f"error file={drifting.path.name}/keeper.py,line=")
    assert command.endswith("title=test_tank.py%3A%3Atest_fills[clogged]%3A degraded")
    assert "less than designed" in message
    assert "%0AWhere: level" in message


def test_only_several_drifts_are_shown_in_a_table(drifting: pytest.Pytester) -> None:
    told = drifting.runpytest(*ONLINE)
    told.stdout.fnmatch_lines(
        [
            "*test_fills, side by side",
            "*designed*deployed*loss*verdict*where",
            "  clogged *degraded*level *",
            "  fine *no difference*",
        ]
    )
    drifting.runpytest(*ONLINE, "--tarl-drift=fine").stdout.no_fnmatch_line("*side by side*")


def test_lost_reward_part_has_its_region(drifting: pytest.Pytester) -> None:
    told = drifting.runpytest(*ONLINE, "--tarl-drift=clogged")
    told.stdout.fnmatch_lines(["  parts    level -* where level *"])
    told.stdout.no_fnmatch_line("*time -*")
    (page,) = (drifting.path / ".tarl" / "report").glob("*.html")
    assert "Lost where" in page.read_text("utf-8")


def test_holm_corrects_after_all_tests(drifting: pytest.Pytester) -> None:
    told = drifting.runpytest(*ONLINE, "--tarl-holm", "-v")
    told.assert_outcomes(failed=1, passed=1, deselected=1)
    told.stdout.fnmatch_lines(["*clogged?*FAILED*", "*fine?*PASSED*", "*corrected for the 2 comparisons*"])
    results = (drifting.path / ".tarl" / "results").glob("*clogged*.json")
    corrected = json.loads(next(results).read_text())["verdict"]
    drifting.runpytest(*ONLINE, "--tarl-looks=1", "--tarl-drift=clogged")
    alone = json.loads(next((drifting.path / ".tarl" / "results").glob("*clogged*.json")).read_text())[
        "verdict"
    ]
    assert corrected["p_loss"] == pytest.approx(2 * alone["p_loss"])


def test_single_significance_may_vanish_after_correction(drifting: pytest.Pytester) -> None:
    many = ", ".join(f'"fine{n}": 1.0' for n in range(9))
    changed(drifting, "test_tank", '"fine": 1.0', many)
    short = (
        "--tarl-online",
        "--tarl-episodes=2",
    )  # few permutations, so that the smallest possible p-value is far from 0
    drifting.runpytest(*short, "--tarl-drift=clogged", "--tarl-looks=1").assert_outcomes(
        failed=1, deselected=1
    )
    told = drifting.runpytest(*short, "--tarl-holm")
    told.assert_outcomes(passed=10, deselected=1)
    told.stdout.fnmatch_lines(["*too few*", "*This test cannot reach significance*"])


def test_many_comparisons_get_as_many_permutations_as_holm_needs(drifting: pytest.Pytester) -> None:
    many = ", ".join(f'"fine{n}": 1.0' for n in range(9))
    changed(drifting, "test_tank", '"fine": 1.0', many)
    told = drifting.runpytest("--tarl-online", "--tarl-episodes=8", "--tarl-alpha=0.002", "--tarl-holm")
    told.assert_outcomes(failed=1, passed=9, deselected=1)
    told.stdout.no_fnmatch_line("*cannot reach significance*")


@pytest.mark.parametrize(
    ("other", "said"),
    [("--tarl-repair", "--tarl-repair need separate runs"), ("-n2", "with -n no process sees them all")],
)
def test_uncorrectable_run_is_refused(drifting: pytest.Pytester, other: str, said: str) -> None:
    told = drifting.runpytest("--tarl-online", "--tarl-holm", other)
    told.stderr.fnmatch_lines([f"*--tarl-holm*{said}*"])
    assert told.ret == pytest.ExitCode.USAGE_ERROR
