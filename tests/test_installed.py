"""The wheel in new environments: with the linter only, with pytest only, and with all requirements of the plugin."""

import os
import subprocess
import sys
import venv
import zipfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SENTENCE = 'needs greenlet, libcst and numpy, which are not installed: run pip install "tarl[pytest]".'
PYTEST = (
    "_pytest",
    "py",
    "pytest",
    "pluggy",
    "iniconfig",
    "packaging",
    "pygments",
    "exceptiongroup",
    "typing_extensions",
)
NODE = """
import rospy
from std_msgs.msg import Float64

out = rospy.Publisher("/out", Float64, queue_size=1)


def heard(message):
    out.publish(2 * message.data)


rospy.init_node("twice")
rospy.Subscriber("/in", Float64, heard)
rospy.spin()
"""
PLAIN = "def test_sum():\n    assert 1 + 1 == 2\n"
MARKED = """
import pytest

@pytest.mark.tarl(nodes=["node.py"], sensors=[])
def test_node(tarl):
    tarl.start("node.py")
"""
WITH_SENSOR = MARKED.replace(
    "[])", '[Sensor("x", topic="/in", field="data", low=0, high=1, bins=4)])'
).replace("import pytest", "import pytest\nfrom pytest_tarl import Sensor")

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)],
        check=True,
        capture_output=True,
    )
    (built,) = folder.glob("*.whl")
    return built


def environment(folder: Path, wheel: Path, beside: Path) -> Path:
    """Make an environment that holds what is in the wheel and in a folder beside it; return its Python."""
    venv.create(folder, with_pip=False, symlinks=os.name != "nt")
    (site,) = folder.rglob("site-packages")
    with zipfile.ZipFile(wheel) as opened:
        opened.extractall(site)
    (site / "beside.pth").write_text(f"{beside}\n")
    return folder / ("Scripts" if os.name == "nt" else "bin") / "python"


def runner(python: Path) -> Run:
    """Return the command that runs a module of an environment without the settings of this run."""

    def run(module: str, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
        command = [str(python), "-m", module, *arguments]
        ours = ("PYTEST", "PYTHON", "COV")
        clean = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
        return subprocess.run(command, cwd=cwd, env=clean, capture_output=True, text=True, check=False)

    return run


def linked(folder: Path, names: tuple[str, ...]) -> Path:
    """Return a folder that holds these packages of the running environment and no others."""
    folder.mkdir()
    for name in names:
        spec = find_spec(name)
        if spec is not None and spec.origin is not None:
            origin = Path(spec.origin)
            source = origin.parent if origin.name == "__init__.py" else origin
            (folder / source.name).symlink_to(source)
            for about in origin.parents[1].glob(f"{name}-*.dist-info"):
                (folder / about.name).symlink_to(about)
    return folder


@pytest.fixture(scope="session")
def alone(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("alone")
    return runner(environment(folder / "env", wheel, linked(folder / "beside", ("tomli",))))


@pytest.fixture(scope="session")
def beside_pytest(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("pytest_only")
    return runner(environment(folder / "env", wheel, linked(folder / "beside", (*PYTEST, "tomli"))))


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "node.py").write_text(NODE)
    (tmp_path / "test_plain.py").write_text(PLAIN)
    (tmp_path / "test_node.py").write_text(MARKED)
    return tmp_path


def test_twine_accepts_the_wheel(wheel: Path) -> None:
    checked = subprocess.run(
        [sys.executable, "-m", "twine", "check", "--strict", str(wheel)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_the_base_install_is_below_ten_megabytes(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as opened:
        assert sum(member.file_size for member in opened.infolist()) < 10e6
        metadata = next(name for name in opened.namelist() if name.endswith("METADATA"))
        needs = [
            line for line in opened.read(metadata).decode().splitlines() if line.startswith("Requires-Dist")
        ]
    assert [need for need in needs if "extra ==" not in need] == [
        "Requires-Dist: tomli>=2.0; python_version < '3.11'"
    ]


def test_pip_installs_the_commands(wheel: Path, tmp_path: Path) -> None:
    python = environment(tmp_path / "env", wheel, linked(tmp_path / "beside", ("tomli",)))
    install = (
        "-m",
        "pip",
        "--python",
        str(python),
        "install",
        "-q",
        "--no-deps",
        "--no-index",
        "--force-reinstall",
    )
    subprocess.run([sys.executable, *install, str(wheel)], check=True, capture_output=True)
    for command in ("tarl-lint", "tarl"):
        said = subprocess.run(
            [python.parent / command, "--version"], capture_output=True, text=True, check=True
        )
        assert said.stdout.startswith(command)


def test_the_linter_runs_without_the_extras_in_plain_text(
    alone: Run, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    ended = alone("tarl_lint", "node.py", cwd=project)
    assert ended.returncode == 1, ended.stderr
    assert "/in" in ended.stdout
    assert "/out" in ended.stdout
    assert "\x1b" not in ended.stdout


@pytest.mark.parametrize(
    ("command", "arguments"),
    [("show", ["f.npz"]), ("diff", ["a.npz", "b.npz"]), ("apply", ["p.diff"]), ("observe", ["node.py"])],
)
def test_a_command_names_the_missing_extra(
    alone: Run, project: Path, command: str, arguments: list[str]
) -> None:
    ended = alone("pytest_tarl", command, *arguments, cwd=project)
    assert ended.returncode == 2
    assert ended.stderr == (
        f"tarl: tarl {command} needs greenlet, libcst, numpy and pytest, which are not installed: "
        'run pip install "tarl[pytest]".\n'
    )
    assert alone("pytest_tarl", command, "--help", cwd=project).returncode == 0


def test_the_server_names_its_missing_extra(alone: Run, project: Path) -> None:
    ended = alone("pytest_tarl", "lsp", cwd=project)
    assert ended.returncode == 2
    assert (
        ended.stderr == 'tarl: tarl lsp needs pygls, which is not installed: run pip install "tarl[lsp]".\n'
    )


def test_other_pytest_runs_are_not_affected(beside_pytest: Run, project: Path) -> None:
    (project / "test_broken.py").write_text("import no_such_package\n")
    ended = beside_pytest("pytest", "-q", "test_plain.py", cwd=project)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    ended = beside_pytest("pytest", "-q", "test_broken.py", cwd=project)
    assert ended.returncode == 2
    assert "No module named 'no_such_package'" in ended.stdout
    assert "numpy" not in ended.stdout


def test_flags_marker_and_fixtures_are_registered_without_the_extra(
    beside_pytest: Run, project: Path
) -> None:
    assert "--tarl-record" in beside_pytest("pytest", "--help", cwd=project).stdout
    assert "@pytest.mark.tarl(nodes, sensors" in beside_pytest("pytest", "--markers", cwd=project).stdout
    assert "tarl_drift" in beside_pytest("pytest", "--fixtures", "test_plain.py", cwd=project).stdout


@pytest.mark.parametrize("flag", ["--tarl-record", "--tarl-online", "--tarl-online --tarl-repair"])
def test_a_run_with_flags_names_the_missing_extra(beside_pytest: Run, project: Path, flag: str) -> None:
    ended = beside_pytest("pytest", "-q", *flag.split(), cwd=project)
    assert ended.returncode == pytest.ExitCode.USAGE_ERROR
    assert ended.stderr.strip() == f"ERROR: A run with TARL's flags {SENTENCE}"


def test_a_fixture_names_the_missing_extra(beside_pytest: Run, project: Path) -> None:
    ended = beside_pytest("pytest", "-q", "test_node.py", "test_plain.py", cwd=project)
    assert ended.returncode == pytest.ExitCode.TESTS_FAILED
    assert f"The fixture `tarl` {SENTENCE}" in ended.stdout
    assert "Traceback" not in ended.stdout
    assert "1 passed, 1 error" in ended.stdout


def test_a_conftest_names_the_missing_extra(beside_pytest: Run, project: Path) -> None:
    (project / "conftest.py").write_text("from pytest_tarl import Sensor\n")
    ended = beside_pytest("pytest", "-q", cwd=project)
    assert ended.returncode == pytest.ExitCode.USAGE_ERROR
    assert ended.stderr.strip().splitlines()[-1].endswith(f"pytest_tarl.Sensor {SENTENCE}")


def test_the_plugin_runs_with_its_extra(
    wheel: Path, project: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    (purelib,) = {Path(spec.origin).parents[1] for spec in [find_spec("numpy")] if spec and spec.origin}
    run = runner(environment(tmp_path_factory.mktemp("full") / "env", wheel, purelib))
    (project / "test_node.py").write_text(WITH_SENSOR)
    ended = run("pytest", "-q", "-p", "no:asyncio", cwd=project)
    assert ended.returncode == 0, ended.stdout + ended.stderr
