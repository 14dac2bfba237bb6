"""Start the nodes of an episode: single files, and the nodes of launch files."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pytest_tarl.errors import SettingsError
from pytest_tarl.files import existing
from pytest_tarl.parameter_files import parameters_of

if TYPE_CHECKING:
    from pytest_tarl.instrumentation.importhook import NodeImports
    from pytest_tarl.parameter_files import Parameters
    from pytest_tarl.ros import Ros
    from pytest_tarl.ros.launch_plan import Launched
    from pytest_tarl.ros.stand_in import StandIn

    Replacement = Callable[[StandIn], object]


class Starter:
    """Start nodes in an episode's ROS, which the function `ros` returns."""

    def __init__(self, folder: Path, imports: NodeImports, ros: Callable[[], Ros]) -> None:
        self._folder = folder
        self._imports = imports
        self._ros = ros

    def start(
        self,
        script: str,
        name: str | None,
        argv: Sequence[str],
        parameters: Parameters | None,
        entry: str | None,
        launch: str | Literal[False] | None,
    ) -> None:
        """Start a file with the parameters of its launch file and, if `argv` is empty, with its arguments.

        Raise SettingsError if there is no such file, or parameters are invalid.
        """
        path = existing(self._folder, script)
        if path is None or not path.is_file():
            raise SettingsError(f"tarl.start: {script!r}: no such file in {self._folder}.")
        values = parameters_of(parameters, self._folder, "tarl.start")
        if isinstance(argv, str) or not all(isinstance(one, str) for one in argv):
            raise SettingsError(f"tarl.start: argv takes a list of strings, not {argv!r:.60}.")
        ros = self._ros()
        ros.use_definitions_around(path.parent, self._folder)
        ros.give(values)
        if launch is not False:
            from pytest_tarl.ros.launched import given

            file = None if launch is None else existing(self._folder, launch)
            if launch is not None and file is None:
                raise SettingsError(f"tarl.start: there is no launch file {self._folder / launch}.")
            got = given(path, file)
            ros.launch(got)
            argv = argv or got.argv
        ros.start(self._program(path, entry), name=name or path.stem, argv=argv)

    def launch(
        self,
        file: str,
        arguments: Mapping[str, Any],
        only: Sequence[str] | None,
        replaced: Mapping[str, Replacement],
        parameters: Parameters | None,
    ) -> None:
        """Call the functions that replace nodes of a launch file, then start its Python nodes in order."""
        from pytest_tarl.ros.launch_plan import launch_path, launch_plan, named
        from pytest_tarl.ros.stand_in import StandIn

        _check(only, arguments, replaced)
        values = parameters_of(parameters, self._folder, "tarl.launch")
        plan = launch_plan(launch_path(file, self._folder), arguments)
        chosen = plan.chosen(only, replaced)
        ros = self._ros()
        ros.use_definitions_around(plan.file.parent, self._folder)
        ros.give(values)
        if ros.scheduler.entering is None:
            ros.scheduler.entering = self._imports.separate().enter
        for note in (*plan.notes, *_left_out(plan.file, chosen, replaced)):
            ros.note(note)
        for one in chosen:
            if named(one, replaced):
                function = next(found for name, found in replaced.items() if named(one, [name]))
                function(StandIn(ros, one))
        for one in chosen:
            if one.path is not None and not named(one, replaced):
                ros.launch(replace(one.given, note=""))
                ros.start(self._program(one.path, one.entry), name=one.name, argv=one.argv)

    def _program(self, path: Path, entry: str | None) -> Callable[[], None]:
        imports = self._imports

        def program() -> None:
            imports.run(path, entry)

        return program


def _check(only: object, arguments: object, replaced: object) -> None:
    """Raise SettingsError if an argument of `tarl.launch` has the wrong type."""
    if isinstance(only, str):
        raise SettingsError(f'tarl.launch: only takes a list of node names, such as only=["{only}"].')
    for name, value in (("arguments", arguments), ("replace", replaced)):
        if not isinstance(value, Mapping):
            raise SettingsError(f"tarl.launch: {name} takes a mapping, not {value!r:.60}.")
    for node, function in replaced.items() if isinstance(replaced, Mapping) else ():
        if not callable(function):
            raise SettingsError(
                f"tarl.launch: replace takes a function for each node, but {node} has {function!r:.60}."
            )


def _left_out(file: Path, chosen: Sequence[Launched], replaced: Collection[str]) -> list[str]:
    """Return a note with the names of all nodes that are neither Python nor replaced."""
    from pytest_tarl.ros.launch_plan import named

    foreign = [one for one in chosen if one.path is None and not named(one, replaced)]
    if not foreign:
        return []
    told = "; ".join(f"{one.name} ({one.foreign})" for one in foreign)
    first = foreign[0].name.rpartition("/")[2]
    note = (
        f"{file.name} also starts nodes that did not run because they are not Python nodes of the workspace: {told}. "
        f'A function of the test can replace it: tarl.launch(…, replace={{"{first}": function}}).'
    )
    return [note]


def node_files(nodes: Sequence[str], folder: Path, where: str) -> tuple[str, ...]:
    """Return a marker's node files, with each launch file replaced by the Python programs that it starts.

    Raise SettingsError, with a message that begins with `where`, if a launch file is unknown or has no Python nodes.
    """
    from tarl_lint.workspace.launch_lookup import is_launch_name

    if not any(map(is_launch_name, nodes)):
        return tuple(nodes)
    from pytest_tarl.ros.launch_plan import launch_path, launch_plan, programs

    files: dict[str, None] = {}
    for node in nodes:
        if not is_launch_name(node):
            files[node] = None
            continue
        found = programs(launch_plan(launch_path(node, folder, f"{where}: nodes"), {}))
        if not found:
            raise SettingsError(
                f"{where}: the launch file {node} in nodes starts no Python node of the workspace."
            )
        files.update((os.path.relpath(path, folder), None) for path in found)
    return tuple(files)
