from textwrap import dedent

from tarl_lint.engine import analyse
from tarl_lint.prefilter.by_words import relevant
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config
from tarl_lint.settings.schema import Wrapper


def module(name, text, path=None):
    parsed = parse(path or f"{name.replace('.', '/')}.py", dedent(text).encode(), name)
    assert isinstance(parsed, Module)
    return parsed


NODE = """
    import rospy
    import bus
    from tools import clean, helper
    def on(msg):
        pub.publish({value})
    pub = rospy.Publisher("b", F)
    rospy.Subscriber("a", F, on)
    """


def kinds(*modules, **settings):
    return [(f.kind, f.source.topics, f.sink.topics) for f in analyse(modules, Config(**settings))]


def test_the_order_of_the_files_does_not_matter():
    node = module("node", NODE.format(value="helper(msg.data)"))
    tools = module("tools", "def helper(x):\n    return x * 2\ndef clean(x):\n    return x")
    assert analyse([node, tools], Config()) == analyse([tools, node], Config()) != ()


def test_a_function_declared_as_sanitizer_ends_a_flow():
    node = module("node", NODE.format(value="bus.checked(msg.data)"))
    assert kinds(node) == [("explicit", ("a",), ("b",))]
    assert kinds(node, sanitizers=("bus.checked",)) == []


def test_functions_declared_as_sources_subscribe_or_return_a_message():
    text = """
        import rospy
        import bus
        pub = rospy.Publisher("b", F)
        bus.listen("a", lambda msg: pub.publish(msg.data))
        pub.publish(bus.read("c"))
        """
    assert kinds(module("node", text)) == []
    found = kinds(module("node", text), sources=("bus.listen", "bus.read"))
    assert found == [("explicit", ("a",), ("b",)), ("explicit", ("c",), ("b",))]


def test_functions_declared_as_sinks_are_publish_calls():
    text = """
        import rospy
        import bus
        rospy.Subscriber("a", F, lambda msg: bus.send(msg.data))
        """
    assert kinds(module("node", text)) == []
    assert kinds(module("node", text), sinks=("bus.send",)) == [("explicit", ("a",), ())]


def test_import_finds_the_nearest_module_of_its_name():
    near = module("tools", "def helper(x):\n    return 0", "one/tools.py")
    far = module("tools", "def helper(x):\n    return x", "two/tools.py")
    text = NODE.format(value="helper(msg.data)")
    assert kinds(module("node", text, "one/node.py"), near, far) == []
    assert kinds(module("other", text, "two/other.py"), near, far) == [("explicit", ("a",), ("b",))]


def test_relative_imports_find_their_package():
    package = module("pkg", "", "pkg/__init__.py")
    inner = module("pkg.inner.tools", "def helper(x):\n    return x", "pkg/inner/tools.py")
    node = module(
        "pkg.nodes.node",
        """
        import rospy
        from ..inner import tools
        from ..inner.tools import helper
        def on(msg):
            pub.publish(helper(msg.data))
            pub.publish(tools.helper(msg.data))
        pub = rospy.Publisher("b", F)
        rospy.Subscriber("a", F, on)
        """,
        "pkg/nodes/node.py",
    )
    assert len(kinds(package, inner, node)) == 2


def test_irrelevant_modules_are_not_analysed():
    node = module("node", NODE.format(value="helper(msg.data)"))
    tools = module("tools", "def helper(x):\n    return x\ndef clean(x):\n    return x")
    apart = module("apart", "x = 1")
    user = module("user", "import node")
    assert [m.name for m in relevant([apart, node, tools, user], Config())] == ["tools", "node", "user"]
    assert relevant([apart, tools], Config()) == []


def test_words_in_comments_do_not_make_a_module_relevant():
    prose = '''
        """Ask pub.publish(msg) of a Publisher."""
        topic = "it's"  # as rospy.Subscriber has it
        said = f"{topic} # no comment"
        '''
    assert relevant([module("prose", prose)], Config()) == []
    assert relevant([module("code", prose + 'send = f"{pub.publish(said)}"')], Config())


def test_modules_that_import_each_other_are_ordered_by_path():
    one, two = module("one", "import two\npublish = 1"), module("two", "import one, three")
    three = module("three", "x = 1")
    assert [m.name for m in relevant([one, two, three], Config())] == ["three", "two", "one"]
    assert relevant([three, two, one], Config()) == relevant([one, two, three], Config())


def test_the_catalog_takes_precedence_over_source_files_of_ros():
    library = module("rospy", "class Subscriber: ...\nclass Publisher: ...")
    node = module("node", NODE.format(value="msg.data"))
    assert kinds(library, node) == kinds(node) == [("explicit", ("a",), ("b",))]


def test_node_classes_that_no_analysed_code_instantiates_are_analysed():
    node = module(
        "node",
        """
        from rclpy.node import Node
        class Echo(Node):
            def __init__(self):
                super().__init__("echo")
                self.pub = self.create_publisher(F, "b", 10)
                self.create_subscription(F, "a", self.on, 10)
            def on(self, msg):
                self.pub.publish(msg)
            def never(self):
                self.pub.publish(self.last)
        """,
    )
    assert kinds(node) == [("explicit", ("a",), ("b",))]


TOOLS = """
    def checked(v):
        return max(-1.0, min(1.0, v))
    class Bus:
        def listen(self, topic, callback):
            self.callback = callback
        def read(self, topic):
            return self.kept
        def send(self, v):
            pass
    """


def test_settings_apply_to_functions_in_the_analysed_files():
    node = module("node", NODE.format(value="tools.checked(msg.data)").replace("import bus", "import tools"))
    tools = module("tools", TOOLS)
    assert kinds(node, tools) == [("explicit", ("a",), ("b",))]
    assert kinds(node, tools, sanitizers=("tools.checked",)) == []


def test_settings_name_a_method_by_its_defining_class():
    text = """
        from tools import Bus
        class Radio(Bus):
            pass
        radio = Radio()
        def on(msg):
            radio.send(msg.data)
        radio.listen("a", on)
        """
    modules = module("node", text), module("tools", TOOLS)
    assert kinds(*modules) == []
    found = kinds(*modules, sources=("tools.Bus.listen",), sinks=("tools.Bus.send",))
    assert found == [("explicit", ("a",), ())]


def test_wrappers_act_like_their_model_with_any_argument_positions():
    text = """
        import bus
        from std_msgs.msg import Float64
        out = bus.talk(Float64, "b")
        def on(msg, gain):
            out.publish(msg.data * gain)
        bus.listen(on, where="a", what=Float64)
        """
    listen = Wrapper("bus.listen", "rospy.Subscriber", topic="where", type="what", callback=0)
    talk = Wrapper("bus.talk", "rospy.Publisher", topic=1, type=0)
    assert kinds(module("node", text)) == []
    assert kinds(module("node", text), wrappers=(listen,)) == []
    flows = analyse([module("node", text)], Config(wrappers=(listen, talk)))
    (flow,) = flows
    assert (flow.source.topics, flow.source.type, flow.source.api) == (("a",), "Float64", "bus.listen")
    assert (flow.sink.topics, flow.sink.type) == (("b",), "Float64")


def test_wrapper_can_act_like_a_node_method():
    text = """
        import bus
        out = bus.talk(Float64, "b", 10)
        bus.listen(Float64, "a", lambda msg: out.publish(msg.data), 10)
        """
    wrappers = Wrapper("bus.listen", "create_subscription"), Wrapper("bus.talk", "create_publisher")
    assert kinds(module("node", text), wrappers=wrappers) == [("explicit", ("a",), ("b",))]


def test_callback_of_an_unknown_object_causes_no_error():
    text = "from elsewhere import sync\nfrom rospy import Subscriber\nsync.registerCallback(print)\n"
    text += "def f(filters):\n    filters.registerCallback(f)\nf(None)\n"
    assert analyse([module("node", text)], Config()) == ()
