from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from pytest_tarl.model import Bound, Culprit, Guarantee, OperandEffect, Partial, Repair, SitePlace
from pytest_tarl.report.terminal import lines

ROOT = Path("/home/dev/robot")
WHOLE = ("  page", "  again", "  next")


def told(comparison, width=100, page=None):
    return "\n".join(lines(comparison, width=width, root=ROOT, page=page))


def test_the_shuttle_gives_one_short_section(shuttle):
    again = (
        "pytest tests/test_traveller.py::test_delivers --tarl-online --tarl-drift mud --tarl-seed 1 "
        "--tarl-repair --tarl-search epsilon-greedy --tarl-search sweep"
    )
    assert told(shuttle, page=ROOT / ".tarl/report/delivers.html").splitlines() == [
        "tests/test_traveller.py::test_delivers[mud]: degraded",
        "  verdict  In the drift scenario 'mud' an episode earns 16.90 less than designed (p < 0.001).",
        "  reward   designed 9.78, deployed -6.83, repaired 9.42, designed world repaired 10.09",
        "  loss     16.90 per episode, about 90 % confidence 15.40 to 18.10; 6.2 standard deviations",
        "  parts    progress -9.30",
        "           clearance -7.60",
        "  where    x 4.2-7.1 m, terrain true",
        "  lines    1. traveller.py:30  vel = 5 * delta  (5 → 12: +14.20)",
        "           2. traveller.py:28  delta = goal - pos  (by its slice)",
        "           3. traveller.py:31  pub.publish(vel)  (by its slice)",
        "           (and 2 more)",
        "  slices   /odom → /velocity: utility changes most at traveller.py:30, 58.92 to 2.39",
        "  repair   accepted: 5 → 12 at traveller.py:30 where terrain and 4.167 <= pos <= 7.083",
        "  note     The site `err = abs(delta)` is only reached by a condition.",
        "  page     .tarl/report/delivers.html",
        f"  again    {again}",
        "  next     tarl apply .tarl/patches/test-delivers-mud-1a2b3c4d.patch",
    ]


@pytest.mark.parametrize("width", [20, 40, 72, 100, 200])
def test_only_commands_and_paths_exceed_the_width(any_comparison, width):
    for line in lines(any_comparison, width=width, root=ROOT)[1:]:
        assert len(line) <= max(width, 40) or line.startswith(WHOLE) or len(line.split()) <= 2


def test_refused_repair_has_its_reason(two_lists):
    text = told(two_lists, 200)
    assert "none accepted: the best change found gains too little" in text
    assert "best so far: self.kp × 2.2 at src/follower/node.py:63 where light == 'dusk <&>'" in text
    assert "tarl apply" not in text


def test_unrecorded_situations_are_listed_separately(two_lists):
    assert "x 1.2-8.8 m, light dusk <&>; not in the recording: x above 7.9 m, light night" in told(
        two_lists, 200
    )


def test_long_code_is_shortened_but_its_evidence_is_kept(two_lists):
    first = next(line for line in told(two_lists, 96).splitlines() if " 1. " in line)
    assert first.endswith("…  (self.kp × 2.2: +3.40)")
    assert len(first) <= 96


def test_code_too_long_for_its_location_goes_to_the_next_line(two_lists):
    lines = told(two_lists, 80).splitlines()
    place, code = next((a, b) for a, b in pairwise(lines) if " 1. " in a)
    assert place.endswith("src/follower/node.py:63  (self.kp × 2.2: +3.40)")
    assert code.strip().startswith("twist.angular.z = self.kp")
    assert len(code) <= 80


def test_path_longer_than_the_line_stays_whole(shuttle):
    long = f"{'a_long_name_of_a_package/' * 4}node.py"
    culprit = replace(shuttle.culprits[0], site=replace(shuttle.culprits[0].site, path=long))
    text = told(replace(shuttle, culprits=(culprit,)), 60)
    assert f"{long}:30" in text


def test_unknown_topic_is_named_by_its_call(shuttle):
    (only,) = shuttle.lists
    source = "(rclpy.create_subscription at src/relay/relay.py:148)"
    named = replace(only, taint_list=replace(only.taint_list, source=source))
    assert named.taint_list.name == "unknown topic at relay.py:148 → /velocity"


def test_next_command_searches_for_a_repair(unrepaired):
    command = "pytest tests/test_traveller.py::test_delivers --tarl-online --tarl-drift mud --tarl-seed 1 --tarl-repair"
    assert told(unrepaired).splitlines()[-1] == f"  next     {command}"


def test_detectable_loss_is_stated_without_a_difference(unchanged):
    text = told(unchanged, 200)
    assert "No difference was found" in text
    assert "a loss of 0.71 per episode would have been" in text
    assert "  lines" not in text
    assert "  next" not in text


def test_loss_without_a_region_has_no_slices(placeless):
    text = told(placeless)
    assert "no single situation stands out" in text
    assert "  slices" not in text
    assert "nan" not in text


def test_section_without_taint_lists_has_a_note(listless):
    text = told(listless, 200)
    assert "record again to see slices" in text
    assert "degraded" in text


def test_absolute_paths_are_shown_relative_to_the_root(varied, shuttle):
    site = SitePlace("m:f:x", str(ROOT / "src/a.py"), 3, "x = 1", "data", "assign")
    culprit = type(shuttle.culprits[0])(site, 1.0, "sweep", ())
    assert "1. src/a.py:3  x = 1  (no operand helps)" in told(varied(culprits=(culprit,)))


def test_terminal_does_not_show_the_exponent_as_the_constant(varied, shuttle):
    law = OperandEffect("KP", 4.0, -1.7, 2.5, what="KP follows light")
    text = told(varied(culprits=(replace(shuttle.culprits[0], operands=(law,)),)))
    assert "(KP follows light: +2.50)" in text


def test_default_seed_and_search_are_not_printed(varied, shuttle):
    text = told(varied(seed=0, searches=shuttle.searches[1:]))
    assert text.splitlines()[-2] == (
        "  again    pytest tests/test_traveller.py::test_delivers --tarl-online --tarl-drift mud --tarl-repair"
    )


def test_the_command_quotes_a_test_id_with_spaces(two_lists):
    assert "pytest 'tests/test_follower.py::test_follows[a b]' --tarl-online" in told(two_lists)


@pytest.mark.parametrize("reason", ["", "no operand helps", "gain too small", "nominal gets worse", "budget"])
def test_every_reason_for_a_refusal_has_its_own_text(varied, reason):
    text = told(varied(repair=Repair(False, "", (), reason=reason)))
    assert "none accepted: " in text
    assert f"none accepted: {reason}\n" not in text


def test_no_report_line_starts_with_a_percent_sign(varied):
    for length in range(40):
        note = "x" * length + " 100 % of 12 % are 12 %."
        found = lines(varied(notes=(note,)), width=60, root=ROOT)
        assert not [line for line in found if line.strip().startswith("%")]


def test_next_commands_stay_on_one_line(varied):
    name = "a/very/long/path/of/tests/" * 5 + "test_traveller.py::test_delivers"
    lines = told(varied(permanent=True, test=name, target=name), 80).splitlines()
    assert f"           pytest {name} --tarl-record --tarl-drift mud" in lines


def culprit_lines(varied, width: int, code: str) -> list[str]:
    """Return the lines about one culprit, `1. p.py:5`, that is ranked by its slice."""
    culprit = Culprit(SitePlace("p:x", "p.py", 5, code, "data", "assign"), 0.0, "slices")
    shown = told(varied(culprits=(culprit,)), width).splitlines()
    first = next(number for number, line in enumerate(shown) if line.startswith("  lines"))
    last = next(number for number, line in enumerate(shown) if line.startswith("  slices"))
    return [line[11:] for line in shown[first:last]]


def test_code_is_shortened_beyond_the_line_width(varied):
    # 100 columns: 11 for the label, 9 for `1. p.py:5`, 2 spaces, the code, 2 spaces, 14 for `(by its slice)`
    assert culprit_lines(varied, 100, "x" * 62) == [f"1. p.py:5  {'x' * 62}  (by its slice)"]
    assert culprit_lines(varied, 100, "x" * 63) == [f"1. p.py:5  {'x' * 61}…  (by its slice)"]


def test_code_with_little_room_gets_its_own_line(varied):
    assert culprit_lines(varied, 62, "x" * 50) == [f"1. p.py:5  {'x' * 23}…  (by its slice)"]
    assert culprit_lines(varied, 61, "x" * 23) == [f"1. p.py:5  {'x' * 23}  (by its slice)"]
    # 61 columns without the label and `1. `
    assert culprit_lines(varied, 61, "x" * 50) == ["1. p.py:5  (by its slice)", f"   {'x' * 46}…"]
    assert culprit_lines(varied, 61, "x" * 47) == ["1. p.py:5  (by its slice)", f"   {'x' * 47}"]


def test_bounds_have_a_line_for_each_world(varied):
    sure = Bound(0.9, 1.0, 0.95, "exact", True, 50)
    stated = Guarantee(50, 50, sure, 4.0, Bound(3.5, 4.5, 0.95, "exact", True, 50), 0.1, 2.0, 29, True)
    shown = told(varied(stated={"offline": stated, "repaired": stated}), 200).splitlines()
    assert [line for line in shown if "success at least" in line] == [
        f"  {label:<9}{world}: success at least 90 %, mean reward at least 3.5 (95 % confidence each, 50 episodes)"
        for label, world in (("bounds", "designed"), ("", "repaired"))
    ]


def test_partial_repair_has_its_apply_command(varied):
    partial = Partial("5 → 9 everywhere", 4.5, 3.25, 16.9, -0.5, -1.5, 0.9, "", "a.partial.patch")
    text = told(varied(repair=Repair(False, "", (), reason="gain too small", partial=partial)), 400)
    assert (
        "partial: 5 → 9 everywhere: the drift costs 16.90 per episode, and the change regains 4.50 of it (at least "
        "3.25, with about 90 % confidence); in the designed world, an episode with the change earns 0.50 less (at "
        "most 1.50 less); tarl apply --partial a.partial.patch"
    ) in text


def test_rewards_of_worlds_without_episodes_are_left_out(varied):
    shown = told(varied(totals={"online": (1.0, 2.0), "repaired": ()}))
    assert "  reward   deployed 1.50\n" in shown
