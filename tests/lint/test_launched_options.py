"""Names that come from the command line, constants and strings of a launched node, decided for that node."""

from __future__ import annotations

import pytest

from tests.lint.test_launched_names import AB, ARGUMENTS, EACH, RELAY, ROS1, SPIN, found
from tests.lint.test_system import MANIFEST, write

PARSE = "\nargs = parser.parse_args(rospy.myargv()[1:])\n"
# name, arguments of the node, code, flows
NODES = [
    ("a list of values", "--pair /a /b", ARGUMENTS + 'parser.add_argument("--pair", nargs=2)' + PARSE
     + "inp, out = args.pair" + RELAY, AB),
    ("any number of values", "/a /c", ARGUMENTS + 'parser.add_argument("topics", nargs="*")' + PARSE + EACH
     + 'kept = [Relay(one, one + "/out") for one in args.topics]' + SPIN, {("/a", "/a/out"), ("/c", "/c/out")}),
    ("numbers", "--id 7", ARGUMENTS + 'parser.add_argument("--id", type=int, default=1)' + PARSE
     + 'inp, out = f"/r{args.id:02d}/in", "/r%d/out" % (args.id + 1)' + RELAY, {("/r07/in", "/r8/out")}),
    ("choices and a constant", "--far", ARGUMENTS
     + 'parser.add_argument("--far", action="store_const", const="/a", default="/x")'
     + PARSE + 'inp, out = args.far, "/b"' + RELAY, AB),
    ("a flag that is not given", "", ARGUMENTS + 'parser.add_argument("--swap", action="store_false")' + PARSE
     + 'inp, out = ("/a", "/b") if args.swap else ("/c", "/d")' + RELAY, AB),
    ("arguments that the code gives", "--inp /x", ARGUMENTS + 'parser.add_argument("--inp")\n'
     + 'args = parser.parse_args(["--inp", "/a"])\ninp, out = args.inp, "/b"' + RELAY, AB),
    ("no arguments, explicitly", "--inp /a", ARGUMENTS + 'parser.add_argument("--inp")\n'
     + 'args = parser.parse_args(args=None)\ninp, out = args.inp, "/b"' + RELAY, AB),
    ("the rest of the arguments", "--x 1 /a", ARGUMENTS + 'parser.add_argument("--x")\n'
     + 'args, rest = parser.parse_known_args()\ninp, out = rest[0], "/b"' + RELAY, AB),
    ("an attribute by name", "", ARGUMENTS + 'parser.add_argument("--inp", default="/a")' + PARSE
     + 'inp, out = getattr(args, "inp"), "/b"' + RELAY, AB),
    ("an element of the command line", "/a /b", "inp, out = sys.argv[1], sys.argv[2]" + RELAY, AB),
    ("a part of the command line", "/a /b", "inp, out = sys.argv[1:3]" + RELAY, AB),
    ("the length of the command line", "/a",
     'inp = sys.argv[1] if len(sys.argv) > 1 else "/x"\nout = "/b"' + RELAY, AB),
    ("a word of the command line", "--near", 'inp = "/a" if "--near" in sys.argv else "/x"\nout = "/b"' + RELAY, AB),
    ("a loop over the command line", "/a /c", EACH
     + 'for one in rospy.myargv()[1:]:\n    Relay(one, one + "/out")' + SPIN,
     {("/a", "/a/out"), ("/c", "/c/out")}),
    ("strings", "", 'base = " /A ".strip().lower()\ninp, out = base, "/" + "-b-".strip("-")' + RELAY, AB),
    ("joined and replaced strings", "", 'inp = "/".join(["", "a"])\nout = "/x".replace("x", "b")' + RELAY, AB),
    ("formatted strings", "", 'inp = "/{}".format("a")\nout = "/{k}".format(k="b")' + RELAY, AB),
    ("a condition on strings", "",
     'side = "left"\ninp = "/a" if side == "left" else "/x"\nout = "/b"' + RELAY, AB),
    ("a name of a module", "",
     'IN, OUT = "a", "b"\ndef name(text):\n    return "/" + text\ninp, out = name(IN), name(OUT)' + RELAY, AB),
    ("a class attribute", "", 'class T:\n    INP = "/a"\n    OUT = INP + "/b"\ninp, out = T.INP, T.OUT' + RELAY,
     {("/a", "/a/b")}),
]  # fmt: skip


@pytest.mark.parametrize(("arguments", "code", "flows"), [n[1:] for n in NODES], ids=[n[0] for n in NODES])
def test_arguments_determine_topic_names_of_a_launched_node(tmp_path, arguments, code, flows):
    body = f'<launch><node pkg="arm" type="n.py" name="n" args="{arguments}"/></launch>'
    write(tmp_path, {"arm/package.xml": MANIFEST.format("arm", "catkin"), "arm/launch/a.launch": body,
                     "arm/scripts/n.py": ROS1 + code})  # fmt: skip
    assert found(tmp_path, "a.launch") == flows


OPEN = [
    ("a value of another type", "--inp x", ARGUMENTS + 'parser.add_argument("--inp", type=int)' + PARSE),
    ("a flag that is computed", "--inp /a", ARGUMENTS + 'parser.add_argument("--" + os.environ["F"])' + PARSE),
    ("a default that is computed", "", ARGUMENTS + 'parser.add_argument("--inp", default=os.environ["F"])' + PARSE),
    ("arguments that are computed", "", ARGUMENTS
     + 'parser.add_argument("--inp")\nargs = parser.parse_args(os.environ["F"].split())\n'),
    ("arguments known on the robot only", "--inp $(env F)", ARGUMENTS + 'parser.add_argument("--inp")' + PARSE),
]  # fmt: skip


@pytest.mark.parametrize(("arguments", "code"), [n[1:] for n in OPEN], ids=[n[0] for n in OPEN])
def test_options_that_cannot_be_parsed_leave_names_unknown(tmp_path, arguments, code):
    body = f'<launch><node pkg="arm" type="n.py" name="n" args="{arguments}"/></launch>'
    text = f'{ROS1}{code}inp, out = args.inp, "/b"{RELAY}'
    write(
        tmp_path,
        {
            "arm/package.xml": MANIFEST.format("arm", "catkin"),
            "arm/launch/a.launch": body,
            "arm/scripts/n.py": text,
        },
    )
    ((source, sink),) = found(tmp_path, "a.launch")
    assert (source.startswith("/"), sink) == (False, "/b")
