"""A test module that imports ROS where it is not installed gets advice with the error."""

from __future__ import annotations

import importlib.util

import pytest

bare = pytest.mark.skipif(importlib.util.find_spec("nav_msgs") is not None, reason="a ROS is installed here")


@bare
@pytest.mark.parametrize(
    ("line", "advice"),
    [
        ("from nav_msgs.msg import Odometry", "*message_type('nav_msgs/msg/TYPE'), from pytest_tarl.ros*"),
        ("import rospy", "*start it by tarl.start*"),
        ("from rclpy.node import Node", "*start it by tarl.start*"),
    ],
)
def test_a_failed_import_of_ros_comes_with_a_hint(tank: pytest.Pytester, line: str, advice: str) -> None:
    tank.makepyfile(test_top=f"{line}\n\ndef test_it():\n    pass\n")
    told = tank.runpytest("test_top.py")
    told.assert_outcomes(errors=1)
    told.stdout.fnmatch_lines(["*ModuleNotFoundError*", "*- TARL -*", advice])


@pytest.mark.parametrize("line", ["import colour_of_magic", "1 / 0", "raise ImportError('no')"])
def test_foreign_import_errors_get_no_hint(tank: pytest.Pytester, line: str) -> None:
    tank.makepyfile(test_top=f"{line}\n")
    told = tank.runpytest("test_top.py")
    told.assert_outcomes(errors=1)
    told.stdout.no_fnmatch_line("*TARL*")


def test_package_test_that_imports_ros_should_move(
    tank: pytest.Pytester,
) -> None:
    package = tank.mkpydir("robot")
    (package / "__init__.py").write_text("from .driver import Driver\n")
    (package / "driver.py").write_text("import rospy\nclass Driver:\n    pass\n")
    tests = package / "tests"
    tests.mkdir()
    (tests / "test_driver.py").write_text(
        "import pytest\n@pytest.mark.tarl(nodes=['../driver.py'])\ndef test_driver(tarl):\n    pass\n"
    )
    result = tank.runpytest(str(tests))
    result.stdout.fnmatch_lines(
        ["*whose __init__.py imports ROS*move the test to a folder outside the package*"]
    )


def test_advice_appears_after_a_second_import(
    tank: pytest.Pytester,
) -> None:
    package = tank.mkpydir("robot")
    (package / "__init__.py").write_text(
        "try:\n    import rospy\nexcept ImportError:\n    import no_such_driver\n"
    )
    tests = package / "tests"
    tests.mkdir()
    (tests / "test_driver.py").write_text(
        "import pytest\n@pytest.mark.tarl(nodes=['../driver.py'])\ndef test_driver(tarl):\n    pass\n"
    )
    result = tank.runpytest(str(tests))
    result.stdout.fnmatch_lines(["*whose __init__.py imports ROS*"])


def test_unrelated_package_error_gets_no_ros_advice(tank: pytest.Pytester) -> None:
    package = tank.mkpydir("robot")
    (package / "__init__.py").write_text("import no_such_driver\n")
    tests = package / "tests"
    tests.mkdir()
    (tests / "test_driver.py").write_text(
        "import pytest\n@pytest.mark.tarl(nodes=['../driver.py'])\ndef test_driver(tarl):\n    pass\n"
    )
    result = tank.runpytest(str(tests))
    result.stdout.fnmatch_lines(["*No module named 'no_such_driver'*"])
    result.stdout.no_fnmatch_line("*imports ROS*")
