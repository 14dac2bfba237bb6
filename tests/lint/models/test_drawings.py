"""What is drawn into the current figure is in its image, and in no image of another program."""

from __future__ import annotations

from textwrap import dedent

import pytest

from tarl_lint import engine
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config
from tests.lint.models.marked import differing, in_callback

HEAD = "import chainercv.visualizations, cv2, library\nimport matplotlib.pyplot as plt"
BODY = """
    {call}
    out.publish(plt.gcf().canvas.tostring_rgb())  # {mark}
"""


@pytest.mark.parametrize(
    ("call", "mark"),
    [
        ("chainercv.visualizations.vis_bbox(msg.data)", "data"),
        ("library.draw_networkx(msg.data)", "data"),
        ("library.heatmap_plot(msg.data)", "data"),
        ("library.visualize(image=msg.data)", "data"),
        ("library.draw_networkx(1.0)", "clean"),
        ("drawn = library.draw_networkx(msg.data)", "clean"),
        ("library.discard(msg.data)", "clean"),
        ("cv2.drawContours(msg.data)", "clean"),
    ],
)
def test_a_function_that_draws_changes_the_current_figure(call, mark):
    assert differing(in_callback(BODY.format(call=call, mark=mark), HEAD)) == {}


def test_module_without_pyplot_draws_no_figure():
    body = BODY.format(call="library.draw_networkx(msg.data)", mark="clean").replace("plt", "library")
    assert differing(in_callback(body, "import library")) == {}


SHARED = """
import matplotlib.pyplot as plt
import rospy
from std_msgs.msg import Float64

class Plot:
    def __init__(self, topic):
        self.figure = plt.figure()
        self.axes = self.figure.add_subplot(1, 1, 1)
        self.pub = rospy.Publisher("image", Float64, queue_size=1)
        rospy.Subscriber(topic, Float64, self.receive)

    def receive(self, msg):
        self.axes.plot(msg.data)
        self.pub.publish(self.figure.canvas.tostring_rgb())
"""
PROGRAM = """
import matplotlib.pyplot as plt
import rospy
from std_msgs.msg import Float64
import shared

if __name__ == "__main__":
    rospy.init_node("node")
    {main}
    rospy.spin()
"""
MAINS = {
    "one": 'shared.Plot("one")',
    "two": 'rospy.Publisher("two", Float64, queue_size=1).publish(plt.gcf().canvas.tostring_rgb())',
}


def found(texts: dict[str, str]) -> set[tuple[str, str]]:
    modules = [parse(f"{name}.py", dedent(text).encode(), name) for name, text in texts.items()]
    flows = engine.analyse([m for m in modules if isinstance(m, Module)], Config())
    return {(flow.source.topics[0], flow.sink.topics[0]) for flow in flows}


def test_no_figure_is_shared_between_programs():
    programs = {name: PROGRAM.format(main=main) for name, main in MAINS.items()}
    assert found({"shared": SHARED} | programs) == {("one", "image")}


def test_pyplot_draws_into_the_figure_of_its_program():
    both = PROGRAM.format(main=f"{MAINS['one']}\n    while True:\n        {MAINS['two']}")
    assert found({"shared": SHARED, "one": both}) == {("one", "image"), ("one", "two")}


def test_figure_made_during_import_is_drawn_by_importing_programs():
    shared = SHARED + "\nfigure = plt.figure()\n"
    main = f"{MAINS['one']}\n    while True:\n        {MAINS['two'].replace('plt.gcf()', 'shared.figure')}"
    drawing = shared.replace("self.axes.plot(msg.data)", "plt.plot(msg.data)")
    assert ("one", "two") in found({"shared": drawing, "one": PROGRAM.format(main=main)})
