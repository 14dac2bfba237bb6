"""Write the answer of `tarl fleet` as JSON (see `fleet.schema.json`)."""

from __future__ import annotations

import json
from dataclasses import asdict
from importlib import resources
from typing import Any

from pytest_tarl.fleet.changed_robots import Robot, lower
from pytest_tarl.fleet.decomposition import Decomposition
from pytest_tarl.fleet.mission_groups import Group
from pytest_tarl.fleet.question import Answer
from pytest_tarl.fleet.repairs import Effect
from pytest_tarl.model import Bound
from pytest_tarl.monitoring.status import Evidence
from pytest_tarl.report.json_result import finite

FORMAT = 1
EVIDENCE = ("world", "bound", "world_since", "bound_since")


def text(answer: Answer) -> str:
    """Return the document; numbers that are not finite become null."""
    return json.dumps(document(answer), ensure_ascii=False, indent=1, allow_nan=False) + "\n"


def schema() -> dict[str, Any]:
    """Return the JSON schema of the document."""
    found: dict[str, Any] = json.loads(
        resources.files(__package__).joinpath("fleet.schema.json").read_text("utf-8")
    )
    return found


def document(answer: Answer) -> dict[str, Any]:
    """Return the document. Evidence is the log2 of e-values; times are seconds since 1970."""
    question, found = answer.question, answer.robots
    return {
        "format": FORMAT,
        "test": answer.fixture.test,
        "missions": answer.missions,
        "copies": answer.copies,
        "by": list(question.by),
        "since": None if question.since is None else question.since.isoformat(),
        "robot": question.robot or None,
        "sensors": [sensor.name for sensor in answer.fixture.sensors],
        "groups": [
            _group(one, watched) for one, watched in zip(answer.groups, answer.onsets.every, strict=True)
        ],
        "groups_drifted": [one.name for one in answer.onsets.drifted],
        "groups_below": [one.name for one in answer.onsets.below],
        "false_discovery_rate": found.q,
        "drifted": [one.name for one in found.drifted],
        "below": [one.name for one in found.below],
        "robots": [_robot(one) for one in found.every],
        "clusters": [
            {
                "robots": list(one.robots),
                "cells": [list(cell) for cell in one.cells],
                "residuals": list(one.residuals),
            }
            for one in answer.clusters.found
        ],
        "unclear": list(answer.clusters.unclear),
        "repairs": [_repair(one, answer.accepted.get(one.repair)) for one in answer.repairs],
        "components": None if answer.parts is None else _components(answer.parts),
        "left_out": dict(answer.left_out),
        "lowest": [asdict(one) for one in answer.lowest],
    }


def _repair(one: Effect, accepted: str | None) -> dict[str, Any]:
    return {
        "repair": one.repair,
        "accepted_for": accepted,
        "values": list(one.values),
        "verdict": one.verdict,
        "missions": list(one.missions),
        "robots": list(one.robots),
        "strata": one.strata,
        "reward": finite(one.reward) if one.strata else None,
        "reward_bound": _bound(one.reward_bound),
        "success": finite(one.success) if one.strata else None,
        "success_bound": _bound(one.success_bound),
    }


def _components(parts: Decomposition) -> dict[str, Any]:
    levels = (*parts.levels, (), ())
    rows = [
        {
            "of": one.name,
            "variance": finite(one.variance),
            "low": finite(one.low),
            "high": finite(one.high),
            "levels": one.levels,
            "effects": dict(zip(names, one.effects, strict=True)),
        }
        for one, names in zip(parts.components, levels, strict=True)
    ]
    return {"season": parts.season, "confidence": parts.confidence, "rows": rows}


def _group(one: Group, watched: Robot) -> dict[str, Any]:
    verdict = one.verdict
    return {
        "values": list(one.values),
        "missions": one.missions,
        "robots": one.robots,
        "passed": one.passed,
        "reward": one.reward,
        "success": _bound(one.success),
        "mean": _bound(one.mean),
        "compared": one.compared,
        "result": None if verdict is None else verdict.result,
        "loss": None if verdict is None else verdict.loss,
        "p_loss": None if verdict is None else verdict.p_loss,
        "p_failures": None if verdict is None else verdict.p_failures,
        "because": [] if verdict is None else list(verdict.because),
        "p_drift": None if verdict is None else verdict.p_drift,
        "cells": [list(cell) for cell in one.region.cells],
        "new": [list(cell) for cell in one.region.novel],
        "evidence": {key: value for key, value in _robot(watched).items() if key in EVIDENCE},
        "formulas": [asdict(judged) for judged in one.formulas],
    }


def _bound(one: Bound) -> dict[str, Any]:
    ends = {"low": finite(one.low), "high": finite(one.high)}
    return ends | {"confidence": one.confidence, "method": one.method, "exact": one.exact}


def _robot(one: Robot) -> dict[str, Any]:
    found: dict[str, Any] = {
        "robot": one.name,
        "missions": one.missions,
        "passed": one.passed,
        "world": one.world,
        "bound": one.bound,
    }
    if one.status is not None:
        found["world_since"] = _since(one.status.world)
        found["bound_since"] = _since(lower(one.status))
        found["cells"] = [list(cell) for cell in one.status.cells]
        found["new"] = [list(cell) for cell in one.status.new]
    return found


def _since(evidence: Evidence | None) -> dict[str, Any] | None:
    if evidence is None or evidence.since is None:
        return None
    return {"mission": evidence.since.mission, "time": evidence.since.time}
