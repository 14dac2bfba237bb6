"""Messages between a run and its workers: JSON, followed by the columns of a trace."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from pytest_tarl import errors
from pytest_tarl.errors import TarlError
from pytest_tarl.formulas.judging import Judged
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.rollout import EpisodePlan, EpisodeRun

COLUMNS = ("site", "flow", "event_cell", "event_step", "step_cell", "reward")
TOLD = (
    "passed", "failure", "broken", "topics", "crashed", "stuck", "values", "simulator", "outputs", "parameters",
    "silent",
)  # fmt: skip
LENGTH = struct.Struct("<Q")
READY = b"ready"
ALIVE = b""  # heartbeat, which shows that the worker's Python threads can run


def write(pipe: BinaryIO, message: bytes) -> None:
    """Send one message. Raise OSError if the other side has closed the pipe."""
    pipe.write(LENGTH.pack(len(message)))
    pipe.write(message)
    pipe.flush()


def read(pipe: BinaryIO) -> bytes | None:
    """Receive one message; return None if the pipe was closed."""
    head = pipe.read(LENGTH.size)
    if len(head) < LENGTH.size:
        return None
    (size,) = LENGTH.unpack(head)
    message = pipe.read(size)
    return message if len(message) == size else None


def plan_message(plan: EpisodePlan) -> bytes:
    """Encode a plan."""
    overlay = {str(path): text for path, text in plan.overlay.items()}
    head = {
        "seed": str(plan.seed),
        "drift": plan.drift,
        "overlay": overlay,
        "record": plan.record,
        "signed": plan.signed,
    }
    point = None if plan.point is None else dict(plan.point)
    return _joined({**head, "bag": str(plan.bag or ""), "point": point, "outputs": plan.outputs}, {})


def planned(message: bytes) -> EpisodePlan:
    """Decode a plan."""
    head, _ = _parted(message)
    overlay = {Path(path): text for path, text in head["overlay"].items()}
    bag = Path(head["bag"]) if head["bag"] else None
    given = (int(head["seed"]), head["drift"], overlay, head["record"], bag, head["point"])
    return EpisodePlan(*given, outputs=head["outputs"], signed=head["signed"])


def run_message(run: EpisodeRun) -> bytes:
    """Encode an episode's result, without its plan."""
    trace = run.trace
    arrays = {name: getattr(trace, name) for name in COLUMNS}
    arrays |= {f"part {name}": column for name, column in trace.parts.items()}
    if trace.thread is not None:
        arrays["thread"] = trace.thread
    head = {
        "cells": trace.cells,
        "passed": run.passed,
        "failure": run.failure,
        "broken": run.broken,
        "topics": dict(run.topics),
        "crashed": run.crashed,
        "stuck": run.stuck,
        "simulator": run.simulator,
        "outputs": {topic: tuple(sums) for topic, sums in run.outputs.items()},
        "parameters": dict(run.parameters),
        "silent": run.silent,
        "notes": run.notes,
        "lost": run.lost,
        "older": [str(path) for path in run.older],
        "values": dict(run.values),
        "judged": run.judged,
    }
    return _joined(head, arrays)


def answered(plan: EpisodePlan, message: bytes) -> EpisodeRun:
    """Decode an episode's result.

    If there is no result, raise the error that the worker reported: a TarlError, SkippedError or EndedError.
    """
    head, arrays = _parted(message)
    if "error" in head:
        raise _error(head["error"])(head["text"])
    parts = {name.removeprefix("part "): array for name, array in arrays.items() if name.startswith("part ")}
    trace = Trace(
        cells=tuple(tuple(cell) for cell in head["cells"]),
        **{name: arrays[name] for name in COLUMNS},
        parts=parts,
        thread=arrays.get("thread"),
    )
    told = {name: head[name] for name in TOLD} | {
        name: tuple(head.get(name, ())) for name in ("notes", "lost")
    }
    told["older"] = tuple(map(Path, head["older"]))
    told["judged"] = tuple(Judged(*one) for one in head["judged"])
    return EpisodeRun(plan=plan, trace=trace, **told)


def refused(message: bytes) -> None:
    """Raise the TarlError in a message."""
    head, _ = _parted(message)
    raise _error(head["error"])(head["text"])


def error_message(problem: TarlError) -> bytes:
    """Encode the error for which an episode could not run."""
    return _joined({"error": type(problem).__name__, "text": str(problem)}, {})


class SkippedError(TarlError):
    """The test skipped itself in a worker; the message is the reason."""


class EndedError(TarlError):
    """The test ended the whole run with `pytest.exit`; the message is the reason."""


def _error(name: str) -> Callable[[str], TarlError]:
    here = {"SkippedError": SkippedError, "EndedError": EndedError}
    found = here.get(name) or getattr(errors, name, TarlError)
    return found if isinstance(found, type) and issubclass(found, TarlError) else TarlError


def _joined(head: Mapping[str, Any], arrays: Mapping[str, np.ndarray[Any, Any]]) -> bytes:
    shapes = [(name, array.dtype.str, array.shape) for name, array in arrays.items()]
    text = json.dumps({**head, "arrays": shapes}, ensure_ascii=False).encode(errors="surrogatepass")
    return b"".join([LENGTH.pack(len(text)), text, *(array.tobytes() for array in arrays.values())])


def _parted(message: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray[Any, Any]]]:
    (size,) = LENGTH.unpack_from(message)
    start = LENGTH.size + size
    head = json.loads(message[LENGTH.size : start].decode(errors="surrogatepass"))
    arrays = {}
    for name, kind, shape in head.pop("arrays"):
        count = _product(shape)
        arrays[name] = np.frombuffer(message, np.dtype(kind), count, start).reshape(shape).copy()
        start += arrays[name].nbytes
    return head, arrays


def _product(shape: Sequence[int]) -> int:
    return int(np.prod(shape, dtype=np.int64))
