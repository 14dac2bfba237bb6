"""The fields of standard messages that the linter knows, compared with the definitions of all releases of ROS."""

from __future__ import annotations

import re

from rosbags.typesys import Stores, get_typestore

from tarl_lint.message_fields import ALL_FIELDS, BY_RELEASE, ELEMENTS, FIELDS, KNOWN_FIELDS
from tarl_lint.message_fields import PACKAGES as PACKAGES_OF

PACKAGES = ("std_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs")
EMPTY = "structure_needs_at_least_one_member"  # the field of a message without fields


def defined(stores: list[Stores]) -> dict[str, dict[str, str]]:
    """Return type → field → message type of the field, or "", as some of these releases define it."""
    found: dict[str, dict[str, str]] = {}
    for store in stores:
        for full, (_, fields) in get_typestore(store).fielddefs.items():
            package, _, name = full.split("/")
            if package in PACKAGES and not name.startswith("GetMap"):  # an action
                for field, (kind, described) in fields:
                    inner = str(described).rpartition("/")[2] if kind.name == "NAME" else ""
                    found.setdefault(name, {})[field] = inner
    return {name: fields for name, fields in found.items() if EMPTY not in fields}


def test_all_fields_of_all_releases_are_known() -> None:
    expected = {name: set(fields) for name, fields in defined(list(Stores)).items()}
    assert {name: set(fields) for name, fields in ALL_FIELDS.items()} == expected


def test_the_types_of_fields_are_the_types_in_the_definitions() -> None:
    expected = defined(list(Stores))
    stated = {
        (name, field): kind for name, fields in ALL_FIELDS.items() for field, kind in fields.items() if kind
    }
    assert stated == {(name, field): expected[name][field] for name, field in stated}


def test_tracked_types_have_the_same_fields_in_every_release() -> None:
    for store in (Stores.ROS1_NOETIC, Stores.ROS2_JAZZY):
        expected = {
            name: set(fields) - {"seq"} for name, fields in defined([store]).items() if name in FIELDS
        }
        assert {name: set(FIELDS[name]) for name in expected} == expected


def elements() -> dict[str, dict[str, str]]:
    """Return type → `field[]` → type of the elements, for all known types of all releases."""
    found: dict[str, dict[str, str]] = {}
    for store in Stores:
        for full, (_, fields) in get_typestore(store).fielddefs.items():
            package, _, name = full.split("/")
            for field, (kind, described) in fields if name in PACKAGES_OF.get(package, ()) else ():
                inner = re.search(r"\w+/msg/(\w+)", str(described))
                if kind.name in ("ARRAY", "SEQUENCE") and inner is not None and inner[1] in KNOWN_FIELDS:
                    found.setdefault(name, {})[f"{field}[]"] = inner[1]
    return found


def test_the_types_of_elements_are_the_types_in_the_definitions() -> None:
    assert elements() == ELEMENTS


def test_fields_of_one_ros_release_are_absent_in_another() -> None:
    for release, store in (("1", Stores.ROS1_NOETIC), ("2", Stores.ROS2_JAZZY)):
        expected = {
            name: set(fields) for name, fields in defined([store]).items() if name in BY_RELEASE[release]
        }
        assert {name: set(BY_RELEASE[release][name]) for name in expected} == expected
