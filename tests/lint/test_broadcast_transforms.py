"""Broadcast transforms are sinks only for a program that runs the code; reports do not contain them."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint import engine
from tarl_lint.api import analyse
from tarl_lint.read.source import Module, parse
from tarl_lint.settings.config import Config

NODE = """\
import rospy, tf, tf2_ros
from std_msgs.msg import Float64

class Other:
    def sendTransform(self, *_):
        pass

def on_height(msg):
    caster.sendTransform((0.0, 0.0, msg.data), (0, 0, 0, 1), rospy.Time.now(), "scan", "base")

caster = {caster}()
rospy.Subscriber("height", Float64, on_height)
"""
CASTERS = [
    ("tf.TransformBroadcaster", "/tf"),
    ("tf2_ros.TransformBroadcaster", "/tf"),
    ("tf2_ros.StaticTransformBroadcaster", "/tf_static"),
    ("Other", None),
    ("tf.TransformListener", None),
]


@pytest.mark.parametrize(("caster", "topic"), CASTERS)
def test_a_broadcast_transform_is_a_sink(tmp_path: Path, caster: str, topic: str | None) -> None:
    (tmp_path / "node.py").write_text(NODE.format(caster=caster))
    found = analyse([tmp_path / "node.py"], root=tmp_path, with_settings=True)
    assert [flow.sink.topics for flow in found.flows] == ([(topic,)] if topic else [])


def test_a_node_without_the_setting_has_no_such_sink(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text(NODE.format(caster="tf.TransformBroadcaster"))
    (tmp_path / "pyproject.toml").write_text("[tool.tarl-lint]\ntf2 = false\n")
    assert analyse([tmp_path / "node.py"], root=tmp_path, with_settings=True).flows == ()


def test_reports_have_no_flows_into_transforms(tmp_path: Path) -> None:
    module = parse("node.py", NODE.format(caster="tf.TransformBroadcaster").encode(), "node")
    assert isinstance(module, Module)
    config = Config(root=tmp_path, tf2=True)
    assert engine.trace([module], config, thorough=False)[1] == ()
    assert len(engine.trace([module], config)[1]) == 1
