"""Compare the reports of TARL301 to TARL310 with faults that were put into written workspaces.

    python benchmarks/architecture_written.py [benchmarks/architecture_written/round1]... [--show]

Each workspace is one text file; each of its files follows a line `--- path`. A JSON file beside it, written before the
linter was run, lists the correct reports:

- `sown`: the faults put in on purpose, each with the rule that must report it and texts that the message must contain
- `also_true`: other correct reports
- `judged_true`: reports found to be correct after the run

All other reports count as false.
"""

from __future__ import annotations

import argparse
import json
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from written_texts import Texts

from tarl_lint.errors import UsageError
from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import ALL, Request, systems
from tarl_lint.system.hazards import hazards

FOLDER: Final = Path(__file__).with_suffix("")
Report = tuple[str, str]  # code of a rule, message


def main() -> int:
    """Print the figures for each workspace and folder."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folders", type=Path, nargs="*")
    parser.add_argument(
        "--show", action="store_true", help="print what was missed and what was reported wrongly"
    )
    options = parser.parse_args()
    for folder in options.folders or sorted(one for one in FOLDER.iterdir() if one.is_dir()):
        sown = found = false = reported = 0
        for truth_file in sorted(folder.glob("*.json")):
            truth = json.loads(truth_file.read_text("utf-8"))
            reports = list(_reports(truth_file.with_suffix(".txt")))
            missed = [one for one in truth["sown"] if not any(_fits(one, report) for report in reports)]
            wrong = list(_wrong(truth, reports))
            sown, found = sown + len(truth["sown"]), found + len(truth["sown"]) - len(missed)
            reported, false = reported + len(reports), false + len(wrong)
            print(f"{truth_file.stem}: {len(truth['sown'])} sown, {len(missed)} missed, {len(wrong)} false")
            if options.show:
                _show(missed, wrong)
        print(f"{folder.name}: {found} of {sown} found; {false} of {reported} reports false")
    return 0


def _wrong(truth: Mapping[str, Any], reports: Sequence[Report]) -> Iterator[Report]:
    """Yield the reports that the JSON file does not list as correct."""
    right = [one for name in ("sown", "also_true", "judged_true") for one in truth.get(name, [])]
    yield from (report for report in reports if not any(_fits(one, report) for one in right))


def _fits(fault: Mapping[str, Any], report: Report) -> bool:
    """Return whether a report has the fault's rule, and each of the fault's texts as a complete name."""
    code, message = report
    return fault["code"] == code and all(
        re.search(rf"(?<![\w/]){re.escape(text)}(?![\w/])", message) for text in fault["about"]
    )


def _show(missed: Sequence[Mapping[str, Any]], wrong: Sequence[Report]) -> None:
    for fault in missed:
        print(f"    missed {fault['code']} {' '.join(fault['about'])}")
    for code, message in wrong:
        print(f"    false  {code} {message}")


def _reports(workspace: Path) -> Iterator[Report]:
    """Analyse a workspace's launch files; yield each distinct report once."""
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        Texts.read(workspace).unpack(root)
        config = resolve(Options((root,), select=("TARL3",)))
        try:
            found = {(one.code, one.message) for system in systems(Request(ALL, (), (root,)), config)
                     for one in hazards(system, config)}  # fmt: skip
        except UsageError as problem:
            print(f"{workspace.name}: {problem}")
            return
    yield from sorted(found)


if __name__ == "__main__":
    raise SystemExit(main())
