"""Compare how TARL reads launch files, without executing anything, with the results of roslaunch and launch.

    python benchmarks/launch_files.py FOLDER... --ros1 PYTHON[:PATH] --ros2 PYTHON[:PATH...] [--show N]

Each FOLDER has checkouts, one folder per repository. `--ros1` is an interpreter with Debian's python3-roslaunch;
`--ros2` one with the sources of launch, launch_xml, launch_yaml and launch_ros. Use both in a disposable environment,
because they execute launch files. Arguments without a default get the value `true`. The figures are the shares of nodes
(package, program, namespace, name), remappings and parameters on which both agree. Outputs of commands, files outside
the checkout, and launch files that roslaunch or launch rejects are counted separately.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml

from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.launch_read import is_ros2_xml, read_launch
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.name_resolution import joined
from tarl_lint.workspace.parameter_yaml import of_node
from tarl_lint.workspace.read import read
from tarl_lint.workspace.ros_arguments import ros1, ros2

ORACLES = Path(__file__).parent / "launch_oracles"
COMMAND = "<what a command prints>"
Fact = tuple[str, ...]  # kind and values
_ENVIRONMENT = re.compile(r"\$\(env (\w+)\)")
# values that roslaunch and launch cannot know either
_ROBOT = re.compile(r"ENV_\w|/absent/|/nonexistent")


def main() -> None:
    """Print a table, and the differences."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--ros1")
    parser.add_argument("--ros2")
    parser.add_argument("--show", type=int, default=0)
    typed = parser.parse_args()
    total: Counter[str] = Counter()
    for repository in sorted(one for folder in typed.folders for one in folder.iterdir() if one.is_dir()):
        workspace = read(repository)
        files = [file for package in workspace.packages for file in package.launch_files]
        two = [file for file in files if _is_ros2(file, workspace)]
        counts: Counter[str] = Counter()
        for files_of, python, name in (
            ([f for f in files if f not in two], typed.ros1, "ros1"),
            (two, typed.ros2, "ros2"),
        ):
            if files_of and python:
                counts += _compared(workspace, files_of, python, name, typed.show)
        if counts["files"]:
            print(f"{repository.name:45} {_row(counts)}")
            total += counts
    print(f"{'all':45} {_row(total)}")


def _row(counts: Mapping[str, int]) -> str:
    parts = [f"{counts['files']:4} files ({counts['refused']} refused)"]
    for kind in ("node", "remap", "param"):
        right, every = counts[f"{kind} right"], counts[f"{kind} all"]
        parts.append(f"{kind}s {right}/{every}" + (f" ({100 * right / every:.1f} %)" if every else ""))
    return "  ".join([*parts, f"{counts['robot']} known on the robot only"])


def _is_ros2(file: Path, workspace: Workspace) -> bool:
    return file.suffix in (".py", ".yaml", ".yml") or is_ros2_xml(file, workspace)


def _compared(workspace: Workspace, files: Sequence[Path], python: str, name: str, show: int) -> Counter[str]:
    requests: list[dict[str, Any]] = [{"path": str(file), "arguments": _required(file)} for file in files]
    answers = _asked(workspace, requests, python, name)
    counts: Counter[str] = Counter()
    for file, request, theirs in zip(files, requests, answers, strict=True):
        counts["files"] += 1
        if "error" in theirs:
            counts["refused"] += 1
            if show:
                print(f"    refused {file}: {theirs['error']}")
            continue
        asked: dict[str, str] = request["arguments"]
        arguments = {**asked, **theirs.get("arguments", {})}
        launch = read_launch(file, workspace, arguments)
        ours = set(_of_launch(launch, name == "ros2"))
        others = set(_of_answer(theirs, name == "ros2"))
        robots = {fact[:-1] for fact in others if fact[0] == "param" and _ROBOT.search(fact[-1])}
        counts["robot"] += len(robots)
        wrong = {
            fact
            for fact in ours
            if fact[:-1] in robots and not _ROBOT.search(fact[-1]) and "$(" not in fact[-1]
        }
        ours = {fact for fact in ours if fact[:-1] not in robots} | wrong
        others = {fact for fact in others if fact[:-1] not in robots}
        # a module that is not installed sets some of these parameters
        vague = {key[:-1] for key in robots if key[-1] == "*"}
        ours = {fact for fact in ours if fact in others or fact[0] != "param" or fact[:-2] not in vague}
        for fact in ours | others:
            counts[f"{fact[0]} all"] += 1
            counts[f"{fact[0]} right"] += fact in ours and fact in others
        for fact in sorted(ours ^ others)[:show]:
            print(f"    {'only we' if fact in ours else 'only they'} {file}: {fact}")
    return counts


def _required(file: Path) -> dict[str, str]:
    """Return a value for each argument without a default."""
    if file.suffix in (".py", ".yaml", ".yml"):
        return {}
    try:
        root = ElementTree.fromstring(file.read_bytes())  # noqa: S314 - the originals read it, too
    except ElementTree.ParseError:
        return {}
    return {
        one.attrib["name"]: "true"
        for one in root.iter("arg")
        if one in list(root) and not {"value", "default"} & one.attrib.keys() and "name" in one.attrib
    }


def _asked(workspace: Workspace, files: Sequence[Any], python: str, name: str) -> list[dict[str, Any]]:
    interpreter, *paths = python.split(":")
    request = {"packages": {one.name: str(one.folder) for one in workspace.packages}, "files": files}
    made = subprocess.run(
        [interpreter, str(ORACLES / f"{name}.py")],
        input=json.dumps(request),
        capture_output=True,
        text=True,
        env={"PATH": os.environ["PATH"], "PYTHONPATH": ":".join(paths), "HOME": "/nonexistent"},
        timeout=600,
        check=False,
    )
    if made.returncode:
        raise SystemExit(f"{name}: {made.stderr[-2000:]}")
    answers: list[dict[str, Any]] = json.loads(made.stdout)
    return answers


def _of_answer(answer: Mapping[str, Any], two: bool) -> Iterator[Fact]:
    for package, executable, namespace, name, remaps, *more in answer["nodes"]:
        node = _node(package, executable, namespace, name)
        yield ("node", *node)
        for old, new in dict(
            reversed(remaps) if two else remaps
        ).items():  # in ROS 2, a name's first remapping wins
            yield ("remap", *node, _plain(old), _plain(new))
        for key, value in (more[0] if more else {}).items():
            yield ("param", *node, key, _value(value))
    for name, value in answer.get("params", {}).items():
        if value != COMMAND:
            yield ("param", name, _value(value))


def _of_launch(launch: Launch, two: bool) -> Iterator[Fact]:
    parameters: dict[str, Any] = {}
    for setting in launch.settings:
        if setting.unknown and setting.value is None and setting.yaml is None:
            continue  # known only on the robot, so roslaunch does not have it either
        parameters.update(_flat(setting.name, _content(setting)))
    for node in launch.nodes:
        name = _node(node.package, node.executable, node.namespace, node.name)
        # settings in the node's arguments, which roslaunch and launch merely pass on
        given = (ros2 if two else ros1)(node.arguments)
        pairs = _without(node.remaps, given.remaps)
        if (
            node.kind != "test"
            # roslaunch and launch do not count tests as nodes, but list their parameters with the others
        ):
            yield ("node", *(_of_environment(one) for one in name))
            for old, new in {_plain(old): _plain(new) for old, new in pairs}.items():
                yield ("remap", *name, old, new)
        if two:
            for key, value in _of_ros2(node).items():
                yield ("param", *name, key, _value(value))
        else:
            above = joined(node.namespace, node.name)
            for setting in _known(node):
                parameters.update(_flat(joined(above, setting.name.lstrip("~")), _content(setting)))
    for key, value in parameters.items():
        yield ("param", _of_environment(key), _of_environment(_value(value)))


def _without(pairs: Sequence[tuple[str, str]], left: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Remove each pair of `left` once, and return the remaining pairs."""
    out = Counter(left)
    kept = []
    for pair in pairs:
        out[pair] -= 1
        kept += [pair] if out[pair] < 0 else []
    return kept


def _known(node: LaunchedNode) -> list[Setting]:
    given = {*ros1(node.arguments).parameters, *ros2(node.arguments).parameters}
    return [one for one in node.settings if not one.unknown and (one.name, one.yaml) not in given]


def _of_ros2(node: LaunchedNode) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for setting in _known(node):
        content = _content(setting)
        if setting.name != "~":
            found[setting.name.lstrip("~")] = content
        elif isinstance(content, dict) and node.kind == "component":  # launch selects the node's sections
            name = joined(node.namespace, node.name)
            found.update(
                {key: value for key, value in of_node(content, name).items() if key != "ros__parameters"}
            )
        elif isinstance(content, dict):
            for part in content.values():
                if isinstance(part, dict):
                    found.update(_dotted(part.get("ros__parameters") or {}))
    return found


def _dotted(values: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in values.items():
        found.update(
            _dotted(value, f"{above}{key}.") if isinstance(value, dict) else {f"{above}{key}": value}
        )
    return found


def _content(setting: Setting) -> Any:
    if setting.yaml is None:
        return setting.value
    try:
        content = yaml.safe_load(setting.yaml)
        return {} if content is None else content
    except yaml.YAMLError:
        return setting.yaml


def _flat(name: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        return {} if value is None and name == "/" else {name: value}
    found: dict[str, Any] = {}
    for key, one in value.items():
        found.update(_flat(joined(name, str(key)), one))
    return found


def _node(package: str, executable: str, namespace: str | None, name: str) -> Fact:
    name = "" if name == "<node_name_unspecified>" else name
    namespace = "" if namespace in (None, "<node_namespace_unspecified>") else namespace
    return package, executable, joined("/", namespace or ""), name


def _plain(name: str) -> str:
    while "//" in name:
        name = name.replace("//", "/")
    return _of_environment(name.rstrip("/") if len(name) > 1 else name)


def _of_environment(text: str) -> str:
    return _ENVIRONMENT.sub(r"ENV_\1", text)


def _value(value: Any) -> str:
    return json.dumps(value, sort_keys=True, default=str)


if __name__ == "__main__":
    main()
