"""Installed packages named in the settings are analysed as files, never imported or run."""

from textwrap import dedent

import pytest

from tarl_lint.errors import ConfigError
from tarl_lint.read.installed import search_path
from tarl_lint.report import render
from tarl_lint.report.line import View, plain
from tarl_lint.run.runner import run
from tarl_lint.settings.config import Options, resolve

NODE = """
    from rclpy.node import Node
    from std_msgs.msg import Float64
    open("ran", "w")

    class BaseNode(Node):
        def __init__(self, name):
            super().__init__(name)
            self._out = self.create_publisher(Float64, "out", 1)
            self._own = self.create_publisher(Float64, "own", 1)
            self.create_subscription(Float64, "own_in", self._pass_on, 1)

        def _pass_on(self, msg):
            self._own.publish(msg)

        def hear(self, topic, function):
            self.create_subscription(Float64, topic, function, 1)

        def send(self, value):
            self._out.publish(Float64(data=value))
    """
DRIVER = """
    import rclpy
    from std_msgs.msg import Float64
    from robot_base import BaseNode

    class Driver(BaseNode):
        def __init__(self):
            super().__init__("driver")
            self.create_subscription(Float64, "speed", self.on_speed, 1)
            self.hear("wish", self.on_speed)

        def on_speed(self, msg):
            self.send(2.0 * msg.data)

    rclpy.init()
    rclpy.spin(Driver())
    """


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    """Return a directory with a node and a virtual environment that contains its base class."""
    monkeypatch.chdir(tmp_path)
    site = tmp_path / ".venv/lib/python3.11/site-packages"
    package, info = site / "robot_base", site / "robot_base-1.4.0.dist-info"
    package.mkdir(parents=True)
    info.mkdir()
    (tmp_path / ".venv/pyvenv.cfg").write_text("home = /nowhere/bin\ninclude-system-site-packages = false\n")
    (package / "__init__.py").write_text("from .node import BaseNode\n")
    (package / "node.py").write_text(dedent(NODE))
    (package / "unused.py").write_text("def broken(:\n")
    (package / "fast.so").write_bytes(b"\x7fELF")
    (info / "METADATA").write_text("Name: robot-base\nVersion: 1.4.0\n")
    (info / "RECORD").write_text("robot_base/__init__.py,,\n")
    (tmp_path / "driver.py").write_text(dedent(DRIVER))
    (tmp_path / "pyproject.toml").write_text(
        '[tool.tarl-lint]\nfollow-installed = ["robot_base"]\npython = ".venv"\n'
    )
    return tmp_path


def linted(workspace):
    options = Options(paths=(workspace / "driver.py",), cache=False)
    return run(options, resolve(options))


def pairs(result):
    return {(f.flow.source.topics, f.flow.sink.topics) for f in result.findings if f.flow}


def said(result):
    return "\n".join(plain(line) for line in render("text", result, View()))


def test_flows_pass_through_an_installed_base_class(workspace):
    result = linted(workspace)
    assert pairs(result) == {(("speed",), ("out",)), (("wish",), ("out",))}
    assert "Followed into installed packages: robot_base 1.4.0." in said(result)
    assert result.statistics.files == 1
    assert not result.errors
    assert not (workspace / "ran").exists()


def test_without_the_setting_an_installed_base_class_is_not_followed(workspace):
    (workspace / "pyproject.toml").write_text("[tool.tarl-lint]\n")
    result = linted(workspace)
    assert pairs(result) == set()
    assert (
        'classes outside the linted files, robot_base.BaseNode (follow-installed = ["robot_base"])'
        in said(result)
    )


def test_editable_installs_are_found_without_running_pth_code(workspace):
    site = workspace / ".venv/lib/python3.11/site-packages"
    moved = workspace / "elsewhere"
    moved.mkdir()
    (site / "robot_base").rename(moved / "robot_base")
    (site / "__editable__.robot_base.pth").write_text(
        f"import os; open('ran', 'w')\n{moved}\n# a remark\nno/such/place\n"
    )
    assert pairs(linted(workspace)) == {(("speed",), ("out",)), (("wish",), ("out",))}
    assert not (workspace / "ran").exists()


def test_a_change_in_the_package_invalidates_the_cache(workspace):
    options = Options(paths=(workspace / "driver.py",))
    assert len(pairs(run(options, resolve(options)))) == 2
    node = workspace / ".venv/lib/python3.11/site-packages/robot_base/node.py"
    node.write_text(node.read_text().replace("data=value", "data=0.0"))
    assert pairs(run(options, resolve(options))) == set()


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            'python = ".vnv"',
            r"'python' is \.vnv, which is not a virtual environment: it contains no pyvenv.cfg",
        ),
        ("", r"'follow-installed' needs 'python'"),
    ],
)
def test_a_directory_that_is_not_an_environment_is_refused(workspace, settings, message):
    (workspace / "pyproject.toml").write_text(
        f'[tool.tarl-lint]\nfollow-installed = ["robot_base"]\n{settings}\n'
    )
    with pytest.raises(ConfigError, match=message):
        linted(workspace)


@pytest.mark.parametrize("name", ['"robot.base"', "3", '"-x"'])
def test_an_invalid_package_name_is_refused(workspace, name):
    (workspace / "pyproject.toml").write_text(f"[tool.tarl-lint]\nfollow-installed = [{name}]\n")
    with pytest.raises(ConfigError, match="must be a list of packages that are installed"):
        linted(workspace)


def test_a_missing_package_is_named_and_the_run_continues(workspace):
    settings = workspace / "pyproject.toml"
    settings.write_text(settings.read_text().replace('["robot_base"]', '["robot_base", "gone"]'))
    result = linted(workspace)
    assert len(pairs(result)) == 2
    assert "'follow-installed' names 'gone', but .venv contains no Python source" in said(result)


def test_system_packages_count_only_in_such_an_environment(tmp_path):
    system = tmp_path / "usr/lib/python3.11/site-packages"
    system.mkdir(parents=True)
    home = tmp_path / "env"
    own = home / "lib/python3.11/site-packages"
    own.mkdir(parents=True)
    for said_so, expected in (("true", [own, system]), ("false", [own])):
        (home / "pyvenv.cfg").write_text(
            f"home = {tmp_path}/usr/bin\ninclude-system-site-packages = {said_so}\n"
        )
        assert search_path(home) == expected
