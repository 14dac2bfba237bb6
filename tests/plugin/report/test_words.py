from __future__ import annotations

import math

import pytest

from pytest_tarl.model import Edit, OperandEffect, Verdict
from pytest_tarl.report import amounts, repair_words, words


@pytest.mark.parametrize(("value", "text"), [
    (0.0, "0.00"), (9.78123, "9.78"), (-0.5, "-0.50"), (0.012345, "0.0123"), (2614.4, "2614"), (-123456.7, "-123457"),
    (1.5e7, "1.5e+07"), (math.nan, "n/a"), (None, "n/a"),
])  # fmt: skip
def test_rewards_are_printed_with_about_three_digits(value, text):
    assert amounts.amount(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(2.0, "+2.00"), (-2.0, "-2.00"), (0.0, "+0.00"), (math.nan, "n/a")]
)
def test_differences_are_printed_with_a_sign(value, text):
    assert amounts.signed(value) == text


@pytest.mark.parametrize(("value", "text"), [
    (0.0004, "p < 0.001"), (0.001, "p = 0.001"), (0.0213, "p = 0.021"), (1.0, "p = 1"), (math.nan, "p unknown"),
])  # fmt: skip
def test_p_values_are_written_as_equations(value, text):
    assert amounts.p_value(value) == text


def test_a_running_mean_averages_the_values_so_far():
    assert amounts.running_mean([1.0, 3.0, -1.0]) == [1.0, 2.0, 1.0]


SENTENCES = {
    Verdict("degraded", 0.002, 0.01, 3.0, 0.4, 0.5): (
        "In the drift scenario 'mud' an episode earns 3.00 less than designed (p = 0.01)."
    ),
    Verdict("degraded", 0.9, 0.6, -3.0, 0.4, 0.5, None, 0.0001, (1.0, 0.25), ("success",)): (
        "In the drift scenario 'mud' missions succeed in 25 % of the episodes, instead of 100 % (p < 0.001)."
    ),
    Verdict("degraded", 0.9, 0.01, 3.0, 0.4, 0.5, None, 0.02, (0.9, 0.5), ("reward", "success")): (
        "In the drift scenario 'mud' an episode earns 3.00 less than designed (p = 0.01); "
        "missions succeed in 50 % of the episodes, instead of 90 % (p = 0.02)."
    ),
    Verdict("drifted", 0.002, 0.3, 0.1, 0.4, 0.5): (
        "The drift scenario 'mud' differs from the designed one (p = 0.002), "
        "but no loss of reward was found (p = 0.3)."
    ),
    Verdict("drifted", 0.002, 0.01, 0.2, 0.4, 0.5): (
        "The drift scenario 'mud' differs from the designed one (p = 0.002); "
        "an episode earns 0.20 less, within the tolerance of 0.50."
    ),
    Verdict("no difference", 0.6, 0.4, 0.1, 0.4, 0.5): (
        "No difference was found between the drift scenario 'mud' and the designed one; "
        "a loss of 0.40 per episode would have been detected."
    ),
}


@pytest.mark.parametrize(("verdict", "said"), SENTENCES.items())
def test_every_verdict_has_its_own_sentence(varied, verdict, said):
    assert words.verdict_sentence(varied(verdict=verdict)) == said


def test_undetectable_loss_is_stated(varied):
    unseen = varied(verdict=Verdict("no difference", 0.5, 0.5, 0.0, math.inf, 0.5))
    assert words.verdict_sentence(unseen).endswith("; too few episodes were run to detect any loss.")


def test_literals_are_replaced_and_named_constants_are_multiplied():
    assert repair_words.edit_words(Edit("a.py", 3, "5", 12.0)) == "5 → 12"
    assert repair_words.edit_words(Edit("a.py", 3, "self.kp", 2.2, factor=True)) == "self.kp × 2.2"
    assert repair_words.operand_words(OperandEffect("5", 5, 12.0, 1.0)) == "5 → 12"
    assert repair_words.operand_words(OperandEffect("KP", None, 2.2, 1.0)) == "KP × 2.2"
    follows = OperandEffect("KP", 4.0, -1.7, 1.0, what="KP follows light")
    assert repair_words.operand_words(follows) == "KP follows light"


def test_a_statement_over_several_lines_is_joined_and_shortened():
    assert words.one_line("f(\n    a,\n    b)") == "f( a, b)"
    assert words.one_line("x" * 50, 20) == "x" * 19 + "…"
    assert words.one_line("x" * 50, 3) == "x" * 15 + "…"
