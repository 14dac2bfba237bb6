import rclpy
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.parameter import Parameter

rclpy.init()
node = rclpy.create_node("prober")
say(node.declare_parameter("gain", 2.5).value, node.get_parameter("gain").type_)
say(node.get_parameter("gain"). name, node.has_parameter("gain"), node.has_parameter("nothing"))
for action in (
    lambda: node.get_parameter("nothing"),
    lambda: node.declare_parameter("gain", 1.0),
    lambda: node.set_parameters([Parameter("nothing", value=1)]),
    lambda: node.set_parameters([Parameter("gain", value="text")])[0].successful,
    lambda: node.set_parameters([Parameter("gain", value=3.5)])[0].successful,
    lambda: node.declare_parameter("", 1),
    lambda: node.undeclare_parameter("nothing"),
    lambda: node.get_parameter_or("nothing", Parameter("nothing", value=7)).value,
):
    try:
        say(action())
    except Exception as error:
        say(type(error).__name__)
say(node.get_parameter("gain").value)
node.add_on_set_parameters_callback(
    lambda parameters: SetParametersResult(successful=parameters[0].value > 0, reason="positive only")
)
result = node.set_parameters([Parameter("gain", value=-1.0)])[0]
say(result.successful, result.reason, node.get_parameter("gain").value)
fixed = node.declare_parameter("fixed", 1, ParameterDescriptor(read_only=True))
say(node.set_parameters([Parameter("fixed", value=2)])[0].successful, fixed.value)
say([p.name for p in node.declare_parameters("group", [("a", 1), ("b", "x")])])
say({name: p.value for name, p in node.get_parameters_by_prefix("group").items()})
