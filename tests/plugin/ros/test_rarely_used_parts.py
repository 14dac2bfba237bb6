"""Parts of the stand-ins that few nodes use: what they publish, return and remember."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.ros import message_type, sound_play
from pytest_tarl.ros.rclpy.event_handler import PublisherEventCallbacks
from pytest_tarl.ros.rclpy.lifecycle.entities import SimpleManagedEntity
from pytest_tarl.ros.smach.errors import InvalidUserCodeError
from pytest_tarl.ros.smach.userdata import Remapper, UserData
from pytest_tarl.ros.sound_play import Sound, SoundClient
from tests.plugin.ros.conftest import Start, heard

# sound_play


class Sent(SoundClient):
    """A sound client that keeps its requests."""

    def __init__(self) -> None:
        self.sent: list[tuple[Any, ...]] = []

    def sendMsg(  # noqa: N802
        self, snd: int, cmd: int, s: str, arg2: str = "", vol: float = 1.0, **kwargs: Any
    ) -> None:
        self.sent.append((snd, cmd, s, arg2, vol, kwargs))


@pytest.mark.parametrize(
    ("method", "given", "sent"),
    [
        ("say", ("hi", "voice", 0.5), (-3, 1, "hi", "voice", 0.5)),
        ("repeat", ("hi", 0.5), (-3, 2, "hi", "", 0.5)),
        ("stopSaying", ("hi",), (-3, 0, "hi", "", 1.0)),
        ("playWave", ("a.wav", 0.5), (-2, 1, "a.wav", "", 0.5)),
        ("startWave", ("a.wav", 0.5), (-2, 2, "a.wav", "", 0.5)),
        ("stopWave", ("a.wav",), (-2, 0, "a.wav", "", 1.0)),
        ("playWaveFromPkg", ("pkg", "a.wav", 0.5), (-2, 1, "a.wav", "pkg", 0.5)),
        ("startWaveFromPkg", ("pkg", "a.wav", 0.5), (-2, 2, "a.wav", "pkg", 0.5)),
        ("stopWaveFromPkg", ("a.wav", "pkg"), (-2, 0, "a.wav", "pkg", 1.0)),
        ("play", (3, 0.5), (3, 1, "", "", 0.5)),
        ("start", (3, 0.5), (3, 2, "", "", 0.5)),
        ("stop", (3,), (3, 0, "", "", 1.0)),
        ("stopAll", (), (-1, 0, "", "", 1.0)),
    ],
)
def test_each_method_of_a_sound_client_sends_its_request(
    method: str, given: tuple[Any, ...], sent: tuple[Any, ...]
) -> None:
    client = Sent()
    getattr(client, method)(*given)
    assert client.sent == [(*sent, {})]
    if "stop" not in method:
        client.sent.clear()
        getattr(client, method)(*given, blocking=True)
        assert client.sent == [(*sent, {"blocking": True})]


@pytest.mark.parametrize(
    ("make", "sent"),
    [
        (lambda client: client.voiceSound("hi", 0.5), (-3, "hi", 0.5)),
        (lambda client: client.waveSound("a.wav", 0.5), (-2, "a.wav", 0.5)),
        (lambda client: client.builtinSound(4, 0.5), (4, "", 0.5)),
        (lambda client: Sound(client, 4, "a", volume=0.5), (4, "a", 0.5)),
    ],
)
def test_a_sound_is_played_repeated_and_stopped(make: Any, sent: tuple[Any, ...]) -> None:
    client = Sent()
    sound = make(client)
    sound.play(blocking=True)
    sound.repeat(replace=False)
    sound.stop()
    number, text, volume = sent
    assert client.sent == [
        (number, 1, text, "", volume, {"blocking": True}),
        (number, 2, text, "", volume, {"replace": False}),
        (number, 0, text, "", volume, {}),
    ]


@pytest.mark.parametrize(("volume", "sent"), [(0.5, 0.5), (1.5, 1.0), (-1.0, 0.0)])
@pytest.mark.parametrize("blocking", [False, True])
@pytest.mark.parametrize("served", [True, False])
def test_only_a_blocking_request_is_sent_as_a_goal(
    volume: float, sent: float, blocking: bool, served: bool
) -> None:
    client = SoundClient.__new__(SoundClient)
    published: list[Any] = []
    goals: list[Any] = []
    client._blocking = blocking
    client.pub = SimpleNamespace(publish=published.append)  # type: ignore[assignment]
    client.actionclient = SimpleNamespace(wait_for_server=lambda: served, send_goal_and_wait=goals.append)  # type: ignore[assignment]
    client.sendMsg(3, 1, "text", "more", volume)
    client.sendMsg(4, 1, "text", blocking=not blocking)
    goals = [goal.sound_request for goal in goals]
    first, second = (goals, published) if blocking else (published, goals)
    assert [one.sound for one in first] == ([3] if served or not blocking else [])
    assert [one.sound for one in second] == ([4] if served or blocking else [])
    for one in first:
        assert (one.command, one.arg, one.arg2, one.volume) == (1, "text", "more", sent)
    assert sound_play.SoundClient is SoundClient


# userdata of smach


def test_userdata_are_copied_and_extracted_under_other_names() -> None:
    one, other = UserData(), UserData()
    one.speed = 2
    one["mode"] = "auto"
    other.old = 0
    other.update(one)
    assert sorted(other.keys()) == ["mode", "old", "speed"]
    part = one.extract(["speed", "missing"], {"speed": "pace"})
    assert (part.keys(), part.pace, "pace" in part) == (["pace"], 2, True)
    with pytest.raises(KeyError):
        print(one.missing)
    with pytest.raises(AttributeError):
        print(one._missing)


def test_state_reads_input_keys_and_writes_output_keys() -> None:
    all_ = UserData()
    all_.pace, all_.hidden, all_.log = 2, 9, []
    seen = Remapper(all_, ["speed", "log", "absent"], ["result"], {"speed": "pace", "result": "outcome"})
    assert (seen.keys(), seen.speed, seen["log"]) == (["log", "speed"], 2, [])
    assert ("speed" in seen, "pace" in seen, "absent" in seen) == (True, False, False)
    seen.result = 5
    assert all_.outcome == 5
    with pytest.raises(InvalidUserCodeError, match=r"'hidden'.*\['absent', 'log', 'speed'\]"):
        print(seen.hidden)
    with pytest.raises(InvalidUserCodeError, match=r"'speed'.*\['result'\]"):
        seen["speed"] = 1
    with pytest.raises(AttributeError):
        print(seen._other)


# lifecycle nodes


def test_a_method_runs_only_while_its_entity_is_enabled() -> None:
    log: list[Any] = []

    class Entity(SimpleManagedEntity):
        @SimpleManagedEntity.when_enabled
        def one(self, value: int, *, more: int = 0) -> None:
            log.append((value, more))

        @SimpleManagedEntity.when_enabled(when_not_enabled=lambda: log.append("off"))
        def other(self) -> None:
            log.append("on")

    entity: Any = Entity()
    state: Any = None
    for change in (lambda _: None, entity.on_activate, entity.on_deactivate):
        change(state)
        entity.one(3, more=4)
        entity.other()
    assert log == ["off", (3, 4), "on", "off"]
    assert entity.is_activated is False


LIFECYCLE = """
    import rclpy
    from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
    from std_msgs.msg import String
    rclpy.init()
    log = []
    class Robot(LifecycleNode):
        def on_configure(self, state):
            log.append(("configure", state.state_id, state.label))
            return super().on_configure(state)
        def on_error(self, state):
            log.append(("error", state.label))
            return TransitionCallbackReturn.SUCCESS
        def on_cleanup(self, state):
            log.append(("cleanup", state.label))
            return TransitionCallbackReturn.SUCCESS
        def on_shutdown(self, state):
            log.append(("shutdown", state.label))
            return TransitionCallbackReturn.SUCCESS
    node = Robot("robot")
    publisher = node.create_lifecycle_publisher(String, "out", 1)
    other = node.create_lifecycle_publisher(String, "gone", 1)
    made = []
    made.append(node.destroy_lifecycle_publisher(other))
    made.append(len(node._managed_entities))
    steps = []
    for name in ("configure", "activate", "deactivate", "cleanup", "activate", "configure", "shutdown"):
        publisher.publish(String(data=name))
        steps.append((name, getattr(node, "trigger_" + name)().name))
    publisher.publish(String(data="late"))
    try:
        node.trigger_shutdown()
    except Exception as error:
        steps.append(type(error).__name__)
    from lifecycle_msgs.srv import GetAvailableStates, GetAvailableTransitions
    states = node._get_available_states(None, GetAvailableStates.Response()).available_states
    found = {one.id: one.label for one in states}
    fresh = Robot("fresh", enable_communication_interface=False)
    answer = fresh._get_available_transitions(None, GetAvailableTransitions.Response()).available_transitions
    offered = [(one.transition.id, one.transition.label, one.start_state.id, one.start_state.label,
                one.goal_state.id, one.goal_state.label) for one in answer]
    rclpy.shutdown()
"""


def test_lifecycle_node_publishes_only_while_active(start: Start) -> None:
    ros = start(LIFECYCLE)
    assert ros.namespace["made"] == [True, 1]
    success = "SUCCESS"
    assert ros.namespace["steps"] == [
        ("configure", success),
        ("activate", success),
        ("deactivate", success),
        ("cleanup", success),
        ("activate", "ERROR"),  # it is not configured
        ("configure", success),
        ("shutdown", success),
        "RCLError",
    ]
    assert ros.namespace["log"] == [
        ("configure", 1, "unconfigured"),
        ("cleanup", "inactive"),
        ("configure", 1, "unconfigured"),
        ("shutdown", "inactive"),
    ]
    assert ros.bus.latest("/out").data == "deactivate"
    labels = ros.namespace["found"]
    assert (labels[1], labels[2], labels[3], labels[4]) == ("unconfigured", "inactive", "active", "finalized")
    assert sorted(ros.namespace["offered"]) == [
        (1, "configure", 1, "unconfigured", 10, "configuring"),
        (5, "shutdown", 1, "unconfigured", 12, "shuttingdown"),
    ]


# event callbacks of rclpy


def test_unknown_event_callbacks_are_refused() -> None:
    def late() -> None:
        pass

    made: Any = PublisherEventCallbacks(deadline=late, use_default_callbacks=False)
    assert (made.deadline, made.liveliness, made.use_default_callbacks) == (late, None, False)
    assert PublisherEventCallbacks().use_default_callbacks is True
    with pytest.raises(TypeError, match="nonsense"):
        PublisherEventCallbacks(deadline=late, nonsense=late)


# containers of smach

CONTAINERS = """
    import rospy, smach
    rospy.init_node("machine")
    log = []
    class Say(smach.State):
        def __init__(self, name, outcome="done", keys=()):
            super().__init__(outcomes=["done", "other"], input_keys=["item", *keys], output_keys=["item", *keys])
            self.name, self.outcome = name, outcome
        def execute(self, ud):
            log.append((self.name, self.preempt_requested()))
            if self.preempt_requested():
                self.service_preempt()
            for key in self.get_registered_output_keys():
                if key != "item":
                    ud[key] = self.name
            return self.outcome
    def ended(ud, states, outcome, *more):
        log.append(("ended", list(states), outcome, *more))
    both = smach.Concurrence(outcomes=["all", "some"], default_outcome="some", output_keys=["left", "unset"],
                             outcome_map={"all": {"A": "done", "B": "done"}})
    with both:
        smach.Concurrence.add("A", Say("a", keys=["left"]))
        smach.Concurrence.add("B", Say("b"))
    both.register_termination_cb(ended, ["extra"])
    chain = smach.StateMachine(outcomes=["done", "other"], input_keys=["in"], output_keys=["right", "unset"])
    with chain:
        smach.StateMachine.add_auto("ONE", Say("one"), ["done"])
        smach.StateMachine.add("TWO", Say("two", keys=["right"]))
    extra = smach.UserData()
    extra.more = 7
    chain.set_initial_state(["ONE"], extra)
    result = smach.UserData()
    result["in"] = 3
    outcomes = [both.execute(result), chain.execute(result)]
    kept = {key: result[key] for key in sorted(result.keys())}
    inside = (chain.userdata.more, chain.userdata["in"])
    preempted = []
    for container in (both, chain):
        container.request_preempt()
        before = container.preempt_requested()
        container.execute(smach.UserData())
        preempted.append((before, container.preempt_requested()))
    turns = smach.Iterator(outcomes=["done", "stopped"], input_keys=[], output_keys=["it_data"], it=[4, 5, 6])
    class Use(smach.State):
        def __init__(self):
            super().__init__(outcomes=["go", "halt"], input_keys=["it_data"])
        def execute(self, ud):
            log.append(ud.it_data)
            return "halt" if ud.it_data == 5 else "go"
    with turns:
        smach.Iterator.set_contained_state("USE", Use(), loop_outcomes=["go"], break_outcomes=["halt"],
                                           final_outcome_map={"halt": "stopped"})
    last = smach.UserData()
    outcomes.append(turns.execute(last))
    outcomes.append(last.it_data)
    turns.request_preempt()
    turns.execute(smach.UserData())
    preempted.append((True, turns.preempt_requested()))
"""


def test_containers_run_states_and_pass_on_values(start: Start) -> None:
    ros = start(CONTAINERS)
    found = ros.namespace
    assert found["outcomes"] == ["all", "done", "stopped", 5]
    assert found["kept"] == {"in": 3, "left": "a", "right": "two"}
    assert found["inside"] == (7, 3)
    assert found["log"][:5] == [
        ("a", False),
        ("b", False),
        ("ended", ["A", "B"], "all", "extra"),
        ("one", False),
        ("two", False),
    ]
    assert found["preempted"] == [(True, False)] * 3
    assert [one for one in found["log"] if isinstance(one, int)][:2] == [4, 5]
    # the machine passes the request on to its first state, the concurrence to both
    assert [one for one in found["log"] if one in (("a", True), ("b", True), ("one", True))]


def test_an_iterator_needs_a_state_whose_final_outcomes_exist(start: Start) -> None:
    ros = start("""
        import rospy, smach
        rospy.init_node("node")
        said = []
        for final in (None, {"halt": "gone"}, {}, {"halt": "done"}):
            made = smach.Iterator(["done"], [], [])
            if final is not None:
                with made:
                    smach.Iterator.set_contained_state("USE", smach.State(["go", "halt"]), break_outcomes=["halt"],
                                                       final_outcome_map=final)
            try:
                made.check_consistency()
                said.append("")
            except smach.InvalidTransitionError as error:
                said.append(str(error))
    """)
    assert ros.namespace["said"] == [
        "No contained state of the iterator was set.",
        "The iterator has no outcome 'gone'.",
        "The iterator has no outcome 'halt'.",
        "",
    ]


# rospy

ROSPY = """
    import rospy
    from std_msgs.msg import Float64, Header, String
    from geometry_msgs.msg import Point, PointStamped
    rospy.init_node("node")
    log = []
    class Listener(rospy.SubscribeListener):
        def peer_subscribe(self, name, publish, to_peer):
            log.append(("joined", name))
        def peer_unsubscribe(self, name, count):
            log.append(("left", name, count))
    out = rospy.Publisher("/out", Float64, subscriber_listener=Listener(), queue_size=1)
    stamped = rospy.Publisher("/robot/stamped", PointStamped, queue_size=1)
    one = rospy.Subscriber("/out", Float64, print)
    rospy.sleep(0.1)
    counts = [out.get_num_connections(), one.get_num_connections()]
    one.unregister()
    rospy.sleep(0.1)
    counts += [out.get_num_connections()]
    topics = [rospy.get_published_topics(), rospy.get_published_topics("/robot")]
    try:
        stamped.publish(Point())
    except Exception as error:
        said = type(error).__name__, str(error)
    stamped.publish(Header(frame_id="map"), Point(1, 2, 3))
    rospy.sleep(1000.0)
"""


def test_publishers_know_their_peers_and_their_types(start: Start) -> None:
    ros = start(ROSPY)
    seen = heard(ros, "/robot/stamped")
    ros.step(1.0)
    found = ros.namespace
    assert found["log"] == [("joined", "/out"), ("left", "/out", 0)]
    assert found["counts"] == [2, 2, 1]
    everything, some = found["topics"]
    assert ["/out", "std_msgs/Float64"] in everything
    assert some == [["/robot/stamped", "geometry_msgs/PointStamped"]]
    name, text = found["said"]
    assert (name, "expected [std_msgs/Header] but got [geometry_msgs/Point]" in text) == ("TypeError", True)
    assert [(one.header.frame_id, one.point.z) for one in seen] == [("map", 3.0)]


def test_the_messages_of_a_busy_subscriber_wait_in_order(start: Start) -> None:
    ros = start("""
        import rospy
        from std_msgs.msg import Float64
        rospy.init_node("node")
        seen = []
        def slow(message):
            seen.append(message.data)
            rospy.sleep(0.5)
        rospy.Subscriber("/in", Float64, slow)
        rospy.spin()
    """)
    for number in range(3):
        ros.bus.publish("/in", message_type("std_msgs/Float64")(float(number)))
    ros.step(0.1)
    assert ros.namespace["seen"] == [0.0]
    ros.step(2.0)
    assert ros.namespace["seen"] == [0.0, 1.0, 2.0]


# parameters and the tools


def test_rosparam_prints_what_it_loads_and_deletes(start: Start, capsys: pytest.CaptureFixture[str]) -> None:
    ros = start("""
        import rosparam, rospy
        rospy.init_node("node")
        rosparam.upload_params("/robot", {"speed": 2.0}, verbose=True)
        before = rospy.get_param("/robot/speed")
        rosparam.delete_param("/robot/speed", verbose=True)
        after = rospy.has_param("/robot/speed")
        try:
            rosparam.delete_param("/robot/speed")
        except Exception as error:
            said = type(error).__name__
        rospy.set_param("/robot/a", 1)
        names = rospy.get_param_names()
        rospy.delete_param("/robot/a")
        try:
            rospy.delete_param("/robot/a")
        except KeyError as error:
            missing = True
        rospy.sleep(1000.0)
    """)
    found = ros.namespace
    assert (found["before"], found["after"], found["said"], found["missing"]) == (
        2.0,
        False,
        "RosParamException",
        True,
    )
    assert "/robot/a" in found["names"]
    printed = capsys.readouterr().out
    assert "set parameter [/robot] to [{'speed': 2.0}]" in printed
    assert "deleted parameter [/robot/speed]" in printed


def test_container_continues_after_a_callback_error(start: Start) -> None:
    ros = start("""
        import rospy, smach
        rospy.init_node("node")
        machine = smach.StateMachine(outcomes=["done"])
        class One(smach.State):
            def __init__(self):
                super().__init__(outcomes=["done"])
            def execute(self, ud):
                return "done"
        with machine:
            smach.StateMachine.add("ONE", One())
        def odd(ud, states):
            raise ValueError("odd")
        machine.register_start_cb(odd)
        outcome = machine.execute()
        rospy.sleep(1000.0)
    """)
    assert ros.namespace["outcome"] == "done"


# actionlib

SERVER = """
    import actionlib, rospy
    from actionlib.msg import TestAction, TestGoal
    rospy.init_node("node")
    log = []
    def accept(handle):
        log.append("goal")
        handle.set_accepted()
    def cancel(handle):
        log.append("cancel")
        handle.set_canceled()
    server = actionlib.ActionServer("act", TestAction, print, auto_start=True)
    server.register_goal_callback(accept)
    server.register_cancel_callback(cancel)
    client = actionlib.ActionClient("act", TestAction)
    ready = client.wait_for_server(rospy.Duration(1.0))
    handles = [client.send_goal(TestGoal(goal=number)) for number in (1, 2)]
    rospy.sleep(0.2)
    early = handles[0].get_terminal_state()
    client.cancel_all_goals()
    rospy.sleep(1.0)
    states = [(one.get_goal_status(), one.get_terminal_state()) for one in handles]
    handles.append(client.send_goal(TestGoal(goal=3)))
    rospy.sleep(0.2)
    client.cancel_goals_at_and_before_time(rospy.Time.now())
    rospy.sleep(1.0)
    states.append((handles[2].get_goal_status(), handles[2].get_terminal_state()))
    server.stop()
    gone = client.wait_for_server(rospy.Duration(0.5))
    client.stop()
    ids = actionlib.GoalIDGenerator("maker")
    first, second = ids.generate_ID(), ids.generate_ID()
    rospy.sleep(1000.0)
"""


def test_goals_are_cancelled_together_or_up_to_a_time(start: Start) -> None:
    ros = start(SERVER)
    ros.step(5.0)
    found = ros.namespace
    assert (found["ready"], found["early"]) == (True, 9)  # LOST: the goal has not ended
    assert found["log"] == ["goal", "goal", "cancel", "cancel", "goal", "cancel"]
    assert found["states"] == [(2, 2)] * 3  # PREEMPTED
    assert found["gone"] is False
    first, second = found["first"].id, found["second"].id
    assert first.startswith("maker-4-")
    assert second.startswith("maker-5-")
