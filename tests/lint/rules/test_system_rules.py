"""The rules about systems, on systems of a few nodes that are put together here."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from tarl_lint.model import Span
from tarl_lint.system.hazards import single
from tarl_lint.system.model import Endpoint, Instance, Interface, Misfit, Qos, System
from tarl_lint.system.similar_names import longer_alike, misspelt, spelled_alike
from tarl_lint.workspace.launch_model import LaunchedNode, Setting

FILE = Path("robot.launch")
AT = Span("node.py", 3, 1, 3, 9)


def end(role: str, name: str, kind: str = "Twist", **given: Any) -> Endpoint:
    names = given.pop("names", (name,))
    return Endpoint(role, names, kind, AT, **given)  # type: ignore[arg-type]


def node(
    name: str, *ends: Endpoint, interface: Interface | None = None, unread: bool = False, **given: Any
) -> Instance:
    """Return a launched node whose program has these ends; `unread` leaves out its program."""
    namespace, _, last = name.rpartition("/")
    launched = LaunchedNode("arm", f"{last}.py", last, namespace or "/", FILE, given.pop("line", 7), **given)
    made = interface or Interface("node.py", endpoints=ends, whole=True, parameters=True)
    return Instance(launched, name, None if unread else made)


def messages(rule: int, *instances: Instance, file: Path = FILE) -> list[str]:
    found = import_module(f"tarl_lint.rules.tarl{rule}").findings(System(file, instances))
    return [one.message for one in found]


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        ("/robot/scan", "/scan", True),
        ("/scan", "/robot/scan", True),
        ("/a/b/scan", "/a/scan", True),
        ("/a/b/scan", "/b/scan", True),
        ("/left/scan", "/right/scan", False),
        ("/scan", "/scan", False),
        ("/cmd_vel", "/cmd_val", True),
        ("/cmd_vel", "/cmd_ve", True),
        ("/cmd_vel", "/cmd_vell", True),
        ("/cmd_vel", "/cmd_evl", True),
        ("/cmd_vel", "/cdm_lev", False),
        ("/cmd_vel", "/cmd_velxy", False),
        ("/a/cmd_vel", "/b/cmd_val", False),
        ("/scan", "/scam", False),
        ("/e_stop", "/estop", True),
        ("/eStop", "/estop", True),
        ("/scan_x", "/scanx_", False),
        ("/scans", "/scan", False),
        ("/imu_a", "/imu_b", False),
        ("/image_a", "/image_b", False),
        ("/left_1", "/left_2", False),
        ("/left_12", "/left_21", False),
        ("/left1", "/left", False),
        ("/lefts1", "/lefts", False),
    ],
)
def test_similar_spellings_of_names_are_recognised(one, other, alike):
    assert spelled_alike(one, other) is alike
    assert spelled_alike(other, one) is alike


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        ("/arm/open", "/arm/open_door", True),
        ("/arm/door_open", "/arm/open", True),
        ("/arm/open", "/arm/opened", False),
        ("/open", "/open_door", False),
        ("/arm/open", "/leg/open_door", False),
        ("/arm/open", "/arm/open", False),
    ],
)
def test_names_that_differ_by_whole_words_are_recognised(one, other, alike):
    assert longer_alike(one, other) is longer_alike(other, one) is alike


def test_private_name_of_the_same_node_is_similar():
    says = node("/speech", end("publishes", "~finish", "String"))
    hears = node("/tour", end("subscribes", "speech/finished", "String"))
    assert len(messages(301, says, hears)) == len(messages(301, says, hears, node("/x", unread=True))) == 1
    takes = node("/speech", end("subscribes", "~say", "String"))
    sends = node("/tour", end("publishes", "speech/tell", "String"))
    assert len(messages(301, takes, sends)) == 1
    assert messages(301, takes, sends, node("/x", unread=True)) == [], "it may publish /speech/say"
    assert messages(301, node("/s", end("publishes", "speech/a", "String")), hears) == [], "no node /speech"


def test_endpoint_has_one_type_if_exactly_one_is_known():
    assert [single(end("calls", "a", kind)) for kind in ("Twist", "Twist | Pose", "AnyMsg", "")] == [
        "Twist",
        "",
        "",
        "",
    ]


HEARS, SAYS = end("subscribes", "cmd_vel"), end("publishes", "cmd_val")


def test_subscription_without_publisher_names_a_similar_topic():
    assert messages(301, node("/a", HEARS), node("/b", SAYS)) == [
        "/a subscribes to /cmd_vel (Twist), which no node publishes; /b publishes /cmd_val, to which no node subscribes"
    ]
    (both,) = messages(301, node("/a", HEARS), node("/c", SAYS), node("/b", SAYS))
    assert both.endswith("; /b publishes /cmd_val and /c publishes /cmd_val, to which no node subscribes")


@pytest.mark.parametrize(
    "others",
    [
        [node("/b", SAYS), node("/c", end("publishes", "cmd_vel"))],
        [node("/b", SAYS), node("/c", end("subscribes", "cmd_val"))],
        [node("/b", end("publishes", "cmd_val", "Pose"))],
        [node("/b", end("publishes", "other"))],
        [node("/b", SAYS), node("/c", unread=True, remaps=(("x", "cmd_vel"),))],
        [node("/b", SAYS), node("/c", unread=True, arguments="--out cmd_val")],
        [node("/b", SAYS), node("/c", interface=Interface("c.py", words=frozenset(["cmd_vel"])))],
        [node("/b", end("publishes", "/left/cmd_vel")), node("/c", unread=True)],
    ],
)
def test_subscription_with_a_possible_publisher_is_not_reported(others):
    assert messages(301, node("/a", HEARS), *others) == []


@pytest.mark.parametrize("other", [node("/c", unread=True), node("/c", interface=Interface("c.py"))])
def test_misspelt_name_is_reported_beside_unread_nodes(other):
    assert len(messages(301, node("/a", HEARS), node("/b", SAYS), other)) == 1
    assert misspelt("/cmd_vel", "/cmd_val")
    assert not misspelt("/cmd_vel", "/left/cmd_vel")


def test_subscriptions_of_unknown_type_are_not_compared():
    assert messages(301, node("/a", end("subscribes", "cmd_vel", "")), node("/b", SAYS)) == []
    several = end("subscribes", "", names=("cmd_vel", "cmd_vex"))
    assert messages(301, node("/a", several), node("/b", SAYS)) == []
    assert messages(301, node("/a", HEARS, SAYS)) == []


def test_a_subscription_whose_type_no_publisher_has_is_reported():
    pose = end("publishes", "cmd_vel", "Pose")
    assert messages(302, node("/a", HEARS), node("/b", pose)) == [
        "/a subscribes to /cmd_vel as Twist, but /b publishes Pose"
    ]
    assert messages(302, node("/a", HEARS), node("/c", pose), node("/b", replace(pose, type="Path"))) == [
        "/a subscribes to /cmd_vel as Twist, but /b publishes Path and /c publishes Pose"
    ]
    for kind in ("Twist", "", "A | B"):
        assert messages(302, node("/a", HEARS), node("/b", pose), node("/c", replace(pose, type=kind))) == []
    elsewhere = node("/c", end("publishes", "x"))
    assert len(messages(302, node("/a", HEARS), node("/b", pose), elsewhere)) == 1
    assert messages(302, node("/a", replace(HEARS, type="")), node("/b", pose)) == []
    assert messages(302, node("/a", HEARS), node("/b", replace(pose, names=("cmd_vel", "y")))) == []


@pytest.mark.parametrize(
    ("asked", "offered", "refused"),
    [
        (Qos(reliable=True), Qos(reliable=False), [("RELIABLE", "BEST_EFFORT")]),
        (Qos(latched=True), Qos(latched=False), [("TRANSIENT_LOCAL", "VOLATILE")]),
        (Qos(True, True), Qos(False, False), [("RELIABLE", "BEST_EFFORT"), ("TRANSIENT_LOCAL", "VOLATILE")]),
        (Qos(reliable=False, latched=False), Qos(reliable=True, latched=True), []),
        (Qos(reliable=True), Qos(reliable=True), []),
        (Qos(reliable=True), Qos(), []),
        (Qos(), Qos(reliable=False), []),
        (None, Qos(reliable=False), []),
        (Qos(reliable=True), None, []),
    ],
)
def test_subscription_with_stricter_qos_is_reported(asked, offered, refused):
    says = end("publishes", "cmd_vel", qos=offered)
    found = messages(
        303, node("/a", replace(HEARS, qos=asked)), node("/b", says), node("/c", end("publishes", "x"))
    )
    assert found == [
        f"/a asks for {one} on /cmd_vel, but /b offers {other}: no message arrives" for one, other in refused
    ]


def test_client_without_a_server_names_a_similar_service():
    calls, serves = end("calls", "home", "Trigger"), end("serves", "~home", "Trigger")
    assert messages(304, node("/client", calls), node("/arm", serves)) == [
        "/client calls /home (Trigger), which no node offers; /arm offers /arm/home"
    ]
    assert (
        messages(
            304, node("/client", calls), node("/arm", serves), node("/b", end("serves", "home", "Trigger"))
        )
        == []
    )
    assert (
        messages(
            304, node("/client", calls), node("/arm", serves), node("/b", end("calls", "arm/home", "Trigger"))
        )
        == []
    )
    assert messages(304, node("/client", calls), node("/arm", replace(serves, type="Empty"))) == []
    assert (
        messages(304, node("/client", replace(calls, type="")), node("/arm", replace(serves, type=""))) == []
    )
    assert messages(304, node("/client", calls), node("/arm", serves), node("/c", unread=True)) == []


def author(
    example: Any, name: str, kind: str = "Twist", topics: tuple[str, ...] = ("cmd_vel",), **given: Any
) -> Instance:
    flow = example.flow()
    sink = replace(flow.sink, type=kind, topics=topics)
    flows = (replace(example.finding(), flow=replace(flow, sink=sink)),)
    return node(name, interface=Interface("n.py", flows=flows), **given)


def test_two_command_publishers_on_one_topic_are_reported(example):
    found = messages(
        305, author(example, "/b"), author(example, "/a"), author(example, "/c", remaps=(("cmd_vel", "raw"),))
    )
    assert found == ["/a and /b both publish commands on /cmd_vel: let a multiplexer choose"]
    assert messages(305, author(example, "/a"), author(example, "/n/b")) == []
    assert messages(305, author(example, "/a"), author(example, "/b", "String")) == []
    assert messages(305, author(example, "/a"), author(example, "/b", topics=("cmd_vel", "x"))) == []
    assert messages(305, author(example, "/a"), author(example, "/b", condition="if $(arg x)")) == []
    assert messages(305, author(example, "/a"), node("/b", unread=True)) == []


def test_stale_command_is_reported_with_both_topics(example):
    stale = replace(
        example.finding(), flow=replace(example.flow(), sink=replace(example.sink(), type="Twist"))
    )
    unnamed = replace(stale, flow=replace(stale.flow, source=replace(example.source(), topics=())))
    made = Interface("n.py", stale=(stale, unnamed, replace(stale, flow=None)))
    assert messages(306, node("/n/a", interface=made, remaps=(("odom", "/o"),)), node("/b", unread=True)) == [
        "/n/a continues to publish /n/progress (Twist) after /o stops"
    ]


def keeper(name: str, *settings: Setting, words: Iterable[str] = ("gain",), named: bool = True) -> Instance:
    made = Interface("n.py", words=frozenset(words), parameters=named, whole=True)
    return node(name, interface=made, settings=settings)


def yaml(text: str) -> Setting:
    return Setting("~", Path("k.yaml"), yaml=text)


NONE = "/k has no parameter {}: the launch file sets it without effect"


@pytest.mark.parametrize(
    ("setting", "absent"),
    [
        (Setting("~gian", FILE, 1), ["gian"]),
        (Setting("~gain", FILE, 1), []),
        (Setting("~gain/", FILE, 1), []),
        (Setting("~use_sim_time", FILE, 1), []),
        (Setting("~qos_overrides.x", FILE, 1), []),
        (Setting("/gian", FILE, 1), []),
        (Setting("~inner/gain", FILE, 1), []),
        (Setting("~gain.p", FILE, 1), ["gain.p"]),
        (Setting("~gain_2.gain", FILE, 1), []),
        (Setting("~gian.p", FILE, 1), ["gian.p"]),
        (yaml("gian: 1\ngain: 2\nb: 3"), ["gian", "b"]),
        (yaml("gian: {p: 1, i: 2}\ngain: {p: 1}"), ["gian/p", "gian/i"]),
        (yaml("k: {ros__parameters: {gian: {p: 1}, gain: 2}}"), ["gian.p"]),
        (yaml("/**: {ros__parameters: {other: 1}}"), []),
        (yaml("/other: {ros__parameters: {gian: 1}}"), []),
        (yaml("[1, 2]"), []),
        (yaml("a: ["), []),
        (Setting("~in", FILE, yaml="a: 1"), ["in"]),
    ],
)
def test_setting_of_a_missing_parameter_is_reported(setting, absent):
    assert messages(307, keeper("/k", setting)) == [NONE.format(name) for name in absent]


def test_parameter_is_absent_only_if_no_matching_node_declares_it():
    setting = Setting("~gian", FILE, 1)
    assert messages(307, keeper("/k", setting), keeper("/l", setting, words=("gian",))) == []
    assert messages(307, keeper("/k", setting), keeper("/l", setting, named=False)) == []
    assert messages(307, keeper("/k", setting), keeper("/l", setting)) == [NONE.format("gian")]
    assert messages(307, node("/k", unread=True, settings=(setting,))) == []


def test_misspelt_parameter_for_all_nodes_is_reported():
    shared = yaml("/**: {ros__parameters: {treshold: 1, other: 2}}")
    near = keeper("/k", shared, words=("threshold",))
    assert messages(307, near, keeper("/l", shared)) == [NONE.format("treshold")]
    assert messages(307, near, keeper("/l", shared, words=("treshold",))) == []
    assert messages(307, near, node("/l", unread=True, settings=(shared,))) == []


def test_section_of_a_shared_parameter_file_belongs_to_its_node():
    shared = yaml("k: {ros__parameters: {gian: 1}}\nl: {ros__parameters: {other: 1}}")
    open_ = keeper("/l", shared, named=False)
    assert messages(307, keeper("/k", shared), open_) == [NONE.format("gian")]
    assert messages(307, open_, keeper("/k", shared)) == [NONE.format("gian")]


def test_section_without_namespace_applies_to_nodes_without_namespace():
    section = yaml("k: {ros__parameters: {gain: 1, a: 2, b: 3, c: 4}}")
    lost = "/n/k does not get a, b, c …: the section k of k.yaml is for /k; name it /n/k or /**/k"
    assert messages(307, keeper("/n/k", section)) == [lost]
    assert messages(307, keeper("/n/k", section), keeper("/k", section, words=("gain", "a", "b", "c"))) == []
    assert messages(307, keeper("/$(arg n)/k", section)) == []
    assert messages(307, keeper("/n/other", section)) == []
    three = "/n/k does not get a, b, c: the section k of k.yaml is for /k; name it /n/k or /**/k"
    assert messages(307, keeper("/n/k", yaml("k: {ros__parameters: {a: 2, b: 3, c: 4}}"))) == [three]
    both = yaml("k: {ros__parameters: {gain: 1}}\n/n/k: {ros__parameters: {gain: 2}}")
    assert messages(307, keeper("/n/k", both)) == []
    assert messages(307, keeper("/n/k", yaml("/m/k: {ros__parameters: {gain: 1}}"))) == []


def mover(name: str = "/n/k", **given: Any) -> Instance:
    ends = (end("publishes", "cmd_vel"), end("subscribes", "odom"))
    made = Interface(
        "n.py", endpoints=ends, whole=given.pop("whole", True), words=frozenset(given.pop("words", ()))
    )
    return node(name, interface=made, **given)


@pytest.mark.parametrize(
    ("old", "told"),
    [
        ("cmd_val", "; it uses cmd_vel, odom"),
        ("/cmd_vel", "; it uses cmd_vel, which is /n/cmd_vel here"),
        ("~odom", "; it uses odom, which is /n/odom here"),
        ("cmd_vel", None),
        ("/n/cmd_vel", None),
        ("_x", None),
        ("tf", None),
        ("/tf_static", None),
        ("$(arg x)", None),
        ("k:cmd_val", None),
    ],
)
def test_remapping_of_an_unused_name_is_reported(old, told):
    found = messages(308, mover(remaps=((old, "y"),)))
    assert found == (
        [] if told is None else [f"/n/k uses no name {old}, so renaming it to y has no effect{told}"]
    )


def test_remapping_of_a_possibly_used_name_is_not_reported():
    remaps = (("cmd_val", "y"),)
    assert messages(308, mover(remaps=remaps, whole=False)) == []
    for word in ("cmd_val", "/n/cmd_val", "n/cmd_val"):
        assert messages(308, mover(remaps=remaps, words=(word,))) == []
    for word in ("/x/cmd_val", "my_cmd_val", "/n/x/cmd_val"):
        assert len(messages(308, mover(remaps=remaps, words=(word,)))) == 1  # another name
    assert messages(308, node("/k", unread=True, remaps=remaps)) == []
    silent = node("/k", interface=Interface("n.py", whole=True), remaps=remaps)
    assert messages(308, silent) == ["/k uses no name cmd_val, so renaming it to y has no effect"]


def test_unused_remapping_of_a_group_is_reported_once():
    first, other = (
        mover("/k", remaps=(("cmd_val", "y"),), inherited=1),
        mover("/l", remaps=(("cmd_val", "y"),), inherited=1),
    )
    user = node("/m", end("publishes", "cmd_val"), remaps=(("cmd_val", "y"),), inherited=1)
    assert len(messages(308, first, other)) == 1
    assert messages(308, first, other, user) == []
    own = replace(user, node=replace(user.node, inherited=0))
    assert len(messages(308, first, other, own)) == 1


def test_an_absent_field_is_reported_once_for_each_program():
    made = Interface("n.py", misfits=(Misfit("Twist", "speed", AT, "f"), Misfit("Vector3", "xx", AT, "f")))
    assert messages(309, node("/a", interface=made), node("/b", interface=made), node("/c", unread=True)) == [
        "Twist has no field speed: it has linear, angular",
        "Vector3 has no field xx: did you mean x?",
    ]


def test_two_nodes_with_the_same_name_are_reported():
    first, second = node("/a", line=3), node("/a", line=9)
    said = ["/a is started twice, also at robot.launch:3: give each node its own name"]
    assert messages(310, first, second) == said
    assert messages(310, first, second, node("/a", line=11)) == said * 2
    assert messages(310, first, node("/n/a")) == []
    assert messages(310, first, second, file=Path()) == [], "the nodes of several launch files"
    for given in ({"event": True}, {"condition": "if x"}, {"anonymous": "anon"}):
        assert messages(310, first, node("/a", **given)) == []
    assert messages(310, node("/$(arg n)/a"), node("/$(arg n)/a")) == []
    nameless = replace(second, node=replace(second.node, name=""))
    assert messages(310, first, nameless) == []
    assert messages(310, first, replace(nameless, interface=Interface("n.py", name="a"))) == said
