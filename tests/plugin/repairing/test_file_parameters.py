"""A parameter that the node reads under a computed name is changed in the file that sets it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.constant_definitions import ParameterInFile, configured, parameter
from pytest_tarl.patching.mutate import located, mutations
from pytest_tarl.patching.rewriting import rewrite
from pytest_tarl.repairing.file_parameters import files_of_packages, places_in_force
from pytest_tarl.repairing.placing import Placing
from pytest_tarl.repairing.scales import charts
from pytest_tarl.repairing.strategies import aside_operands, operands
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, effective_value
from pytest_tarl.sensors import Sensor
from tarl_lint.api import analyse

NODE = """\
import rospy
from std_msgs.msg import Float64

{before}

class Keeper:
    def __init__(self):
        {first}
        self.out = rospy.Publisher("/out", Float64, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_value)

    {method}

    def on_value(self, msg):
        self.out.publish({use} * msg.data + {added})


if __name__ == "__main__":
    rospy.init_node("keeper")
    Keeper()
    rospy.spin()
"""
YAML = """\
other:
  gain_left: 2.0
keeper:
  gain_left: 2.0  # per second
  gain_right: 3.0
  offset_left: 0.0
  offset_right: 0.25
"""
FILES = {
    "package.xml": "<package><name>tank</name></package>",
    "config/params.yaml": YAML,
    "cfg/Keeper.cfg": 'gen.add("gain_left", double_t, 0, "per second", 2.0, 0.0, 10.0)\n',
}
READ = {
    "/keeper/gain_left": 2.0,
    "/keeper/gain_right": 3.0,
    "/keeper/offset_left": 0.0,
    "/keeper/offset_right": 0.25,
}
SET_BY_MESSAGES = {
    "first": (
        'self.gain_left = rospy.get_param("~gain_left", 1.0)\n'
        '        rospy.Subscriber("/gain", Float64, self.on_gain)'
    ),
    "method": "def on_gain(self, msg):\n        self.gain_left = msg.data\n",
    "use": "self.gain_left",
    "added": "msg.spare",
}
FORMS: Mapping[str, Mapping[str, str]] = {
    "loop": {
        "first": (
            'self.gains = [0.0, 0.0]\n        for at, side in enumerate(("gain_left", "gain_right")):\n'
            '            self.gains[at] = rospy.get_param("~" + side)'
        ),
        "use": "self.gains[0]",
    },
    "formatted name": {
        "first": 'self.gains = {side: rospy.get_param(f"~gain_{side}") for side in ("left", "right")}',
        "use": 'self.gains["left"]',
    },
    "set by messages": SET_BY_MESSAGES,
    "list of calls": {
        "first": 'self.gains = [rospy.get_param("~gain_left", 1.0), rospy.get_param("~gain_right", 1.0)]',
        "use": "max(gain for gain in self.gains)",
    },
    "helper": {
        "before": 'def read(name):\n    return rospy.get_param("~" + name)\n\n',
        "first": 'self.gain = read("gain_" + "left")',
        "use": "self.gain",
    },
}  # fmt: skip


def order_of(folder: Path, form: Mapping[str, str], read: Mapping[str, Any] = READ, **options: Any) -> Any:
    usual = {"before": "", "method": "", "added": "0.0"}
    for name, text in (FILES | {"keeper.py": NODE.format(**usual | {**form})}).items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    return SimpleNamespace(
        analysis=analyse([Path("keeper.py")], root=folder),
        root=folder,
        comparison=SimpleNamespace(culprits=(), sensors=()),
        fixture=SimpleNamespace(sensors=(), topics={}),
        online=SimpleNamespace(recorded=SimpleNamespace(parameters=read)),
        options=SimpleNamespace(edit=options.get("edit", "auto")),
        permanent=options.get("permanent", True),
    )


@pytest.fixture(autouse=True)
def _in_the_project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def in_files(order: Any) -> dict[str, ParameterInFile]:
    """Return the parameters in files among the operands, by name."""
    found = [one for one in operands(order) if isinstance(one, ParameterInFile)]
    assert len({one.code for one in found}) == len(found)
    return {one.code: one for one in found}


def changed(order: Any, one: ParameterInFile, factor: float) -> dict[str, str]:
    """Return the text of each file that a factor on a parameter changes."""
    mutation = mutations(one, factor)
    assert mutation is not None
    return rewrite(order.analysis, [mutation], ALWAYS, {}, files_of_packages(order))


@pytest.mark.parametrize("form", FORMS)
def test_parameter_with_a_computed_name_is_changed_in_its_section(form: str, tmp_path: Path) -> None:
    order = order_of(tmp_path, FORMS[form])
    found = in_files(order)
    one = found["gain_left"]
    assert (one.value, one.setting) == (2.0, "gain_left")
    texts = changed(order, one, 2.5)
    assert texts == {"config/params.yaml": YAML.replace("  gain_left: 2.0  #", "  gain_left: 5.0  #")}


def test_zero_parameter_moves_on_the_scale_of_similar_parameters(tmp_path: Path) -> None:
    order = order_of(tmp_path, FORMS["loop"])
    one = in_files(order)["offset_left"]
    assert one.size == 0.25
    chart = charts(SimpleNamespace(**vars(order) | {"fixture": NO_VALUES}), [one])[one]  # type: ignore[arg-type]
    assert chart.size == 0.25
    (text,) = changed(order, one, chart.factor(0.0, 2.0) or 1.0).values()
    assert text == YAML.replace("offset_left: 0.0", "offset_left: 0.25")


class _Values:
    """A recording without values."""

    def __getattr__(self, name: str) -> Any:
        return _Values()

    def __call__(self, *_: Any) -> Any:
        return _Values()

    def __iter__(self) -> Any:
        return iter(())


NO_VALUES = _Values()


def test_named_or_unset_parameters_are_not_added(tmp_path: Path) -> None:
    named = {"first": 'self.gain = rospy.get_param("~gain_left", 1.0)', "use": "self.gain"}
    assert "gain_left" not in in_files(order_of(tmp_path, named))
    loop = FORMS["loop"]
    assert (
        in_files(order_of(tmp_path, loop, {"/keeper/gain_left": 2.5})) == {}
    )  # the test passes another value
    assert in_files(order_of(tmp_path, loop, {})) == {}
    assert in_files(order_of(tmp_path, loop, edit="use")) == {}


GROUPED = {
    "first": (
        'gains = rospy.get_param("~gains")\n        self.left = float(gains["gain_left"])\n'
        '        self.right = gains["gain_right"]\n        self.offset = gains["offset_left"]\n'
        "        self.gains = gains\n        self.more = More(self.gains)"
    ),
    "before": (
        "class More:\n    def __init__(self, gains):\n        self.gains = gains\n\n"
        '    def most(self, value):\n        return min(value, self.gains["gain_right"])\n\n'
    ),
    "use": "self.more.most(msg.data) + self.left",
    "added": "self.right + self.offset",
}
IN_A_GROUP = {name.replace("keeper/", "keeper/gains/"): value for name, value in READ.items()}


def test_an_entry_of_a_parameter_is_one_constant_at_its_use_and_in_the_file(tmp_path: Path) -> None:
    order = order_of(tmp_path, GROUPED, IN_A_GROUP, permanent=False)
    (tmp_path / "config/params.yaml").write_text(
        text := "keeper:\n  gains: {gain_left: 2.0, gain_right: 3.0, offset_left: 0.0, offset_right: 0.25}\n"
    )
    # a factor does not change a zero, so the offset is changed in the file only
    assert set(in_files(order)) == {"offset_left", "offset_right"}
    every = {one.code: one for one in operands(order)}
    assert {"self.left", "self.right", "self.offset"} <= set(every)
    for code in ("self.right", 'self.gains["gain_right"]'):
        assert parameter(order.analysis, every[code]) == "gain_right"
    assert not {"gains", "self.gains"} & set(every), every  # the whole table is no constant
    places = configured("gain_right", files_of_packages(order))
    (place,) = [place for place in places if place.path.endswith("params.yaml")]
    assert text[place.start : place.end] == "3.0"


def test_repair_with_a_possible_condition_keeps_the_call(tmp_path: Path) -> None:
    for permanent in (True, False):
        codes = [
            one.code for one in operands(order_of(tmp_path, FORMS["list of calls"], permanent=permanent))
        ]
        assert "gain_left" in codes
        assert ('rospy.get_param("~gain_left", 1.0)' in codes) is not permanent


def test_a_parameter_in_a_file_cannot_have_a_condition(tmp_path: Path) -> None:
    order = order_of(tmp_path, FORMS["loop"])
    mutation = mutations(in_files(order)["gain_left"], 2.0)
    assert mutation is not None
    guard = Guard((Conjunct(Sensor("wet", topic="/wet", field="data"), 1.0, 1.0),))
    with pytest.raises(RepairError, match="cannot have a condition"):
        rewrite(order.analysis, [mutation], guard, {}, files_of_packages(order))


def test_accepted_change_names_the_place_in_the_file(tmp_path: Path) -> None:
    order = order_of(tmp_path, FORMS["loop"])
    mutation = mutations(in_files(order)["gain_left"], 2.0)
    assert mutation is not None
    assert effective_value(mutation) == effective_value(located(mutation)) == 4.0
    mutants: Any = SimpleNamespace(order=order)
    placed: Any = Placing(mutants)(Candidate((mutation,), ALWAYS), None)  # type: ignore[arg-type]
    (place,) = [one.place for one in placed.mutations]
    assert (place.path, place.line, place.name) == ("config/params.yaml", 4, "gain_left")


@pytest.mark.parametrize(
    ("name", "files", "expected"),
    [
        ("/keeper/gain", {"a.yaml": "gain: 2.0\n", "b.yaml": "keeper:\n  gain: 2.0\n"}, ["b.yaml:2"]),
        ("/ns/keeper/gain", {"b.yaml": "/ns/keeper:\n  ros__parameters:\n    gain: 2.0\n"}, ["b.yaml:3"]),
        ("/keeper/gain", {"b.yaml": "/**: {ros__parameters: {gain: 2.0}}\n"}, ["b.yaml:1"]),
        ("/keeper/pid/gain", {"b.yaml": "pid: {gain: 2.0}\nroll: {gain: 2.0}\n"}, ["b.yaml:1"]),
        ("/keeper/gain", {"b.yaml": "other:\n  gain: 2.0\n", "a.cfg": FILES["cfg/Keeper.cfg"]}, []),
        ("/keeper/gain_left", {"a.cfg": FILES["cfg/Keeper.cfg"]}, ["a.cfg:1"]),
        (
            "/keeper/gain",
            {
                "k.launch": '<launch><param name="gain" value="2.0"/></launch>',
                "a.cfg": 'g.add("gain", d, 0, "", 2.0)',
            },
            ["k.launch:1"],
        ),
        ("/keeper/gain", {"b.yaml": "gain: true\nother: [\n"}, []),
    ],
)
def test_value_in_force_is_the_entry_of_the_node(
    name: str, files: Mapping[str, str], expected: list[str]
) -> None:
    assert [f"{one.path}:{one.line}" for one in places_in_force(name, 2.0, files)] == expected


LIMITED = {
    "before": (
        "from scipy import signal\n\n\nclass Filter:\n    def __init__(self, cutoff):\n"
        "        self.shares = signal.butter(2, cutoff)\n"
    ),
    "first": (
        'self.cutoff = min(float(rospy.get_param("~gain_left", 2)), 50.0)\n        self.filters = []\n'
        '        for _ in range(2):\n            self.filters.append(Filter(self.cutoff / 100.0))'
    ),
    "use": "self.filters[0].shares[0]",
}  # fmt: skip


@pytest.mark.parametrize(("read", "file"), [({}, "keeper.py"), (READ, "config/params.yaml")])
def test_default_changes_if_nothing_sets_the_parameter(
    read: Mapping[str, float], file: str, tmp_path: Path
) -> None:
    order = order_of(tmp_path, LIMITED, read)
    ((path, text),) = changed(order, in_files(order)["gain_left"], 2.5).items()
    assert Path(path).name == Path(file).name
    assert ('get_param("~gain_left", 5))' if file == "keeper.py" else "  gain_left: 5.0  #") in text


def test_quoted_default_keeps_its_quotes(tmp_path: Path) -> None:
    quoted = {**LIMITED, "first": LIMITED["first"].replace('"~gain_left", 2)', '"~gain_left", "2")')}
    order = order_of(tmp_path, quoted, {})
    ((_, text),) = changed(order, in_files(order)["gain_left"], 2.5).items()
    assert 'get_param("~gain_left", "5"))' in text


def test_default_that_is_an_operand_is_not_added(tmp_path: Path) -> None:
    named = {"first": 'self.gain = rospy.get_param("~gain_left", 1.0)', "use": "self.gain"}
    assert in_files(order_of(tmp_path, named, {})) == {}


BESIDE = """\
import rospy
from geometry_msgs.msg import Vector3
from std_msgs.msg import Float64


def clamp(value, low, high):
    return max(low, min(high, value))


class Blower:
    def __init__(self):
        self.pressure = {read}
        self.stretch = 1.0
        self.out = rospy.Publisher("/out", Vector3, queue_size=1)
        rospy.Subscriber("/in", Float64, self.on_value)

    def on_value(self, msg):
        command = Vector3()
        command.x = clamp(self.pressure, 1.5, 10.0)
        command.y = clamp(20.0 * msg.data, 6.0, 40.0)
        self.out.publish(command)


if __name__ == "__main__":
    rospy.init_node("keeper")
    Blower()
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("read", "value", "given"),
    [
        ('rospy.get_param("~gain_left", 4.0)', 4.0, READ),
        ('rospy.get_param("~gain_left", 4.0)', 4.0, {}),
        ('rospy.get_param("~gain_left")', None, READ),
    ],
)
def test_a_parameter_that_is_published_unchanged_is_changed_where_it_is_used(
    read: str, value: float | None, given: Mapping[str, float], tmp_path: Path
) -> None:
    order = order_of(tmp_path, FORMS["loop"], given)
    (tmp_path / "keeper.py").write_text(BESIDE.replace("{read}", read))
    order.analysis = analyse([Path("keeper.py")], root=tmp_path)
    assert "gain_left" not in in_files(order)
    every = operands(order)
    (one,) = [each for each in every if each.code == "self.pressure"]
    assert one.value == value
    assert one not in aside_operands(order, every)
    mutation = mutations(one, 2.5)
    assert mutation is not None
    guard = Guard((Conjunct(Sensor("wet", topic="/wet", field="data"), 1.0, 1.0),))
    (text,) = rewrite(order.analysis, [mutation], guard, {"/wet": "std_msgs/msg/Bool"}).values()
    assert "        if self.wet:\n            command.x = clamp(2.5 * self.pressure, 1.5, 10.0)\n" in text


@pytest.mark.parametrize(("written", "value"), [("0.0", 0.0), ("0", 0), ("true", True), ("false", False)])
def test_a_zero_or_boolean_is_changed_in_its_file_although_a_statement_uses_it(
    written: str, value: float, tmp_path: Path
) -> None:
    order = order_of(tmp_path, FORMS["loop"], {**READ, "/keeper/offset_left": value})
    (tmp_path / "config/params.yaml").write_text(YAML.replace("offset_left: 0.0", f"offset_left: {written}"))
    (tmp_path / "keeper.py").write_text(BESIDE.replace("{read}", 'rospy.get_param("~offset_left")'))
    order.analysis = analyse([Path("keeper.py")], root=tmp_path)
    found = in_files(order)["offset_left"]
    assert (found.value, found.place and found.place.path) == (value, "config/params.yaml")
    assert all(each.code != "self.pressure" for each in operands(order))


def test_a_use_with_a_known_zero_takes_the_place_of_the_parameter(tmp_path: Path) -> None:
    order = order_of(tmp_path, FORMS["loop"])
    (tmp_path / "keeper.py").write_text(BESIDE.replace("{read}", 'rospy.get_param("~offset_left", 0.0)'))
    order.analysis = analyse([Path("keeper.py")], root=tmp_path)
    assert "offset_left" not in in_files(order)
    assert [each.value for each in operands(order) if each.code == "self.pressure"] == [0.0]
