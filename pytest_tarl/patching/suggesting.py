"""Export a patch as a SARIF fix, as GitHub suggestions or as a review."""

from __future__ import annotations

import codecs
import io
import json
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

from pytest_tarl.patching.changes import FilePatch, Replacement
from pytest_tarl.patching.patch import BASE, SEAL
from pytest_tarl.patching.patch_reader import Patch

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
RULE = "tarl-repair"  # TARL001 to TARL999 are rules of tarl-lint
ROOT = "%SRCROOT%"  # GitHub resolves this to the top of the repository
_TOLD = ("designed", "drifted", "drifted and repaired", "designed and repaired")


def sarif(patch: Patch) -> str:
    """Return SARIF 2.1.0 with one result, whose fix is the patch."""
    rule = {
        "id": RULE,
        "name": "RepairFound",
        "shortDescription": {"text": "A change that restores the reward of the software in a drifted world"},
        "fullDescription": {
            "text": "Found by simulation and validated on held-out seeds, in the drifted and in the designed world."
        },
        "defaultConfiguration": {"level": "warning"},
    }
    driver = {"name": "tarl", "version": _version(patch), "rules": [rule]}
    changes = [_artifact_change(file, _encoding(patch, file)) for file in patch.files]
    result = {
        "ruleId": RULE,
        "ruleIndex": 0,
        "level": "warning",
        "message": {"text": _message(patch)},
        "locations": [_location(file, one) for file, one in _main(patch)],
        "partialFingerprints": {"tarlRepair/v1": " ".join(file.after for file in patch.files)},
        "fixes": [{"description": {"text": patch.title.partition(": ")[2]}, "artifactChanges": changes}],
    }
    base = {ROOT: {"description": {"text": "The base folder of the paths in the patch."}}}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "originalUriBaseIds": base,
        "results": [result],
    }
    return json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=1) + "\n"


def markdown(patch: Patch) -> str:
    """Return Markdown with the evidence, and a `suggestion` block for each change."""
    parts = [_evidence(patch)]
    for path, first, last, text in _suggestions(patch):
        lines = f"line {last}" if first == last else f"lines {first} to {last}"
        parts.append(f"`{path}`, {lines}:\n\n{_block(text)}")
    return "\n\n".join(parts) + "\n"


def review(patch: Patch) -> str:
    """Return a review for GitHub's REST API, with a comment for each change."""
    comments = [
        {
            "path": path,
            "side": "RIGHT",
            "line": last,
            **({"start_line": first, "start_side": "RIGHT"} if first < last else {}),
            "body": _block(text),
        }
        for path, first, last, text in _suggestions(patch)
    ]
    return json.dumps({"event": "COMMENT", "body": _evidence(patch), "comments": comments}, indent=1) + "\n"


def _message(patch: Patch) -> str:
    tests = " and ".join(patch.told("test"))
    drifts = " and ".join(dict.fromkeys(patch.told("drift")))
    figures = "; ".join(f"{key}: {value}" for key, value in patch.facts if key in _TOLD)
    return f"{tests} earns less than designed under the drift {drifts}. Reward {figures}."


def _evidence(patch: Patch) -> str:
    told = [f"- {key}: {_escaped(value)}" for key, value in patch.facts if key not in ("fixture", BASE, SEAL)]
    return "\n".join((f"**{_escaped(patch.title)}**", "", *told))


def _escaped(text: str) -> str:
    return re.sub(r"([\\`*_<>\[\]])", r"\\\1", text)


def _suggestions(patch: Patch) -> Iterator[tuple[str, int, int, str]]:
    """Yield (path, first line, last line, new text) for each change.

    Lines count from 1. A pure insertion is yielded as a replacement of a neighbouring line.
    """
    for file in patch.files:
        encoding = _encoding(patch, file)
        around = {hunk.start + at: line for hunk in file.hunks for at, line in enumerate(hunk.old)}
        for one in file.replacements:
            first, new, old = one.start, one.new, one.old
            if not old and first - 1 in around:
                first, old, new = first - 1, (around[first - 1],), (around[first - 1], *new)
            elif not old:
                old, new = (around[first],), (*new, around[first])
            text = b"".join(new).decode(encoding, "replace").replace("\r\n", "\n").removesuffix("\n")
            yield file.name, first + 1, first + len(old), text


def _block(text: str) -> str:
    """Return a `suggestion` block; its fence is longer than any fence in the text."""
    longest = max((len(found) for found in re.findall(r"`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return f"{fence}suggestion\n{text}\n{fence}"


def _artifact_change(file: FilePatch, encoding: str) -> dict[str, Any]:
    replacements = [
        {
            "deletedRegion": _region(one),
            "insertedContent": {"text": b"".join(one.new).decode(encoding, "replace")},
        }
        for one in file.replacements
    ]
    return {"artifactLocation": _artifact(file), "replacements": replacements}


def _region(one: Replacement) -> dict[str, int]:
    """Return the region of whole lines; for an insertion, the empty region before the line."""
    return {"startLine": one.start + 1, "startColumn": 1, "endLine": one.end + 1, "endColumn": 1}


def _artifact(file: FilePatch) -> dict[str, str]:
    return {"uri": quote(file.name), "uriBaseId": ROOT}


def _main(patch: Patch) -> list[tuple[FilePatch, Replacement]]:
    """Return the last change that removes lines."""
    taking = [(file, one) for file in patch.files for one in file.replacements if one.old]
    return (taking or [(file, one) for file in patch.files for one in file.replacements])[-1:]


def _location(file: FilePatch, one: Replacement) -> dict[str, Any]:
    return {"physicalLocation": {"artifactLocation": _artifact(file), "region": _region(one)}}


def _version(patch: Patch) -> str:
    return patch.title.partition(":")[0].rpartition(" ")[2]


def _encoding(patch: Patch, file: FilePatch) -> str:
    """Return the file's encoding; UTF-8 if the file is not available."""
    path = (patch.root or Path.cwd()) / (patch.base if patch.root else "") / file.name
    try:
        content = path.read_bytes() if path.is_file() else b""
        if content.startswith(codecs.BOM_UTF8):
            return "utf-8"
        encoding = tokenize.detect_encoding(io.BytesIO(content).readline)[0]
        b"".decode(encoding)
    except (OSError, SyntaxError, LookupError, ValueError):
        return "utf-8"
    return encoding
