"""The nodes of launch files as systems: launched interfaces, flows across nodes, pictures, and queries."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from xml.etree import ElementTree

import jsonschema
import pytest

from tarl_lint.cli import main
from tarl_lint.settings.config import Config
from tarl_lint.system import command
from tarl_lint.system import json as system_json
from tarl_lint.system.flow_chains import MOST, chains
from tarl_lint.system.model import Hop

EXAMPLE = Path(__file__).parents[2] / "examples/workspace"
SCHEMA = json.loads((Path(system_json.__file__).parent / "system.schema.json").read_text("utf-8"))

MANIFEST = "<package><name>{}</name><export><build_type>{}</build_type></export></package>"
RELAY = """\
#!/usr/bin/env python3
import rospy
from std_msgs.msg import Float64
rospy.init_node("relay")
out = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64, lambda msg: out.publish(2.0 * msg.data))
rospy.spin()
"""


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dedent(text))
        if text.startswith("#!"):
            path.chmod(0o755)
    return folder


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a workspace with one node `relay` from `in` to `out`."""
    monkeypatch.chdir(tmp_path)
    return write(
        tmp_path, {"arm/package.xml": MANIFEST.format("arm", "catkin"), "arm/scripts/relay.py": RELAY}
    )


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main(arguments)
    out, err = capsys.readouterr()
    return code, out, err


def launched(folder: Path, body: str, name: str = "a.launch") -> str:
    write(folder, {f"arm/launch/{name}": f"<launch>{body}</launch>"})
    return str(folder / "arm/launch" / name)


def relay(name: str, source: str, sink: str) -> str:
    return (f'<node pkg="arm" type="relay.py" name="{name}"><remap from="in" to="{source}"/>'
            f'<remap from="out" to="{sink}"/></node>')  # fmt: skip


def flows(out: str) -> list[str]:
    text = out.partition("Flows across nodes:\n")[2].partition("\n\n")[0]
    return [line.strip() for line in text.splitlines()]


def test_flows_pass_through_one_program_that_is_launched_twice(workspace, capsys):
    file = launched(workspace, relay("first", "scan", "middle") + relay("second", "middle", "/cmd_vel"))
    code, out, _ = run(capsys, "--launch", file)
    assert flows(out) == ["/scan → /first → /middle → /second → /cmd_vel  explicit"]
    assert code == 0


def test_names_are_resolved_in_the_node_namespace(workspace, capsys):
    file = launched(
        workspace, f'<group ns="left">{relay("one", "~raw", "/out")}{relay("two", "raw", "done")}</group>'
    )
    _, out, _ = run(capsys, "--launch", file)
    assert flows(out) == [
        "/left/one/raw → /left/one → /out  explicit",
        "/left/raw → /left/two → /left/done  explicit",
    ]


def test_arguments_choose_what_is_launched(workspace, capsys):
    body = f'<arg name="robot" default="husky"/><group ns="$(arg robot)">{relay("one", "a", "b")}</group>'
    file = launched(workspace, body)
    assert flows(run(capsys, "--launch", file)[1]) == ["/husky/a → /husky/one → /husky/b  explicit"]
    assert flows(run(capsys, "--launch", file, "robot:=jackal")[1]) == [
        "/jackal/a → /jackal/one → /jackal/b  explicit"
    ]


def test_unread_node_may_connect_topics_of_its_remappings(workspace, capsys):
    driver = '<node pkg="base" type="mux" name="mux"><remap from="i" to="/raw"/><remap from="o" to="/safe"/></node>'
    file = launched(workspace, relay("one", "/scan", "/raw") + driver + relay("two", "/safe", "/cmd_vel"))
    _, out, _ = run(capsys, "--launch", file)
    assert flows(out) == ["/scan → /one → /raw → [/mux, not read] → /safe → /two → /cmd_vel  not read"]
    assert "not read: the package base is not in the workspace\n  remaps i → /raw, o → /safe\n" in out


def test_chains_are_queried_from_sensor_to_actuator(workspace, capsys):
    file = launched(
        workspace,
        relay("one", "/scan", "/mid") + relay("two", "/odom", "/mid") + relay("out", "/mid", "/cmd"),
    )
    assert flows(run(capsys, "--launch", file, "--from", "scan", "--to", "/cmd")[1]) == [
        "/scan → /one → /mid → /out → /cmd  explicit"
    ]
    assert len(flows(run(capsys, "--launch", file, "--to", "cmd")[1])) == 2
    assert flows(run(capsys, "--launch", file, "--from", "/odom", "--to", "/mid")[1]) == [
        "/odom → /two → /mid  explicit"
    ]
    assert (
        "Nothing flows from /cmd to /scan."
        in run(capsys, "--launch", file, "--from", "/cmd", "--to", "/scan")[1]
    )
    assert "No node that was read uses /sacn." in run(capsys, "--launch", file, "--from", "/sacn")[1]


def test_unlaunched_nodes_have_the_names_in_their_code(workspace, capsys):
    _, out, _ = run(capsys, "--to", "/out")
    assert out.startswith(".: ") or ", names as in the code: 1 node" in out
    assert flows(out) == ["/in → /relay → /out  explicit"]


def test_progress_names_each_program_that_is_analysed(workspace):
    told: list[str] = []
    launched(workspace, '<node pkg="arm" type="relay.py" name="relay"/>')
    command.systems(command.request("all", [], None, None), Config(), told.append)
    assert told == ["Looking for packages", "Reading 1 file", "Analysing arm/scripts/relay.py"]


def test_the_search_for_chains_ends_on_cycles(workspace, capsys):
    file = launched(workspace, relay("one", "/a", "/b") + relay("two", "/b", "/a"))
    _, out, _ = run(capsys, "--launch", file)
    assert flows(out) == [
        "/a → /one → /b  explicit",
        "/b → /two → /a  explicit",
    ]


def test_the_number_of_chains_is_limited():
    hops = [Hop(f"/n{i}{j}", f"/t{i}", f"/t{i + 1}", "explicit") for i in range(12) for j in range(3)]
    found, more = chains(hops)
    assert (len(found), more) == (MOST, True)


def test_main_blocks_of_imported_modules_do_not_run(workspace, capsys):
    node = """\
        #!/usr/bin/env python3
        import rospy
        import helper
        from std_msgs.msg import Float64
        if __name__ == "__main__":
            rospy.init_node("user")
            out = rospy.Publisher("twice", Float64, queue_size=1)
            rospy.Subscriber("once", Float64, lambda msg: out.publish(helper.double(msg.data)))
        """
    helper = """\
        import rospy
        from std_msgs.msg import Float64
        def double(value):
            return 2 * value
        def main():
            rospy.init_node("helper")
            rospy.Publisher("unasked", Float64, queue_size=1).publish(1.0)
        if __name__ == "__main__":
            out = rospy.Publisher("never", Float64, queue_size=1)
            rospy.Subscriber("heard", Float64, lambda msg: out.publish(double(msg.data)))
        """
    write(workspace, {"arm/scripts/user.py": dedent(node), "arm/scripts/helper.py": dedent(helper)})
    file = launched(workspace, '<node pkg="arm" type="user.py" name="user"/>')
    _, out, _ = run(capsys, "--launch", file)
    assert flows(out) == ["/once → /user → /twice  explicit"]
    assert "never" not in out
    assert "unasked" not in out


def test_launch_file_leaves_fingerprints_unchanged(workspace, capsys):
    file = launched(workspace, relay("one", "/scan", "/cmd_vel"))
    (system,) = json.loads(run(capsys, "--launch", file, "--format", "json")[1])["systems"]
    plain = json.loads(run(capsys, ".", "--format", "json")[1])["diagnostics"]
    (hop,) = system["hops"]
    assert [one["fingerprint"] for one in hop["flows"]] == [
        one["fingerprint"] for one in plain if one["code"] == "TARL101"
    ]


@pytest.mark.parametrize("arguments", [["--launch", "all"], ["--to", "/cmd_vel"]])
def test_json_of_the_example_is_valid(arguments, capsys, monkeypatch):
    monkeypatch.chdir(EXAMPLE)
    document = json.loads(run(capsys, *arguments, "--format", "json")[1])
    jsonschema.validate(document, SCHEMA)
    assert document["systems"]
    assert all(chain["hops"] for system in document["systems"] for chain in system["chains"])


def test_the_example_uses_all_kinds_of_launch_files(capsys, monkeypatch):
    monkeypatch.chdir(EXAMPLE)
    _, out, _ = run(
        capsys, "--launch", "scout_navigation/launch/bringup.launch.py", "robot:=r1", "--to", "/r1/cmd_vel"
    )
    assert flows(out) == [
        " → ".join(
            ["/r1/rear/scan", "/r1/detector", "/r1/obstacles", "/r1/planner", "/r1/cmd_vel_raw", "/r1/gate"]
        )
        + " → /r1/cmd_vel  explicit",
        "/r1/stop → /r1/gate → /r1/cmd_vel  implicit",
    ]


def test_pictures_show_every_node_and_topic(capsys, monkeypatch):
    monkeypatch.chdir(EXAMPLE)
    drawn = {form: run(capsys, "--launch", "all", "--format", form)[1] for form in ("mermaid", "svg")}
    for name in ("/scout/planner", "/scout/cmd_vel_raw", "/cart_1/wheels", "cart_base/launch/cart.launch"):
        assert all(name in text for text in drawn.values())
    root = ElementTree.fromstring(drawn["svg"])
    boxes = [one for one in root.iter() if one.tag.endswith("rect")]
    places = [tuple(float(one.get(key, "0")) for key in ("x", "y", "width", "height")) for one in boxes]
    assert len(boxes) == len(
        [
            line
            for line in drawn["mermaid"].splitlines()
            if line.endswith((":::topic", ":::node", ":::unread"))
        ]
    )
    assert not any(_overlap(one, other) for i, one in enumerate(places) for other in places[:i])


def _overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    (x1, y1, w1, h1), (x2, y2, w2, h2) = one, other
    return x1 < x2 + w2 and x2 < x1 + w1 and y1 < y2 + h2 and y2 < y1 + h1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["--launch", "none.launch"],
            "none.launch: no such file, and no launch file of the workspace",
        ),
        (
            ["--launch", "all", "robot:=a"],
            "robot:=a is an argument of a launch file: name the file with --launch.",
        ),
        (["--launch", "all"], "there is no launch file in a package at or below it."),
        (["--format", "svg"], "--format svg draws the nodes of launch files: add --launch."),
        (["--launch", "all", "missing"], "missing: no such folder."),
        (
            ["--launch", "all", "robot=a"],
            "robot=a: no such folder. Arguments of a launch file are written NAME:=VALUE.",
        ),
        (["--launch", "a.launch", "--launch", "b.launch"], "--launch is given twice"),
    ],
)
def test_user_mistakes_are_reported_in_sentences(workspace, capsys, arguments, message):
    code, _, err = run(capsys, *arguments)
    assert code == 2
    assert message in err


def test_launch_file_is_found_by_name(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(EXAMPLE)
    by_path = run(capsys, "--launch", "scout_navigation/launch/bringup.launch.py")
    assert by_path[0] == 0
    assert run(capsys, "--launch", "bringup.launch.py") == by_path
    assert run(capsys, "--launch", "scout_navigation/bringup.launch.py") == by_path
    code, _, err = run(capsys, "--launch", "scout_perception/bringup.launch.py")
    assert code == 2
    assert "Did you mean bringup.launch.py?" in err
    for package in ("one", "two"):
        (tmp_path / package / "launch").mkdir(parents=True)
        (tmp_path / package / "package.xml").write_text(f"<package><name>{package}</name></package>")
        (tmp_path / package / "launch/a.launch").write_text("<launch/>")
    monkeypatch.chdir(tmp_path)
    code, _, err = run(capsys, "--launch", "a.launch")
    assert code == 2
    assert "a.launch is a launch file of several packages: name one of one/a.launch, two/a.launch." in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["bringup.launch.py", "robt:=a"], "bringup.launch.py has no argument 'robt'; did you mean 'robot'?"),
        (["cart.launch", "x:=a"], "cart.launch has no argument 'x'; it has cart, gain."),
        (
            ["scout_navigation"],
            "scout_navigation is a package: name one of its launch files, bringup.launch.py.",
        ),
    ],
)
def test_a_wrong_launch_argument_or_name_is_an_error(capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(EXAMPLE)
    code, out, err = run(capsys, "--launch", *arguments)
    assert (code, out) == (2, "")
    assert message in err


def test_similar_topics_are_suggested_for_an_unknown_one(capsys, monkeypatch):
    monkeypatch.chdir(EXAMPLE)
    _, out, _ = run(capsys, "--launch", "bringup.launch.py", "--from", "scan")
    assert "No node that was read uses /scan. Did you mean /scout/rear/scan?" in out


def test_the_guide_matches_the_output(capsys, monkeypatch):
    guide = (EXAMPLE.parents[1] / "docs/howto/launch.md").read_text("utf-8")
    shown = guide.partition("```console\n$ tarl-lint ")[2].partition("\n```")[0]
    command_line, _, expected = shown.partition("\n")
    monkeypatch.chdir(EXAMPLE)
    assert run(capsys, *command_line.split())[1] == expected + "\n"


SERVER = """\
#!/usr/bin/env python3
import actionlib
import rospy
from control_msgs.msg import GripperCommandAction
from std_srvs.srv import Empty, SetBool
rospy.init_node("server")
reset = rospy.ServiceProxy("reset", Empty)
def enable(request):
    reset()
    return True, ""
rospy.Service("enable", SetBool, enable)
def grip(goal):
    actions.set_succeeded()
actions = actionlib.SimpleActionServer("grip", GripperCommandAction, grip, auto_start=False)
actions.start()
rospy.spin()
"""


def test_node_row_is_followed_by_its_remappings_and_services(workspace, capsys):
    write(workspace, {"arm/scripts/server.py": SERVER, "arm/config/limits.yaml": "pid: {p: 1.0, i: 0.1}\n"})
    body = (
        '<group ns="left"><node pkg="arm" type="server.py" name="server"><remap from="reset" to="/wheels/reset"/>'
        '<rosparam file="$(find arm)/config/limits.yaml"/><param name="speed" value="0.4"/></node></group>'
    )
    _, out, _ = run(capsys, "--launch", launched(workspace, body))
    row = next(number for number, line in enumerate(out.splitlines()) if line.startswith("/left/server"))
    assert out.splitlines()[row + 1] == (
        "  remaps reset → /wheels/reset; 3 parameters from arm/config/limits.yaml, arm/launch/a.launch;"
        " serves /left/enable; calls /wheels/reset; action server of /left/grip"
    )


def test_group_parameters_named_by_the_node_are_counted(workspace, capsys):
    write(workspace, {"arm/config/limits.yaml": "pid: {p: 1.0, i: 0.1}\n"})
    body = (
        '<group ns="left"><rosparam file="$(find arm)/config/limits.yaml" ns="one"/><param name="one/speed" value="1"/>'
        '<rosparam file="$(find arm)/config/limits.yaml" ns="oneself"/><rosparam file="absent.yaml" ns="one"/>'
        '<node pkg="arm" type="relay.py" name="one"/></group>'
    )
    _, out, _ = run(capsys, "--launch", launched(workspace, body))
    assert "\n  3 parameters from arm/config/limits.yaml, arm/launch/a.launch\n" in out


def test_parameters_whose_file_cannot_be_read_are_not_counted(workspace, capsys):
    write(workspace, {"arm/config/limits.yaml": "pid: [1.0\n"})
    body = (
        '<node pkg="arm" type="relay.py" name="one"><rosparam file="$(find arm)/config/limits.yaml"/></node>'
    )
    _, out, _ = run(capsys, "--launch", launched(workspace, body))
    assert "\n  parameters from arm/config/limits.yaml\n" in out


CPP = """\
    // nh.advertise<std_msgs::Float64>("not_this", 1);
    int main(int argc, char** argv) {
      ros::init(argc, argv, "limit");
      ros::NodeHandle nh, own("~");
      auto out = nh.advertise<std_msgs::Float64>("out", 1);
      auto log = own.advertise<diagnostic_msgs::DiagnosticStatus>("log", 1);
      auto in = nh.subscribe("in", 1, callback);
    }
"""
CPP2 = """\
    Limit() : Node("limit") {
      out_ = this->create_publisher<std_msgs::msg::Float64>("out", 10);
      /* create_publisher<std_msgs::msg::Float64>("not_this", 10) */
      log_ = create_publisher<diagnostic_msgs::msg::DiagnosticStatus>("~/log", 10);
      in_ = create_subscription<std_msgs::msg::Float64>(
        "in", rclcpp::QoS(10), std::bind(&Limit::on_in, this, _1));
    }
"""


@pytest.mark.parametrize("source", [CPP, CPP2])
def test_chains_pass_through_topics_that_a_cpp_node_names(source, workspace, capsys):
    cmake = "project(arm)\nset(SOURCES src/limit.cpp)\nadd_executable(limit ${SOURCES} src/gone.cpp)\n"
    write(workspace, {"arm/CMakeLists.txt": cmake, "arm/src/limit.cpp": source})
    limit = '<node pkg="arm" type="limit" name="limit"><remap from="in" to="mid"/><remap from="out" to="safe"/></node>'
    file = launched(workspace, relay("one", "scan", "mid") + limit + relay("two", "safe", "cmd"))
    _, out, _ = run(capsys, "--launch", file)
    assert flows(out) == [
        "/scan → /one → /mid → [/limit, not read] → /limit/log  not read",
        "/scan → /one → /mid → [/limit, not read] → /safe → /two → /cmd  not read",
    ]
    assert "arm/limit (C++, not read)" in out
    document = json.loads(run(capsys, "--launch", file, "--format", "json")[1])
    jsonschema.validate(document, SCHEMA)
    (node,) = (one for one in document["systems"][0]["nodes"] if one["name"] == "/limit")
    assert (node["program"], node["not_read"]) == (None, "a C++ program of arm")
    assert [(one["name"], one["type"], one["line"]) for one in node["publishes"]] == [
        ("/safe", "Float64", 5 if source == CPP else 2),
        ("/limit/log", "DiagnosticStatus", 6 if source == CPP else 4),
    ]


NON_ASCII = '''\
#!/usr/bin/env python3
import rospy
from geometry_msgs.msg import Accel
from std_srvs.srv import Empty
rospy.init_node("relay")
def heard(msg):
    rospy.loginfo("öäü → %s", msg.accel)
rospy.Subscriber("in", Accel, heard)
rospy.loginfo("größer"); rospy.ServiceProxy("reset", Empty)()
'''  # fmt: skip


def test_columns_count_characters_not_bytes(workspace, capsys):
    write(workspace, {"arm/scripts/relay.py": NON_ASCII})
    file = launched(workspace, relay("a", "/x", "/y"))
    _, out, _ = run(capsys, "--launch", file, "--format", "json")
    (system,) = json.loads(out)["systems"]
    (absent,) = [one for one in system["diagnostics"] if one["code"] == "TARL309"]
    (called,) = system["nodes"][0]["calls"]
    lines = NON_ASCII.splitlines()
    for found, text in ((absent, "msg.accel"), (called, 'rospy.ServiceProxy("reset", Empty)')):
        assert lines[found["line"] - 1][found["column"] - 1 : found["end_column"] - 1] == text
