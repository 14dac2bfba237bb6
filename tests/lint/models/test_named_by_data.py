"""Attributes whose names are not known are stored through the descriptors and properties of their class."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback, sections

HEAD = """\
import json
class Field:
    def __init__(self, kind, default=None):
        self.kind, self.default = kind, default
    def __set_name__(self, owner, name):
        self.name = name
    def __get__(self, instance, owner):
        return instance.__dict__.get(self.name, self.default)
    def __set__(self, instance, value):
        instance.__dict__[self.name] = self.kind(value)
class Model:
    def __init__(self, **values):
        for name, value in values.items():
            setattr(self, name, value)
class Plan(Model):
    plate = Field(str, "none")
    volume = Field(float, 10.0)
class Limited:
    def __init__(self):
        self._speed, self.other = 0.0, 1.0
    @property
    def speed(self):
        return self._speed
    @speed.setter
    def speed(self, value):
        self._speed = min(value, 2.0)
class Other:
    gain = Field(float, 1.0)
"""
PROGRAMS = """\
### names from a text
plan = Plan(**json.loads(msg.data))
out.publish(plan.volume)  # data
out.publish(plan.plate)  # data
out.publish(Plan().volume)  # clean
out.publish(Other().gain)  # clean
### known names
plan = Plan(volume=msg.data)
out.publish(plan.volume)  # data
out.publish(plan.plate)  # clean
### a loop over the names and values of a message
limited = Limited()
for name, value in json.loads(msg.data).items():
    setattr(limited, name, value)
out.publish(limited.speed)  # data
out.publish(Limited().speed)  # clean
### constants under unknown names
plan = Plan()
for name in rospy.get_param("~names"):
    setattr(plan, name, 1.0)
out.publish(plan.volume)  # clean
"""
CASES = sections(PROGRAMS)


@pytest.mark.parametrize("title", CASES)
def test_attributes_with_unknown_names_have_the_marked_flows(title):
    assert differing(in_callback(CASES[title], HEAD)) == {}
