from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from pytest_tarl.errors import TarlError
from pytest_tarl.model import (
    Attempt,
    Bound,
    Culprit,
    Edit,
    FormulaRow,
    FormulaWorld,
    Guarantee,
    OperandEffect,
    Partial,
    Region,
    Repair,
    Sizes,
    Verdict,
)
from pytest_tarl.report.json_result import document, rectangles, schema, write
from pytest_tarl.sensors import Sensor

EPISODES = {"offline": 120, "online": 40, "search": 46, "acceptance": 28}


def written(comparison, tmp_path: Path):
    path = tmp_path / "results" / "delivers-mud.json"
    write(comparison, path, EPISODES)
    return json.loads(path.read_text("utf-8"), parse_constant=pytest.fail)


def test_every_comparison_is_valid_by_the_schema(any_comparison, tmp_path):
    jsonschema.Draft202012Validator.check_schema(schema())
    jsonschema.validate(written(any_comparison, tmp_path), schema())


def test_the_document_has_its_keys_in_the_documented_order(shuttle, tmp_path):
    found = written(shuttle, tmp_path)
    assert list(found) == [
        "format",
        "test",
        "drift",
        "seed",
        "episodes",
        "atr",
        "verdict",
        "bounds",
        "region",
        "novel",
        "no_longer_visited",
        "sites",
        "culprits",
        "repair",
        "notes",
    ]
    assert found["notes"] == list(shuttle.notes)
    assert found["format"] == 1
    assert found["episodes"] == EPISODES
    assert found["verdict"] == {
        "result": "degraded",
        "p_drift": 0.001,
        "p_loss": 0.0005,
        "loss": 16.9,
        "p_failures": 1.0,
        "success": {"offline": 1.0, "online": 1.0},
        "because": [],
        "detectable_loss": 0.41,
    }
    assert found["repair"] == {
        "accepted": True,
        "guard": "terrain and 4.167 <= pos <= 7.083",
        "patch": ".tarl/patches/test-delivers-mud-1a2b3c4d.patch",
        "edits": [{"path": "traveller.py", "line": 30, "code": "5", "value": 12.0}],
        "tried": [],
    }
    assert found["culprits"][0]["operands"] == [{"code": "5", "value": 5, "best": 12.0, "effect": 14.2}]
    assert found["sites"][5]["difference"] == pytest.approx(
        found["sites"][5]["online"] - found["sites"][5]["offline"]
    )


def test_region_is_a_list_of_rectangles_in_sensor_units(shuttle, tmp_path):
    assert written(shuttle, tmp_path)["region"] == [{"x": [4.166666667, 7.083333333], "terrain": [1, 1]}]


def test_open_ends_are_null_and_string_categories_are_kept(two_lists, tmp_path):
    found = written(two_lists, tmp_path)
    assert found["novel"] == [{"x": [7.916666667, None], "terrain": [0, 1], "light": ["night", "night"]}]
    two = rectangles([(0,), (1,)], [Sensor("light", categories=("day", "night"))])
    assert two == [{"light": ["day", "day"]}, {"light": ["night", "night"]}]


def test_site_of_two_lists_appears_once(two_lists, tmp_path):
    found = written(two_lists, tmp_path)["sites"]
    shared = two_lists.lists[0].taint_list.sites[1].id
    differences = [
        one.difference for compared in two_lists.lists for one in compared.slices if one.site.id == shared
    ]
    assert len(differences) == 2
    assert [site["difference"] for site in found if site["site"] == shared] == [
        pytest.approx(max(differences, key=abs))
    ]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, np.float64("nan")])
def test_numbers_that_are_not_finite_become_null(varied, bad, tmp_path):
    places = varied().culprits[0].site
    broken = varied(
        verdict=Verdict("degraded", bad, bad, bad, bad, 0.5),
        totals={"offline": (1.0, bad), "online": ()},
        culprits=(Culprit(places, bad, "sweep", (OperandEffect("5", None, bad, bad),)),),
    )
    found = written(broken, tmp_path)
    given = ("result", "p_drift", "p_loss", "loss", "detectable_loss")
    assert {found["verdict"][name] for name in given} == {"degraded", None}
    assert found["atr"] == dict.fromkeys(("offline", "online", "repaired", "nominal_repaired"))
    jsonschema.validate(found, schema())


def test_constant_that_follows_a_sensor_names_it(varied, tmp_path):
    one = varied().culprits[0]
    law = OperandEffect("KP", 4.0, -1.7, 2.5, what="KP follows light")
    edit = Edit("a.py", 3, "KP", -1.7, what="scale KP by light")
    found = written(
        varied(culprits=(replace(one, operands=(law,)),), repair=Repair(True, "", (edit,))), tmp_path
    )
    expected = {"code": "KP", "value": 4.0, "best": -1.7, "effect": 2.5, "what": "KP follows light"}
    assert found["culprits"][0]["operands"] == [expected]
    assert found["repair"]["edits"][0]["what"] == "scale KP by light"
    jsonschema.validate(found, schema())


def test_numpy_numbers_are_written_as_numbers(varied, tmp_path):
    verdict = Verdict("degraded", np.float64(0.25), np.float64(0.5), np.float32(1.5), np.float64(2), 0.5)
    assert written(varied(verdict=verdict), tmp_path)["verdict"]["loss"] == 1.5


def test_repair_is_null_without_a_search(varied, unrepaired, tmp_path):
    assert written(unrepaired, tmp_path)["repair"] is None
    refused = varied(repair=Repair(False, "", (), reason="budget"))
    assert written(refused, tmp_path)["repair"] == {
        "accepted": False,
        "guard": "",
        "patch": None,
        "edits": [],
        "tried": [],
    }


def test_each_attempt_is_listed_with_its_reason(varied, tmp_path):
    history = (
        Attempt("5 → 9 everywhere", "nominal gets worse", 7.5, 60, fresh=True),
        Attempt("5 → 11 everywhere", "", 9.8, 80, fresh=True),
        Attempt("5 → 2 everywhere", "cannot be written", math.nan, 0, fresh=False),
    )
    found = written(varied(repair=Repair(True, "", (), history=history)), tmp_path)
    jsonschema.validate(found, schema())
    tried = [(one["reason"], one["mean"], one["episodes"], one["fresh"]) for one in found["repair"]["tried"]]
    assert tried == [
        ("nominal gets worse", 7.5, 60, True),
        (None, 9.8, 80, True),
        ("cannot be written", None, 0, False),
    ]


def test_missing_counts_become_zero(shuttle):
    assert document(shuttle, {"online": 3})["episodes"] == {
        "offline": 0,
        "online": 3,
        "search": 0,
        "acceptance": 0,
    }


def test_same_comparison_gives_the_same_bytes(shuttle, tmp_path):
    path = tmp_path / "result.json"
    write(shuttle, path, EPISODES)
    first = path.read_bytes()
    write(shuttle, path, EPISODES)
    assert path.read_bytes() == first
    assert list(tmp_path.iterdir()) == [path]


def test_an_unwritable_path_is_reported_in_one_sentence(shuttle, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("not a directory")
    with pytest.raises(TarlError, match=r"The result .*result\.json cannot be written \("):
        write(shuttle, blocked / "result.json", EPISODES)


def test_world_bounds_have_their_method_and_quantile(varied, tmp_path):
    stated = Guarantee(
        episodes=200,
        passed=197,
        success=Bound(0.95, 1.0, 0.9, "Clopper-Pearson", True, 200),
        average=4.25,
        mean=Bound(3.5, math.inf, 0.8, "Student", False, 200),
        share=0.1,
        quantile=2.75,
        needed=29,
        varied=True,
    )
    found = written(varied(stated={"offline": stated, "elsewhere": stated}), tmp_path)
    jsonschema.validate(found, schema())
    assert found["bounds"] == {
        "offline": {
            "episodes": 200,
            "varied": True,
            "success": {
                "low": 0.95,
                "high": 1.0,
                "confidence": 0.9,
                "method": "Clopper-Pearson",
                "exact": True,
            },
            "mean": {"low": 3.5, "high": None, "confidence": 0.8, "method": "Student", "exact": False},
            "quantile": {"share": 0.1, "low": 2.75, "episodes": 29},
        },
        "repaired": None,
        "nominal_repaired": None,
    }


def test_each_formula_has_its_robustness_per_world(varied, tmp_path):
    worlds = {
        "online": FormulaWorld(-0.5, -1.25, 40, 7, 3.5),
        "offline": FormulaWorld(0.75, 0.25, 120, 0, None),
    }
    found = written(varied(formulas=(FormulaRow("always(x < 1)", worlds),)), tmp_path)
    jsonschema.validate(found, schema())
    assert found["formulas"] == [
        {
            "formula": "always(x < 1)",
            "worlds": {
                "offline": {
                    "robustness": 0.75, "least": 0.25, "episodes": 120, "violated": 0, "first_violation": None
                },
                "online": {
                    "robustness": -0.5, "least": -1.25, "episodes": 40, "violated": 7, "first_violation": 3.5
                },
                "repaired": None,
                "nominal_repaired": None,
            },
        }
    ]  # fmt: skip


def test_reward_of_each_range_interval_is_written(varied, tmp_path):
    sizes = {"mud": Sizes("mud", 0.0, 3.0, {"online": (0.5, 0.5, 2.5), "repaired": (2.5,)})}
    totals = {"offline": (9.0,), "online": (4.0, 2.0, 1.0), "repaired": (8.0,)}
    found = written(varied(sizes=sizes, totals=totals), tmp_path)
    jsonschema.validate(found, schema())
    assert found["sizes"] == [
        {"part": "mud", "low": 0.0, "high": 1.0, "online": 3.0, "repaired": None},
        {"part": "mud", "low": 1.0, "high": 2.0, "online": None, "repaired": None},
        {"part": "mud", "low": 2.0, "high": 3.0, "online": 1.0, "repaired": 8.0},
    ]


def test_partial_repair_is_written_without_its_diff(varied, tmp_path):
    partial = Partial("5 → 9 everywhere", 4.5, 3.25, 16.9, -0.5, -1.5, 0.9, "a diff", "a.partial.patch")
    found = written(varied(repair=Repair(False, "", (), partial=partial)), tmp_path)
    jsonschema.validate(found, schema())
    assert found["repair"]["partial"] == {
        "what": "5 → 9 everywhere",
        "patch": "a.partial.patch",
        "gain": 4.5,
        "low": 3.25,
        "designed": -0.5,
        "designed_low": -1.5,
    }


def test_success_and_the_reason_of_a_verdict_are_written(varied, tmp_path):
    verdict = Verdict(
        "degraded", 0.2, 0.3, 1.5, 0.4, 0.5, p_failures=0.01, success=(0.975, 0.5), because=("success",)
    )
    found = written(varied(verdict=verdict), tmp_path)["verdict"]
    assert (found["p_failures"], found["because"]) == (0.01, ["success"])
    assert found["success"] == {"offline": 0.975, "online": 0.5}


def test_situations_that_are_no_longer_visited_are_rectangles(shuttle, varied, tmp_path):
    left = varied(region=Region(shuttle.region.cells, left=((3, 0), (4, 0))))
    found = written(left, tmp_path)["no_longer_visited"]
    assert found == [{"x": [1.25, 2.083333333], "terrain": [0, 0]}]
