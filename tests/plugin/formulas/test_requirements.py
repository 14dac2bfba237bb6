"""Requirements as formulas, end to end: markers, `tarl.require`, messages of violations."""

from __future__ import annotations

import pytest

pytest.importorskip("rtamt")

BODY = """\
import pytest
from pytest_tarl import Sensor, Signal
from pytest_tarl.ros import message_type

Bool = message_type("std_msgs/msg/Bool")
String = message_type("std_msgs/msg/String")


@pytest.mark.tarl(
    nodes=["node.py"],
    sensors=[Sensor("wet", topic="/wet", field="data"),
             Sensor("mode", topic="/mode", field="data", categories=("auto", "manual"))],
    {marker}
)
def test_drives(tarl):
    gap = 1.0
    for step in range(20):
        tarl.bus.publish("/wet", Bool(data=step >= 10))
        tarl.bus.publish("/mode", String(data="auto"))
        tarl.step(0.1 if step % 2 else 0.3)
        gap -= 0.04
        {body}
"""
OBSERVE = "tarl.observe(gap=gap); tarl.reward(1.0)"


def run(pytester: pytest.Pytester, marker: str, body: str = OBSERVE, *flags: str) -> pytest.RunResult:
    pytester.makeini("[pytest]\naddopts = -p no:randomly -p no:asyncio -p no:rerunfailures\n")
    pytester.makefile(".py", node="", test_node=BODY.format(marker=marker, body=body))
    return pytester.runpytest("-q", *flags)


def told(result: pytest.RunResult) -> str:
    return " ".join(result.stdout.str().split())


HOLD = {
    "of a signal that the test observes": 'requires=["always (gap > 0.15)"], signals=["gap"]',
    "of a sensor": 'requires=["eventually[0:3] (wet > 0)"], signals=["gap"]',
    "beside an observation that no formula names": 'requires=["eventually wet"]',
    "of a name that is observed and not declared": 'requires=["always (gap > 0.15)", "eventually wet"]',
    "of a field of a message": (
        'requires=["always (dry > 0) or eventually wet"], '
        'signals=[Signal("dry", topic="/wet", field=lambda message: not message.data), "gap"]'
    ),
    "of a response": 'requires=["always ((gap < 0.5) -> eventually[0:1] (wet > 0))"], signals=["gap"]',
}


@pytest.mark.parametrize("marker", HOLD.values(), ids=HOLD)
def test_a_satisfied_formula_prints_nothing(pytester: pytest.Pytester, marker: str) -> None:
    result = run(pytester, marker)
    result.assert_outcomes(passed=1)


def test_a_violation_names_formula_time_and_signals(pytester: pytest.Pytester) -> None:
    result = run(pytester, 'requires=["always (gap > 0.5)", "always (wet < 0)"], signals=["gap"]')
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        [
            "requirement violated at 2 s: always (wet < 0) (robustness -1; wet = 1)",
            "requirement violated at 2.7 s: always (gap > 0.5) (robustness -0.3; gap = 0.48)",
        ]
    )
    result.stdout.no_fnmatch_line("*Traceback*")
    result.stdout.no_fnmatch_line("*episode.py*")


def test_deadline_is_violated_when_it_passes(pytester: pytest.Pytester) -> None:
    result = run(pytester, 'requires=["eventually[0:1.5] (wet > 0)"]', "tarl.reward(1.0)")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["requirement violated at 1.5 s: eventually[[]0:1.5] (wet > 0) *"])


def test_failing_test_body_has_its_own_reason(pytester: pytest.Pytester) -> None:
    result = run(
        pytester, 'requires=["always (gap > 0.9)"], signals=["gap"]', f"{OBSERVE}; assert gap > 0.8, 'own'"
    )
    result.assert_outcomes(failed=1)
    assert "AssertionError: own" in result.stdout.str()
    assert "requirement violated" not in result.stdout.str()


def test_require_in_the_test_body_adds_a_formula(pytester: pytest.Pytester) -> None:
    body = f'{OBSERVE}; step == 4 and tarl.require("always (gap > 0.5)")'
    result = run(pytester, 'signals=["gap"]', body)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["requirement violated at 2.7 s: always (gap > 0.5) *"])


def test_require_finds_its_signals_without_the_marker(pytester: pytest.Pytester) -> None:
    result = run(pytester, "", f'{OBSERVE}; step == 4 and tarl.require("always (gap > 0.5)")')
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["requirement violated at 2.7 s: always (gap > 0.5) *"])


MISTAKES = {
    "no text": ("requires=[3]", OBSERVE, "a formula is a string"),
    "a text in place of a list": ('requires="always (wet > 0)"', OBSERVE, "requires lists formulas"),
    "a typing error in a signal": (
        'requires=["always (gip > 0)"], signals=["gap"]',
        OBSERVE,
        "names 'gip', which is not a signal; did you mean 'gap'?",
    ),
    "an unknown signal": (
        'requires=["always (speed > 0)"]',
        OBSERVE,
        "names 'speed', which is not a signal (wet, gap): it is not a sensor, and no tarl.observe in the test's",
    ),
    "a typing error in a name that is observed and not declared": (
        'requires=["always (gip > 0)"]',
        "tarl.observe(gap=gap); tarl.reward(1.0)",
        "names 'gip', which is not a signal; did you mean 'gap'?",
    ),
    "a name that the test computes": (
        'requires=["always (gap > 0)"]',
        "tarl.observe(**{'g' + 'ap': gap}); tarl.reward(1.0)",
        "so TARL cannot read them from its source; declare this one in the marker, signals=['gap'].",
    ),
    "a name that only another test observes": (
        'requires=["always (ahead > 0)"]',
        OBSERVE + "\n\n\ndef test_other(tarl):\n    tarl.observe(ahead=1)",
        "names 'ahead', which is not a signal (wet, gap): it is not a sensor, and no tarl.observe in",
    ),
    "an observation without any formula": (
        "drifts={}",
        "tarl.observe(gap=gap)",
        "no such sensor or signal: 'gap'; the marker declares wet, mode.",
    ),
    "an observation that is a typing error of a sensor": (
        'requires=["always wet"]',
        "tarl.observe(wett=gap)",
        "no such sensor or signal: 'wett'; did you mean 'wet'?",
    ),
    "an unknown signal in the body": (
        "",
        "tarl.require('always (gip > 0)'); tarl.observe(gap=gap); tarl.reward(1.0)",
        "tarl.require: the formula 'always (gip > 0)' names 'gip', which is not a signal; did you mean 'gap'?",
    ),
    "a typing error in an operator": ('requires=["alway (wet > 0)"]', OBSERVE, "did you mean 'always'?"),
    "a bracket that is not closed": ('requires=["always (wet > 0"]', OBSERVE, "it ends too early"),
    "a sign of another language": (
        'requires=["always (wet > 0) → wet"]',
        OBSERVE,
        "'→' has no meaning in a formula",
    ),
    "two formulas": ('requires=["always wet wet"]', OBSERVE, "more than one formula"),
    "one equals sign": ('requires=["always (wet = 1)"]', OBSERVE, "write == to compare two values"),
    "true": ('requires=["always (wet == true)"]', OBSERVE, "booleans are 1 and -1"),
    "a minus": ('requires=["always (-wet > 0)"]', OBSERVE, "write (0 - gap) for -gap"),
    "bounds that fall": ('requires=["always[5:2] (wet > 0)"]', OBSERVE, "[5:2] s must increase"),
    "the next sample": ('requires=["always (next (wet > 0))"]', OBSERVE, "count samples"),
    "unless without bounds": (
        'requires=["always(wet > 0) unless (wet > 0)"]',
        OBSERVE,
        "unless needs bounds",
    ),
    "no signal": ('requires=["always (1 > 0)"]', OBSERVE, "names no signal"),
    "a compared formula": ('requires=["always ((once wet) > 0)"]', OBSERVE, "only numbers can be compared"),
    "the beginning only": ('requires=["wet > 0"]', OBSERVE, "put always or eventually before it"),
    "the past of the beginning": ('requires=["once (wet > 0)"]', OBSERVE, "looks back from the beginning"),
    "too late": (
        'requires=["always[30:40] (wet > 0)"], lasts=20',
        OBSERVE,
        "can never be judged: a part of it is evaluated after 30 s at the earliest, and no episode lasts longer",
    ),
    "texts": ('requires=["always (mode > 0)"]', OBSERVE, "a sensor with string values"),
    "a name twice": (
        'requires=[], signals=["wet"]',
        OBSERVE,
        "'wet' is used twice among sensors and signals",
    ),
    "no name": ('signals=["the gap"]', OBSERVE, "is not an ASCII identifier"),
    "a topic alone": ('signals=[Signal("a", topic="/a")]', OBSERVE, "a topic or a field but not both"),
    "signals that are none": ("signals=[3]", OBSERVE, "signals lists names and Signal"),
    "a word of the language": (
        'requires=["always (s > 0)"], signals=["s"]',
        OBSERVE,
        "s is a keyword of the formula language",
    ),
    "another reward": ('requires=["always wet"], reward="speed"', OBSERVE, 'reward must be "robustness"'),
    "a reward of nothing": ('reward="robustness"', OBSERVE, "needs at least one formula in requires"),
    "a cap of nothing": ('requires=["always wet"], robustness_cap=3', OBSERVE, "robustness_cap needs"),
    "two rewards": (
        'requires=["always wet"], reward="robustness", signals=["gap"]',
        OBSERVE,
        "remove tarl.reward from the test",
    ),
    "a signal that is never given": (
        'requires=["always (gap > 0)"], signals=["gap"]',
        "tarl.reward(1.0)",
        "needs the signal 'gap', which never had a value",
    ),
    "an observation with a typing error": ('signals=["gap"]', "tarl.observe(gab=1)", "did you mean 'gap'?"),
    "a signal that is a text": (
        'requires=["always (gap > 0)"], signals=["gap"]',
        "tarl.observe(gap='near')",
        "The signal 'gap' got 'near', which is not a number",
    ),
    "a division by zero": (
        'requires=["always (1 / gap > 0)"], signals=["gap"]',
        "tarl.observe(gap=0); tarl.reward(1.0)",
        "has no value: float division by zero",
    ),
    "infinities": (
        'requires=["always (gap - gap > 0)"], signals=["gap"]',
        "tarl.observe(gap=float('inf')); tarl.reward(1.0)",
        "has no value: infinity minus infinity",
    ),
    "an episode that is too short": (
        'requires=["eventually[30:40] (wet > 0)"]',
        "tarl.reward(1.0)",
        "after 30 s at the earliest, and the episode lasts 4 s",
    ),
    "a require that is none": (
        "requires=[]",
        "tarl.require('always (')",
        "tarl.require: the formula 'always (' cannot",
    ),
    "a require too late": (
        "drifts={}",
        "getattr(tarl, 'require')('always wet')",
        "its signals were not recorded so far",
    ),
    "no field": (
        'requires=["always (a > 0)"], signals=[Signal("a", topic="/wet", field="datum")]',
        OBSERVE,
        "has no field 'datum'",
    ),
}


@pytest.mark.parametrize(("marker", "body", "sentence"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_reported_in_one_sentence(
    pytester: pytest.Pytester, marker: str, body: str, sentence: str
) -> None:
    result = run(pytester, marker, body)
    assert result.parseoutcomes().keys() & {"failed", "errors", "error"}
    assert sentence in told(result)
    assert "Traceback" not in result.stdout.str()


def test_an_episode_without_virtual_time_is_an_error(pytester: pytest.Pytester) -> None:
    body = "\n".join(BODY.splitlines()).replace("tarl.step(0.1 if step % 2 else 0.3)", "")
    pytester.makefile(
        ".py",
        node="",
        test_node=body.format(marker='requires=["always (gap > 0)"], signals=["gap"]', body=OBSERVE),
    )
    assert "No virtual time passed" in told(pytester.runpytest("-q", "-p", "no:asyncio"))


def test_missing_rtamt_error_names_the_install_command(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pytest_tarl.formulas import parsing

    monkeypatch.setattr(parsing, "find_spec", lambda name: None)
    from pytest_tarl.extras import install_command

    assert install_command("stl") in told(run(pytester, 'requires=["always wet"]'))


def test_error_for_rtamt_names_the_supported_python_versions(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pytest_tarl.formulas import parsing

    monkeypatch.setattr(parsing, "NEWEST", (3, 9))
    assert "runs on Python 3.10 to 3.12; this is Python 3." in told(run(pytester, 'requires=["always wet"]'))
