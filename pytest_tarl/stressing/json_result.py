"""Write the result of a stress test for other tools: a versioned JSON document, specified by `stress.schema.json`."""

from __future__ import annotations

import json
from dataclasses import asdict
from importlib import resources
from typing import Any

from pytest_tarl.spaces import Choice, value_of
from pytest_tarl.stressing.findings import CONFIDENCE, Curve, Failure, Sobol, Stress
from pytest_tarl.stressing.words import broken_promises, point_values

# Versions: 1, first version; 2, confidence of the boundary and values shown to hold; 3, Sobol indices, statements,
# repairs and seconds; 4, drifts that are expected to fail.
FORMAT_VERSION = 4
ENDS = {"": "complete", "budget": "budget", "interrupted": "interrupted", "nominal": "nominal fails"}


def text(stress: Stress) -> str:
    """Return the document as JSON."""
    return f"{json.dumps(document(stress), indent=1, ensure_ascii=False, allow_nan=False, default=repr)}\n"


def schema() -> dict[str, Any]:
    """Return the JSON schema of the document."""
    found: dict[str, Any] = json.loads(
        resources.files(__package__).joinpath("stress.schema.json").read_text("utf-8")
    )
    return found


def document(stress: Stress) -> dict[str, Any]:
    """Return the result as JSON-compatible values."""
    given = stress.guarantee
    return {
        "format": FORMAT_VERSION,
        "test": stress.test,
        "drift": stress.drift,
        "seed": stress.seed,
        "episodes": stress.episodes,
        "budget": stress.budget if stress.seconds is None else None,
        "seconds": stress.seconds,
        "ended": ENDS[stress.ended],
        "guarantee": {"success": given.rate, "loss": given.tolerance},
        "directions": [_direction(stress, curve) for curve in stress.curves],
        "failures": [_failure(stress, one) for one in stress.every_failure],
        "expected_failures": [_failure(stress, one) for one in stress.expected],
        "combinations_tried": stress.tried,
        "statements": None if stress.statements is None else asdict(stress.statements),
        "sobol": _sobol(stress.sobol),
        "repairs": None if stress.repairs is None else [asdict(one) for one in stress.repairs],
        "broken_promises": broken_promises(stress),
    }


def _direction(stress: Stress, curve: Curve) -> dict[str, Any]:
    """Return the result along one ray."""
    name = curve.ray.names[0]
    extent = stress.space.extents[name]

    def value(t: float) -> Any:
        return value_of(extent, curve.ray.value(t))

    found = curve.boundary
    return {
        "name": name,
        "kind": "choice" if isinstance(extent, Choice) else "range",
        "nominal": value(0.0),
        "farthest": value(1.0),
        "boundary": None
        if found is None
        else {
            "estimate": value(found.at),
            "held_up_to": None if found.near is None else value(found.near),
            "failed_at": value(found.far),
            "confidence": CONFIDENCE,
            "monotone": found.monotone,
        },
        "held_up_to": None if curve.held is None else value(curve.held),
        "suspicious": found is None and bool(curve.failing),
        "margins": [
            {
                "value": value(t),
                "margin": one.margin,
                "result": one.result,
                "episodes": one.episodes,
                "passed": one.passed,
                "loss": one.loss,
            }
            for t, one in sorted(curve.evidence.items())
        ],
    }


def _sobol(found: Sobol | None) -> dict[str, Any] | None:
    if found is None:
        return None
    shares = [asdict(one) for one in found.shares]
    return {"episodes": found.episodes, "confidence": CONFIDENCE, "directions": shares}


def _failure(stress: Stress, one: Failure) -> dict[str, Any]:
    return {
        "drift": point_values(stress, one.point),
        "distance": one.distance,
        "directions": list(one.names),
    }
