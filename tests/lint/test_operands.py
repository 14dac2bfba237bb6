import pytest

from tests.lint.analysing import analysed, site

NODE = """
    import time
    import numpy as np
    import rospy
    from rclpy.node import Node
    GAIN = 2.5
    TABLE = {"p": 0.4, "i": 0.02}
    STEPS = (0.1, 0.2, 0.4)
    NAMES = ["low", "high"]
    PRESETS = {"indoor": {"p": 0.3, "label": "in"}, "outdoor": {"p": 0.6, "label": "out"}}
    class Arm:
        reach = 1.5
        def __init__(self, k, offset=0.25):
            self.k = k
            self.offset = offset
            self.moved = 0.0
    class Driver(Node):
        def __init__(self):
            super().__init__("driver")
            self.arm = Arm(0.75)
            self.last = 0.0
            self.declare_parameter("speed", 1.25)
            self.speed = self.get_parameter("speed").get_parameter_value().double_value
            self.declare_parameters("", [("pitch", 0.5), ("most", 4)])
            self.pitch = self.get_parameter("pitch").value
            one, other = self.declare_parameters(namespace="arm", parameters=[("a", 1.5), ("b", 2.5)])
            self.b = other.value
            self.limit = rospy.get_param("~limit", 9.0)
            self.free = rospy.get_param("~free")
            entries = rospy.get_param("~", {})
            self.tilt = entries.get("tilt", 0.35)
            self.swing = float(entries.get("swing", -3))
            self.title = entries.get("title", "arm")
            self.declare_parameter("side", "left")
            self.declare_parameter("grip", 0.45)
            self.side, self.grip = self.get("side"), self.get("grip")
            pid = rospy.get_param("~pid")
            self.p = pid["p"]
            self.i = float(pid["i"])
            self.d = int(pid.get("d"))
            self.table = rospy.get_param("~table")
            self.reach = rospy.get_param("~arms")["left"]["reach"]
            self.wrist = Arm(rospy.get_param("~wrist", {}).get("k", 0.15))
            self.preset = PRESETS[rospy.get_param("~preset", "indoor")]
            self.declare_parameter("mode", "outdoor")
            self.mode = PRESETS[self.get_parameter("mode").value]["p"]
            self.out = self.create_publisher(F, "b", 10)
            self.create_subscription(F, "a", self.on, 10)
        def get(self, name):
            return self.get_parameter(name).value
        def on(self, msg):
            self.last = msg.data
            v = {expression}
            self.out.publish(v)
"""


@pytest.mark.parametrize(
    ("expression", "operands"),
    [
        ("3 * msg.data", [("3", 3)]),
        ("-0.5 * msg.data + 2", [("-0.5", -0.5), ("2", 2)]),
        ("GAIN * msg.data", [("GAIN", 2.5)]),
        ("msg.data * self.arm.k", [("self.arm.k", 0.75)]),
        ("msg.data * self.arm.offset", [("self.arm.offset", 0.25)]),
        ("msg.data * self.arm.reach", [("self.arm.reach", 1.5)]),
        ("msg.data * TABLE['p']", [("TABLE['p']", 0.4)]),
        ("msg.data * self.speed", [("self.speed", 1.25)]),
        ("msg.data * self.pitch", [("self.pitch", 0.5)]),
        ("msg.data * self.b", [("self.b", 2.5)]),
        ("min(msg.data, self.limit)", [("self.limit", 9.0)]),
        ("msg.data * np.cos(self.arm.k)", [("self.arm.k", 0.75)]),
        ("msg.data * float(abs(GAIN))", [("GAIN", 2.5)]),
        ("msg.data * self.free", [("self.free", None)]),
        ("msg.data * self.tilt", [("self.tilt", 0.35)]),
        ("msg.data * self.swing", [("self.swing", -3)]),
        ("msg.data * self.wrist.k", [("self.wrist.k", 0.15)]),
        ("msg.data * self.p + self.i", [("self.p", None), ("self.i", None)]),
        ("msg.data * self.d", [("self.d", None)]),
        ("msg.data * self.table['far']", [("self.table['far']", None)]),
        ("msg.data * self.reach", [("self.reach", None)]),
        ("msg.data * self.grip if self.side in msg.name else 0.0", [("self.grip", 0.45), ("0.0", 0.0)]),
        ("[self.title, self.preset['label'], msg.data]", []),
        ("msg.data * self.preset['p']", [("self.preset['p']", None)]),
        ("msg.data * self.mode", [("self.mode", None)]),
        ("(lambda x, g=0.125: g * x)(msg.data)", []),
        ("msg.data if msg.data > 0.1 else True", [("0.1", 0.1), ("True", True)]),
        ("msg.ranges[3]", []),
        ("msg.ranges[1:4]", []),
        ("msg.data + np.zeros(3)", []),
        ("f'{msg.data:.2f} of {10}'", []),
        ("msg.data * TABLE[msg.axis]", [("TABLE[msg.axis]", None)]),
        ("STEPS[int(msg.data)]", [("STEPS[int(msg.data)]", None)]),
        ("NAMES[msg.axis]", []),
        ("msg.data * self.last", []),
        ("msg.data * time.time()", []),
    ],
)
def test_operands_are_the_constants_that_a_site_uses(tmp_path, expression, operands):
    analysis = analysed(tmp_path, node=NODE.replace("{expression}", expression))
    step = next(s for s in analysis.sites if s.code.startswith("v = "))
    found = analysis.operands(step.site)
    assert [(o.code, o.value) for o in found] == operands
    for operand in found:
        assert operand.span.line == step.span.line
        line = analysis.sources[operand.span.path].split("\n")[operand.span.line - 1]
        assert line[operand.span.column - 1 : operand.span.end_column - 1] == operand.code
        assert operand.literal == (operand.code[-1].isdigit() or operand.code == "True")


@pytest.mark.parametrize(
    ("expression", "definition"),
    [
        ("self.p", 'pid["p"]'),
        ("self.i", 'pid["i"]'),
        ("self.d", 'pid.get("d")'),
        ("self.reach", 'rospy.get_param("~arms")["left"]["reach"]'),
        ("self.table['far']", "self.table['far']"),
        ("self.free", 'rospy.get_param("~free")'),
    ],
)
def test_an_entry_of_a_parameter_is_a_constant_of_its_own(tmp_path, expression, definition):
    analysis = analysed(tmp_path, node=NODE.replace("{expression}", f"msg.data * {expression}"))
    step = next(s for s in analysis.sites if s.code.startswith("v = "))
    (operand,) = analysis.operands(step.site)
    span = operand.definition
    line = analysis.sources[span.path].split("\n")[span.line - 1]
    assert line[span.column - 1 : span.end_column - 1] == definition


PARTIAL = """
from functools import partial
import rospy
from std_msgs.msg import Float64
LOW = -1.5
def clamp(value, low, high):
    return max(low, min(high, value))
def scaled(factor, value):
    return factor * value
bounded = partial(clamp, low=LOW, high=1.25)
halved = partial(scaled, 0.5)
class Keeper:
    def __init__(self):
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.on)
    def on(self, msg):
        self.out.publish(bounded(msg.data){more})
rospy.init_node("keeper")
Keeper()
rospy.spin()
"""


def test_arguments_that_a_partial_function_stores_are_constants(tmp_path):
    analysis = analysed(tmp_path, node=PARTIAL.replace("{more}", " + halved(msg.data)"))
    found = {
        o.code: (o.value, o.definition.line) for step in analysis.sites for o in analysis.operands(step.site)
    }
    assert found == {"low": (-1.5, 5), "high": (1.25, 10), "factor": (0.5, 11)}


def test_if_a_function_is_called_in_several_ways_the_stored_arguments_are_constants_of_the_partial_function(
    tmp_path,
):
    analysis = analysed(tmp_path, node=PARTIAL.replace("{more}", " + clamp(msg.data, low=-0.1, high=0.2)"))
    every = [o for step in analysis.sites for o in analysis.operands(step.site)]
    assert [(o.code, o.value, len(o.definitions)) for o in every] == [
        *[("low", None, 2), ("high", None, 2)],
        *[("-0.1", -0.1, 0), ("0.2", 0.2, 0)],
    ]
    made = {o.code: o.value for site in analysis.making for o in analysis.operands(site)}
    assert made == {"LOW": -1.5, "1.25": 1.25}


def test_a_named_constant_refers_to_its_definition(tmp_path):
    analysis = analysed(tmp_path, node=NODE.replace("{expression}", "GAIN * msg.data"))
    (operand,) = analysis.operands(next(s.site for s in analysis.sites if s.code.startswith("v = ")))
    assert operand.definition is not None
    assert operand.definition.line == 6


def test_a_parameter_with_different_arguments_has_no_value(tmp_path):
    analysis = analysed(
        tmp_path,
        node="""
        import rospy
        def send(gain, x):
            y = gain * x
            out.publish(y)
        def on(msg):
            send(2.0, msg.data)
            send(3.0, msg.data)
        out = rospy.Publisher("b", F)
        rospy.Subscriber("a", F, on)
        """,
    )
    (operand,) = analysis.operands(site(analysis, "y = gain * x"))
    assert (operand.code, operand.value, operand.definition) == ("gain", None, None)
    assert [(span.line, span.column) for span in operand.definitions] == [(7, 10), (8, 10)]


def test_limit_is_an_operand_but_the_limited_value_is_not(tmp_path):
    analysis = analysed(
        tmp_path,
        node="""
        import json
        import rospy
        with open("settings.json") as file:
            SETTINGS = json.load(file)
        class Tracker:
            def __init__(self, settings):
                self.focal = settings["focal"]
                self.most = settings["most"]
            def estimate(self, height):
                distance = self.focal / height
                distance = min(distance, self.most)
                return distance
        tracker = Tracker(SETTINGS)
        def on(msg):
            out.publish(tracker.estimate(msg.data))
        out = rospy.Publisher("b", F)
        rospy.Subscriber("a", F, on)
        """,
    )
    found = {(o.site.text, o.code, o.setting) for s in analysis.sites for o in analysis.operands(s.site)}
    assert found == {
        ("distance = self.focal / height", "self.focal", "focal"),
        ("distance = min(distance, self.most)", "self.most", "most"),
    }


def test_a_value_that_messages_change_is_not_an_operand(tmp_path):
    analysis = analysed(
        tmp_path,
        node="""
        import rospy
        GAIN = 2.0
        def bounded(value, most):
            return most if value > most else value
        class Steering:
            def __init__(self):
                self.error = 0.0
                rospy.Subscriber("a", F, self.on)
                self.out = rospy.Publisher("b", F)
            def on(self, msg):
                self.error = msg.data
            def wanted(self):
                turn = 0.0
                if self.error:
                    turn = -GAIN * self.error
                    turn = bounded(turn, 1.5)
                return (turn, 1.0)
            def run(self):
                while not rospy.is_shutdown():
                    turn, speed = self.wanted()
                    self.out.publish(turn)
        Steering().run()
        """,
    )
    found = {(o.code, o.value) for step in analysis.sites for o in analysis.operands(step.site)}
    assert ("GAIN", 2.0) in found
    assert not {code for code, _ in found} & {"turn", "value", "self.error"}


def test_conditions_have_operands_like_other_statements(tmp_path):
    analysis = analysed(
        tmp_path,
        node="""
        import rospy
        NEAR = 0.3
        def on(msg):
            if msg.data < NEAR:
                out.publish(1.0)
        out = rospy.Publisher("b", F)
        rospy.Subscriber("a", F, on)
        """,
    )
    assert [o.code for o in analysis.operands(site(analysis, "if msg.data < NEAR:"))] == ["NEAR"]
    assert [o.code for o in analysis.operands(site(analysis, "out.publish(1.0)"))] == ["1.0"]


WAITING = """
    import rospy
    PAUSE = 0.5
    RATE = 10
    class Turner:
        def __init__(self):
            self.period = 0.2
            self.out = rospy.Publisher("b", F, queue_size=3)
            self.timer = {timer}
            rospy.Subscriber("a", F, self.on)
        def on(self, msg):
            self.out.publish(msg.data)
            {waits}
    """


@pytest.mark.parametrize(
    ("timer", "waits", "operands"),
    [
        ("None", "rospy.sleep(PAUSE)", [("PAUSE", 0.5)]),
        ("None", "rospy.sleep(2.0 * PAUSE)", [("2.0", 2.0), ("PAUSE", 0.5)]),
        ("None", "rospy.sleep(msg.data / PAUSE)", [("PAUSE", 0.5)]),
        ("None", "time.sleep(self.period)", [("self.period", 0.2)]),
        ("rospy.Timer(rospy.Duration(self.period), self.on)", "pass", [("self.period", 0.2)]),
        ("self.create_timer(0.1, self.on)", "pass", [("0.1", 0.1)]),
        ("self.create_timer(callback=self.on, timer_period_sec=self.period)", "pass", [("self.period", 0.2)]),
        ("rospy.Rate(RATE)", "self.timer.sleep()", [("RATE", 10)]),
    ],
)
def test_waiting_times_and_rates_outside_of_flows_are_operands(tmp_path, timer, waits, operands):
    analysis = analysed(tmp_path, node=WAITING.replace("{timer}", timer).replace("{waits}", waits))
    found = [o for step in analysis.timing for o in analysis.operands(step.site)]
    assert [(o.code, o.value) for o in found] == operands
    assert not {step.site for step in analysis.timing} & {step.site for step in analysis.sites}


PASSED = """
    import rospy
    KEYS = ("pitch", "most")
    TABLE = {"pitch": 0.125, "most": 1.75}
    PAIR = (0.125, 1.75)
    class Spiral:
        def __init__(self, pitch, most, turns=3):
            self.pitch = pitch
            self.most = most
    class Node:
        def __init__(self):
            self.cfg = {"arm.pitch": 0.125, "arm.most": 1.75}
            self.copy = {key: value for key, value in [("pitch", 0.125), ("most", 1.75)]}
            {before}
            self.spiral = None
            self.out = rospy.Publisher("b", F)
            rospy.Subscriber("a", F, self.on)
        def on(self, msg):
            if msg.go:
                self.spiral = {made}
            v = msg.data * self.spiral.most
            self.out.publish(v)
"""
DECLARED = 'self.given = self.declare_parameters("", [("arm.pitch", 0.125), ("arm.most", 1.75)])'


@pytest.mark.parametrize(
    ("made", "before"),
    [
        ("Spiral(*[0.125, 1.75])", "pass"),
        ("Spiral(*PAIR)", "pass"),
        ("Spiral(0.125, *[1.75])", "pass"),
        ("Spiral(*[0.125], most=1.75)", "pass"),
        ("Spiral(*[0.125], 1.75)", "pass"),
        ("Spiral(*[TABLE[key] for key in KEYS])", "pass"),
        ("Spiral(*(self.cfg[f'arm.{key}'] for key in KEYS))", "pass"),
        ("Spiral(*(self.copy[key] for key in ('pitch', 'most')))", "pass"),
        ("Spiral(**TABLE)", "pass"),
        ("Spiral(*self.kept)", "self.kept = [0.125, 1.75]"),
        ("Spiral(*[one.value for one in self.given])", DECLARED),
        (
            "Spiral(*(self.all[f'arm.{key}'] for key in ('pitch', 'most')))",
            DECLARED.replace("self.given = ", "self.all = {one.name: one.value for one in ") + "}",
        ),
    ],
)
def test_unpacked_argument_is_an_operand_at_its_use(tmp_path, made, before):
    text = PASSED.replace("{made}", made).replace("{before}", before)
    text = text.replace("class Node:", "from rclpy.node import Node\n    class Arm(Node):")
    analysis = analysed(tmp_path, node=text)
    found = analysis.operands(site(analysis, "v = msg.data * self.spiral.most"))
    assert [(one.code, one.value) for one in found] == [("self.spiral.most", 1.75)]


def deciding_operands(directory, text):
    analysis = analysed(directory, node=text)
    known = {step.site for step in analysis.sites}
    assert known.isdisjoint(step.site for step in analysis.deciding)
    return {
        step.code.split("\n")[0]: [(one.code, one.value) for one in analysis.operands(step.site)]
        for step in analysis.deciding
    }


def test_watchdog_limit_is_an_operand_without_messages(tmp_path):
    found = deciding_operands(
        tmp_path,
        """
        import rclpy
        from rclpy.duration import Duration
        from rclpy.node import Node
        class Heartbeat:
            patience = 0.6
            def __init__(self):
                self.last = None
            def beat(self, now):
                self.last = now
            def alive(self, now):
                return self.last is not None and now - self.last < Duration(seconds=self.patience)
        class Truck(Node):
            def __init__(self):
                super().__init__("truck")
                self.heart = Heartbeat()
                self.speed = 0.25
                self.out = self.create_publisher(F, "b", 10)
                self.create_subscription(Empty, "beat", self.beat, 10)
                self.create_subscription(F, "a", self.on, 10)
            def beat(self, _msg):
                self.heart.beat(self.get_clock().now())
            def on(self, msg):
                v = 2.0 * msg.data if self.heart.alive(self.get_clock().now()) else 0.0
                self.out.publish(v)
        """,
    )
    limit = "return self.last is not None and now - self.last < Duration(seconds=self.patience)"
    assert found[limit] == [("self.patience", 0.6)]
    assert not any(code.startswith("patience") for code in found)  # the definition of a constant is not a use


def test_set_points_and_waiting_times_are_operands_without_messages(tmp_path):
    found = deciding_operands(
        tmp_path,
        """
        import rospy
        CREEP = 0.3
        WARM_UP = 4.0
        began = None
        def pace():
            if rospy.get_time() - began < WARM_UP:
                return CREEP
            return 1.5
        def on(msg):
            v = msg.data + 1.0
            out.publish(v)
        began = rospy.get_time()
        out = rospy.Publisher("b", F)
        speed = rospy.Publisher("c", F)
        idle = rospy.Publisher("d", F)
        rospy.Subscriber("a", F, on)
        while not rospy.is_shutdown():
            wanted = pace()
            speed.publish(wanted)
            unused = 7.0
        """,
    )
    assert found["if rospy.get_time() - began < WARM_UP:"] == [("WARM_UP", 4.0)]
    assert found["return CREEP"] == [("CREEP", 0.3)]
    assert found["return 1.5"] == [("1.5", 1.5)]
    assert "unused = 7.0" not in found
    assert "v = msg.data + 1.0" not in found


TABLES = """
    import rospy
    DEFAULTS = {"fast": 0.9, "slow": 0.125}
    class Feeder:
        def __init__(self, params):
            self.p = params
            self.out = rospy.Publisher("b", F, queue_size=1)
            rospy.Subscriber("a", F, self.on)
            self.last = 0.0
        def on(self, msg):
            self.last = msg.data
        def drive(self):
            p = self.p
            v = self.last * p["slow"]
            return v
        def step(self):
            self.out.publish(self.drive())
    def main():
        rospy.init_node("feeder")
        params = {made}
        feeder = Feeder(params)
        while not rospy.is_shutdown():
            feeder.step()
    main()
"""


@pytest.mark.parametrize(
    "made",
    [
        "DEFAULTS",
        "dict(DEFAULTS)",
        "DEFAULTS.copy()",
        "{**DEFAULTS}",
        "dict(DEFAULTS, fast=0.8)",
        "{**DEFAULTS, **rospy.get_param('~', {})}",
        "dict(DEFAULTS, **rospy.get_param('~', {}))",
    ],
)
def test_constant_table_is_found_through_mutual_calls(tmp_path, made):
    analysis = analysed(tmp_path, node=TABLES.replace("{made}", made))
    found = analysis.operands(site(analysis, "v = self.last * p['slow']"))
    assert [(operand.code, operand.value) for operand in found] == [('p["slow"]', 0.125)]
