"""A console script whose function is not named main and registers nothing itself."""

from std_msgs.msg import String

from sim.wiring import wire


def begin():
    node = wire(String, "ask", lambda msg: out.publish(msg))  # source ask  # sink ask
    out = node.create_publisher(String, "echo", 1)
    out.publish(String(data="ready"))  # clean


def unnamed():
    node = wire(String, "never", lambda msg: out.publish(msg))
    out = node.create_publisher(String, "never_again", 1)
