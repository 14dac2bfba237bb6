"""Sentences on repairs, formulas, losses and regions, for values written down by hand."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from pytest_tarl.model import (
    Attempt,
    Comparison,
    Edit,
    FormulaRow,
    FormulaWorld,
    LossInterval,
    Partial,
    Reason,
    Region,
    Repair,
    Verdict,
)
from pytest_tarl.report import amounts, formulas, html, repair_words, table, terminal, words
from pytest_tarl.sensors import Sensor

Varied = Callable[..., Comparison]
EDITS = (
    Edit("a.py", 3, "5", 12.0),
    Edit("b.py", 4, "KP", 0.5, factor=True),
    Edit("c.py", 5, "", 0.0, what="a new guard"),
)
WORDS = "5 → 12 at a.py:3, KP × 0.5 at b.py:4, a new guard at c.py:5"


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.1, "0.10"), (0.0999, "0.0999"), (999.99, "999.99"), (1000.0, "1000"), (999_999.0, "999999"),
     (-1e6, "-1e+06"), (-0.1, "-0.10"), (math.inf, "n/a"), (-math.inf, "n/a")],
)  # fmt: skip
def test_amounts_change_their_format_at_the_stated_limits(value: float, text: str) -> None:
    assert amounts.amount(value) == text


@pytest.mark.parametrize(
    ("effect", "text"), [(0.123, "0.12"), (-9.94, "9.9"), (10.0, "10"), (-100.0, "100"), (100.1, "over 100")]
)
def test_an_effect_size_has_two_digits(effect: float, text: str) -> None:
    assert amounts.deviations(effect) == text


def test_an_average_needs_two_episodes_for_an_interval() -> None:
    assert amounts.average(()) == "n/a per episode, 0 episodes"
    assert amounts.average((2.0,)) == "2.00 per episode, 1 episodes"
    assert amounts.average((1.0, 3.0)) == (  # 2 ± 12.71·√2/√2, Student's t with one degree of freedom
        "2.00 per episode, about 95 % confidence -10.71 to 14.71, 2 episodes"
    )
    assert amounts.expected(11.999999999999998) == 12.0


def test_repair_is_described_by_edits_and_condition() -> None:
    assert repair_words.repair_words(Repair(True, "wet", EDITS)) == f"{WORDS} where wet"
    assert repair_words.repair_words(Repair(True, "", EDITS)) == f"{WORDS} everywhere"


def test_line_of_several_edits_is_named_once() -> None:
    both = (
        Edit("a.py", 3, "-0.1", -0.3),
        Edit("b.py", 4, "KP", 0.5, factor=True),
        Edit("a.py", 3, "0.1", 0.3),
    )
    assert repair_words.repair_words(Repair(True, "", both)) == (
        "-0.1 → -0.3, 0.1 → 0.3 at a.py:3, KP × 0.5 at b.py:4 everywhere"
    )


def test_best_rejected_candidate_is_shown_with_its_reward() -> None:
    assert repair_words.best_words(Repair(False, "", EDITS)) == f"{WORDS} everywhere"
    run = Repair(False, "", EDITS, mean=2.5, episodes=7)
    assert repair_words.best_words(run) == f"{WORDS} everywhere (2.50 per episode, mean of 7)"


def test_attempt_line_states_outcome_and_episodes() -> None:
    one = Attempt("5 → 12", "not confirmed", 2.5, 7, True)
    assert (
        repair_words.attempt_words(one)
        == "5 → 12: dropped, its gain was not confirmed on further seeds, mean reward 2.50 in 7 fresh episodes"
    )
    assert repair_words.attempt_words(replace(one, fresh=False, reason="")) == (
        "5 → 12: accepted, mean reward 2.50 in 7 known episodes"
    )
    assert repair_words.attempt_words(replace(one, episodes=0, reason="never tested")) == (
        "5 → 12: not tested, because other candidates used all acceptance tests"
    )


def test_a_partial_repair_states_its_gain_with_bounds(varied: Varied) -> None:
    partial = Partial("5 → 12", 3.0, 2.0, 4.0, -0.5, -1.0, 0.95, "", "p.patch")
    expected = (
        "the drift costs 4.00 per episode, and the change regains 3.00 of it (at least 2.00, with about 95 % "
        "confidence); in the {}, an episode with the change earns 0.50 less (at most 1.00 less)"
    )
    assert repair_words.partial_words(partial, varied()) == expected.format("designed world")
    assert repair_words.partial_words(partial, varied(permanent=True)) == expected.format("old world")


def test_repair_refused_as_designed_has_two_remedies(varied: Varied) -> None:
    refused = Repair(False, "", EDITS[:1], reason="nominal gets worse")
    told = repair_words.ways_out(varied(repair=refused))
    assert told.startswith(
        "5 → 12 at a.py:3 everywhere restores the reward in the drift scenario 'mud' but makes"
    )
    assert told.endswith('drifts={"mud": Drift(…, permanent=True)}')
    assert 'drifts={"worn": ' in repair_words.ways_out(varied(repair=refused, drift=None))
    history = tuple(Attempt(what, "nominal gets worse", 0.0, 1, True) for what in ("first", "last"))
    other = replace(refused, reason="budget", history=(*history, Attempt("x", "budget", 0.0, 1, True)))
    assert repair_words.ways_out(varied(repair=other)).startswith("last restores the reward")
    best = replace(refused, history=history)
    assert repair_words.ways_out(varied(repair=best)).startswith("5 → 12 at a.py:3 everywhere restores")
    for nothing in (None, replace(refused, accepted=True), replace(refused, reason="budget")):
        assert repair_words.ways_out(varied(repair=nothing)) == ""
    assert repair_words.ways_out(varied(repair=refused, permanent=True)) == ""


def refused(mean: float, *, reason: Reason = "gain too small", fresh: bool = True) -> Repair:
    return Repair(False, "", EDITS, history=(Attempt("KP → 3", reason, mean, 8, fresh),))


def test_nearly_full_repair_names_a_sufficient_tolerance(varied: Varied) -> None:
    totals = {"offline": (10.0, 10.0), "online": (0.0, 0.0)}
    margin = replace(varied().verdict, tolerance=0.5)
    told = repair_words.wider_tolerance(varied(totals=totals, verdict=margin, repair=refused(9.0)))
    assert told == (
        "KP → 3 restores 90 % of the loss; 1.00 per episode remain, more than the tolerance of 0.50. If that is "
        "acceptable, declare tolerance=1.5 in the marker and search again"
    )


@pytest.mark.parametrize(
    "repair",
    [
        None,
        Repair(True, "", EDITS),
        refused(7.9),  # restores less than 80 %
        refused(9.6),  # within the tolerance
        refused(9.0, reason="fails too often"),
        refused(9.0, fresh=False),
    ],
)
def test_other_repairs_come_without_advice_on_the_tolerance(varied: Varied, repair: Repair | None) -> None:
    totals = {"offline": (10.0, 10.0), "online": (0.0, 0.0)}
    margin = replace(varied().verdict, tolerance=0.5)
    assert repair_words.wider_tolerance(varied(totals=totals, verdict=margin, repair=repair)) == ""


KEPT = {
    "online": FormulaWorld(0.5, 0.25, 9, 0, None),
    "offline": FormulaWorld(1e-300, 0.0, 9, 0, None),  # robustness of a strict comparison at its limit
}
BROKEN = {"online": FormulaWorld(-0.5, -1.0, 9, 3, 2.25), "repaired": FormulaWorld(2.0, 1.0, 4, 0, None)}
FORMULAS = (FormulaRow("never", {}), FormulaRow("kept", KEPT), FormulaRow("broken", BROKEN))


def test_violated_formulas_come_first(varied: Varied) -> None:
    assert [*formulas.lines(varied(formulas=FORMULAS))] == [
        "broken: deployed -0.50 (violated in 3 of 9, first at 2.25 s), repaired 2.00",
        "never: never judged",
        "kept: designed 0.00, deployed 0.50",
    ]
    never, _, broken = formulas.page_rows(varied(formulas=FORMULAS))
    assert (never["first"], broken["first"]) == (None, 2.25)
    assert [*never["worlds"].values()] == [None] * 4
    assert [*broken["worlds"]] == ["offline", "online", "repaired", "nominal_repaired"]
    assert broken["worlds"]["repaired"].robustness == 2.0
    assert formulas.violated(FORMULAS[2])
    assert not formulas.violated(FORMULAS[1])


def test_loss_is_printed_with_interval_and_effect_size(varied: Varied) -> None:
    totals = {"offline": (1.0, 3.0, 5.0), "online": (0.0, 2.0, 4.0)}
    verdict = Verdict("degraded", 0.1, 0.1, 1.0, 1.0, 1.0, LossInterval(0.5, 1.5, 0.9))
    one = varied(totals=totals, verdict=verdict)
    assert words.loss_words(one) == "about 90 % confidence 0.50 to 1.50; 0.4 standard deviations"
    exact = replace(verdict, interval=LossInterval(0.5, 1.5, 0.9, exact=True))
    assert words.loss_words(varied(totals=totals, verdict=exact)).startswith("90 % confidence 0.50")
    assert words.loss_words(varied(totals=totals, verdict=replace(verdict, interval=None))) == (
        "0.4 standard deviations"
    )
    for few in ({"online": (1.0,)}, {"offline": (1.0,)}):
        assert words.loss_words(varied(totals=totals | few, verdict=verdict)) == ""
    two = varied(totals={"offline": (1.0, 3.0), "online": (0.0, 2.0)}, verdict=verdict)
    assert words.loss_words(two) == "about 90 % confidence 0.50 to 1.50; 0.4 standard deviations"


def test_worsened_reward_parts_are_sorted_by_loss(varied: Varied) -> None:
    parts = {"a": (5.0, 3.0), "b": (1.0, 9.0), "c": (0.0, -8.0), "tiny": (0.0, -0.09), "same": (1.0, 1.0)}
    one = varied(parts=parts, lost={"c": ((12, 1),), "b": ((12, 1),)})
    assert words.lost_parts(one) == [("c", -8.0), ("a", -2.0)]
    assert words.lost_words(one, "c") == "x 5.0-5.4 m, terrain true"
    assert words.lost_words(one, "a") == words.lost_words(one, "b") == ""
    assert [*terminal._parts(one)] == ["c -8.00 where x 5.0-5.4 m, terrain true", "a -2.00"]


def test_a_region_names_known_new_and_avoided_cells(varied: Varied) -> None:
    region = Region(((12, 1), (13, 1)), ((13, 1),), ((3, 0),))
    assert words.region_words(varied(region=region)) == (
        "x 5.0-5.4 m, terrain true; not in the recording: x 5.4-5.8 m, terrain true; "
        "no longer visited: x 1.2-1.7 m, terrain false"
    )
    without = Region(((12, 1), (13, 0)), (), (), without=(1,))
    assert words.region_words(varied(region=without)) == "x 5.0-5.8 m, regardless of terrain"
    assert words.region_words(varied(region=Region())) == ""
    assert words.paper_region_words(varied(paper_region=())) == ""
    assert words.paper_region_words(varied(paper_region=((12, 1),))) == "x 5.0-5.4 m, terrain true"


def test_path_below_the_root_is_relative() -> None:
    root = Path("/project")
    assert words.place("/project/src/a.py", 3, root) == "src/a.py:3"
    assert words.place("/other/a.py", 3, root) == "/other/a.py:3"
    assert words.place("src/a.py", 3, root) == "src/a.py:3"


def test_code_longer_than_the_width_is_cut() -> None:
    assert words.one_line("x" * 20, 20) == "x" * 20
    assert words.one_line("x" * 18 + " yz", 20) == "x" * 18 + "…"


def test_table_row_has_test_drift_and_verdict(varied: Varied) -> None:
    one = varied(totals={"offline": (1.0, 3.0), "online": (0.0,)})
    assert table.row(one) == (
        "tests/test_traveller.py::test_delivers",
        "mud",
        "2.00",
        "0.00",
        "16.90",
        "degraded",
        "x 4.2-7.1 m, terrain true",
    )
    quiet = varied(drift=None, totals={}, verdict=Verdict("no difference", 0.4, 0.6, 0.1, 0.2, 0.5))
    assert table.row(quiet)[1:] == ("online", "n/a", "n/a", "0.10", "no difference", "")


def test_texts_beyond_three_are_counted() -> None:
    assert [*terminal._some(["a", "b", "c"])] == ["a", "b", "c"]
    assert [*terminal._some(["a", "b", "c", "d", "e"])] == ["a", "b", "c", "(and 2 more)"]


def test_attempts_before_an_accepted_repair_are_counted(varied: Varied, shuttle: Comparison) -> None:
    history = tuple(Attempt(f"c{n}", "not confirmed", 1.0, 0, True) for n in range(5))
    accepted = shuttle.repair
    assert accepted is not None
    told = [
        *terminal._repair(varied(repair=replace(accepted, history=(*history, Attempt("ok", "", 1, 1, True)))))
    ]
    assert told[1:] == ["5 tried before; the last: c4: dropped, its gain was not confirmed on further seeds"]
    refused = Repair(False, "", (), reason="budget", history=history)
    told = [*terminal._repair(varied(repair=refused))]
    assert told[0] == "none accepted: the search reached its limit of episodes"
    assert [line.split(":")[0] for line in told[1:]] == ["tried c4", "tried c3", "tried c2", "(and 2 more)"]
    assert [*terminal._repair(varied(repair=None))] == []


def test_repair_states_the_restored_share(varied: Varied) -> None:
    totals = {"offline": (8.0,), "online": (4.0,), "repaired": (7.0,)}
    assert html._share(varied(totals=totals)) == 75.0
    assert html._share(varied(totals=totals | {"online": (8.0,)})) is None
    for world in totals:
        assert (
            html._share(varied(totals={name: one for name, one in totals.items() if name != world})) is None
        )


@pytest.mark.parametrize(
    ("lengths", "expected"),
    [((5, 4, 3), True), ((4, 4, 3), False), ((4, 5, 3), False), ((5,), False)],
)
def test_designed_curve_is_clipped_at_the_longest_other(lengths: tuple[int, ...], expected: bool) -> None:
    kinds = ("offline", "online", "search")
    curves = [{"kind": kind, "mean": [0.0] * size} for kind, size in zip(kinds, lengths, strict=False)]
    assert html._clipped(curves) is expected
    assert not html._clipped([{"kind": "online", "mean": [0.0]}])


def test_page_describes_the_largest_change() -> None:
    row = {"title": "", "offline": [[1.0, None]], "online": [[0.5, 9.0]]}
    figure = {"sites": [[30, "vel = (\n 5)", "a.py"]], "axis": {"names": ["x 0-1", "x 1-2"]}, "rows": [row]}
    assert html._largest_change(figure) == (
        "The largest change, −0.50, is at x 0–1, in line 30 (“vel = ( 5)”)."
    )
    wet = {"title": "wet true", "offline": [[1.0, 1.0]], "online": [[0.75, 2.5]]}
    told = html._largest_change(figure | {"rows": [row, wet]})
    assert told.startswith("The largest change, +1.50, is at x 1–2, wet true, in line 30")
    nothing = row | {"online": [[None, 9.0]]}
    assert html._largest_change(figure | {"rows": [nothing]}) == "No cell was visited in both worlds."


def test_curves_end_with_their_mean_and_episodes() -> None:
    curves = [{"name": "designed", "mean": [1.0, 2.5]}, {"name": "deployed", "mean": [-3.0]}]
    assert html._curves_in_words(curves) == (
        "designed 2.50 after 2 episodes; deployed −3.00 after 1 episodes"
    )


def test_captions_say_what_the_figure_leaves_out(varied: Varied) -> None:
    x = Sensor("x", topic="/x", field="data", low=0, high=4, bins=4)
    kind, other = (Sensor(name, topic=f"/{name}", field="data") for name in ("kind", "other"))
    cells = tuple((0, n, 0) for n in range(7))
    inside = {"axis": {"outside": False}}
    one = varied(sensors=(x, kind, other), cells=cells, region=Region(cells[:1]))
    assert [*html._captions(one, inside)] == [
        "Each value is the mean over other.",
        "Only the 6 most frequent values of kind are shown.",
    ]
    assert [*html._captions(replace(one, cells=cells[:6]), {"axis": {"outside": True}})] == [
        "Each value is the mean over other.",
        "The outermost columns hold all values beyond the range.",
    ]
    assert [*html._captions(varied(sensors=(x,), cells=((0,),), region=Region()), inside)] == []
