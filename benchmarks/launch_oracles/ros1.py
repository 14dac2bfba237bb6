"""The result of roslaunch for launch files: `python3 ros1.py < request > answer`, with Debian's python3-roslaunch.

Nothing is started. Commands of `<param command>` are not run. Missing files and packages are skipped, as in a
workspace with stub packages. Environment variables have `ENV_` and their name as value.
"""

import json
import os
import sys

import rospkg
import roslaunch.config
import roslaunch.loader
import roslaunch.substitution_args as substitution
import roslaunch.xmlloader

COMMAND = "<what a command prints>"


def patch(packages):
    """Make roslaunch find packages of the workspace and skip missing ones."""
    rospkg.RosPack.get_path = lambda self, name: packages.get(name, f"/absent/{name}")
    substitution._eval_env = lambda name: f"ENV_{name}"
    substitution._eval_anon = lambda id, anons: id
    loader, xml = roslaunch.loader.Loader, roslaunch.xmlloader.XmlLoader
    include, yaml, value = xml._include_tag, loader.load_rosparam, loader.param_value

    def _include(self, tag, context, *rest):
        name = self.resolve_args(tag.attributes["file"].value, context)
        return include(self, tag, context, *rest) if os.path.isfile(name) else None

    def _yaml(self, context, config, cmd, param, file_, *rest, **named):
        if file_ is None or os.path.isfile(file_):
            yaml(self, context, config, cmd, param, file_, *rest, **named)

    def _value(self, verbose, name, ptype, text, textfile, binfile, command):
        missing = textfile is not None and not os.path.isfile(textfile)
        if command is not None or binfile is not None or missing:
            return COMMAND
        return value(self, verbose, name, ptype, text, textfile, binfile, command)

    xml.ignore_unset_args = False  # roslaunch sets it in a function that the oracle does not use
    xml._include_tag = roslaunch.xmlloader.ifunless(_include)
    loader.load_rosparam, loader.param_value = _yaml, _value


def answer(path, arguments):
    """Return nodes and parameters of a launch file."""
    config = roslaunch.config.ROSLaunchConfig()
    argv = [path, *(f"{name}:={value}" for name, value in arguments.items())]
    roslaunch.xmlloader.XmlLoader().load(path, config, argv=argv, verbose=False)
    nodes = [
        [one.package, one.type, one.namespace, one.name, [list(pair) for pair in one.remap_args]]
        for one in config.nodes
    ]
    return {"nodes": nodes, "params": {name: one.value for name, one in config.params.items()}}


def main():
    request = json.load(sys.stdin)
    patch(request["packages"])
    answers = []
    for file in request["files"]:
        try:
            answers.append(answer(file["path"], file["arguments"]))
        except Exception as error:
            answers.append({"error": " ".join(str(error).split())[:300] or type(error).__name__})
    json.dump(answers, sys.stdout, default=str)


if __name__ == "__main__":
    main()
