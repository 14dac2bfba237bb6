"""Definitions, values and bytes of ROS messages, worked out by hand."""

from __future__ import annotations

import struct
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.ros.messages import ros1_wire, ros2_wire
from pytest_tarl.ros.messages.field_values import (
    FieldError,
    as_bool,
    as_float,
    as_float32,
    as_integer,
    as_list,
    as_numbers,
    as_text,
)
from pytest_tarl.ros.messages.ros1 import build, field_class, md5_text
from pytest_tarl.ros.messages.ros1_wire import WireError
from pytest_tarl.ros.messages.times import Duration, Time
from pytest_tarl.ros.messages.type_definitions import Constant, Definition, Field, _sections, parse

SECOND = 10**9


# definitions


def test_a_definition_has_fields_constants_and_defaults() -> None:
    text = """
        # comment
        int8 LOW=-1      # a constant
        uint8 HIGH = 0x10
        string NAME= "x # y"
        bool ON=true
        float32 HALF=0.5
        Header header
        float64[3] xyz
        float64[] many
        float64[<=4] few
        string<=5 text "hi"
        int32[] numbers [1, 2]
        Point at
        other/Kind kind
        time when
        uint8 structure_needs_at_least_one_member
    """
    found = parse("ros2", "pkg", "Name", text)
    assert [(one.name, one.value) for one in found.constants] == [
        *(("LOW", -1), ("HIGH", 16), ("NAME", "x"), ("ON", True), ("HALF", 0.5)),
    ]
    assert found.constants[0].text == "int8 LOW=-1"
    assert [(one.name, one.base, one.shape, one.size, one.default) for one in found.fields] == [
        ("header", "std_msgs/Header", "one", 0, None),
        ("xyz", "float64", "array", 3, None),
        ("many", "float64", "sequence", 0, None),
        ("few", "float64", "sequence", 0, None),
        ("text", "string", "one", 0, "hi"),
        ("numbers", "int32", "sequence", 0, [1, 2]),
        ("at", "pkg/Point", "one", 0, None),
        ("kind", "other/Kind", "one", 0, None),
        ("when", "builtin_interfaces/Time", "one", 0, None),
    ]


def test_ros1_string_constants_keep_their_hash() -> None:
    found = parse("ros1", "pkg", "Name", "string NAME=a # b\ntime when\nint8 X=1 # c")
    assert [one.value for one in found.constants] == ["a # b", 1]
    assert (found.fields[0].base, found.fields[0].primitive) == ("time", True)


def test_a_field_is_written_as_in_a_file() -> None:
    fields: list[Any] = [Field("a", "int8", shape, 3) for shape in ("one", "array", "sequence")]  # type: ignore[arg-type]
    assert [one.text for one in fields] == ["int8", "int8[3]", "int8[]"]
    assert not Field("a", "pkg/Name").primitive


def test_the_sections_of_a_service_are_separated_by_dashes() -> None:
    assert _sections("a\n---\nb\n", 2) == ["a\n", "b\n"]
    assert _sections("a\n", 3) == ["a\n", "", ""]
    assert _sections("a\n --- \nb\n---\nc", 2) == ["a\n", "b\n"]


def test_checksum_text_has_constants_first() -> None:
    constants = (Constant("B", 2, "int8 B=2"),)
    found = Definition(
        "ros1", "pkg", "Name", (Field("a", "int8"), Field("s", "std_msgs/String", "sequence")), constants
    )
    nested: Any = field_class("std_msgs/String")
    assert md5_text(found) == f"int8 B=2\nint8 a\n{nested._md5sum} s"


# values


@pytest.mark.parametrize(
    ("base", "low", "high"),
    [
        ("int8", -128, 127),
        ("char", 0, 255),
        ("byte", -128, 127),
        ("uint16", 0, 65535),
        ("int64", -(2**63), 2**63 - 1),
    ],
)
def test_integers_must_fit_their_type(base: str, low: int, high: int) -> None:
    assert [as_integer(one, base, "f") for one in (low, high, True)] == [low, high, 1]
    for wrong in (low - 1, high + 1):
        with pytest.raises(FieldError, match=rf"must lie within {base}, from {low} to {high}, not {wrong}"):
            as_integer(wrong, base, "f")
    with pytest.raises(FieldError, match=r"must be an integer, not 1\.0"):
        as_integer(1.0, base, "f")


def test_values_of_other_types_are_refused_with_a_reason() -> None:
    assert (as_float(3, "f"), as_bool(1, "f"), as_bool(False, "f"), as_text("x", "f")) == (
        3.0,
        True,
        False,
        "x",
    )
    assert as_float32(0.1, "f") == struct.unpack("<f", struct.pack("<f", 0.1))[0]
    for call, words in (
        (lambda: as_float("1", "f"), "field 'f' must be a number, not '1'"),
        (lambda: as_float(None, "f"), "must be a number"),
        (lambda: as_float32(1e39, "f"), "too large for float32"),
        (lambda: as_bool("x", "f"), "must be a bool"),
        (lambda: as_text(b"x", "f"), "must be a string"),
        (lambda: as_numbers("12", "int8", 0, "f"), "must be a sequence of int8"),
        (lambda: as_numbers(3, "int8", 0, "f"), "must be a sequence of int8"),  # type: ignore[arg-type]
        (lambda: as_numbers([200], "int8", 0, "f"), "must hold values of type int8"),
        (lambda: as_numbers([1, 2], "int8", 3, "f"), "must hold 3 values, not 2"),
        (lambda: as_list("ab", 0, "f", as_text), "must be a sequence, not 'ab'"),
        (lambda: as_list(3, 0, "f", as_text), "must be a sequence"),
        (lambda: as_list(["a"], 2, "f", as_text), "must hold 2 elements, not 1"),
    ):
        with pytest.raises(FieldError, match=words):
            call()
    assert as_list(("a", "b"), 2, "f", as_text) == ["a", "b"]
    assert list(as_numbers((1, 2), "int8", 2, "f")) == [1, 2]


# bytes


def one_field(*fields: Field) -> Any:
    return build(Definition("ros1", "pkg", "Name", fields), "pkg.msg")


def both_ways(kind: Any, message: Any) -> bytes:
    data = ros1_wire.serialize(message)
    again = ros1_wire.deserialize(kind, data, field_class)
    assert again == message
    return data


def test_ros1_numbers_are_little_endian() -> None:
    kind = one_field(Field("a", "uint16"), Field("b", "int16", "sequence"), Field("c", "uint8", "array", 2))
    assert both_ways(kind, kind(258, [1, -1], b"\x07\x08")) == bytes.fromhex("0201020000000100ffff0708")
    flags = one_field(Field("a", "bool", "sequence"), Field("b", "float32"), Field("c", "uint8", "sequence"))
    assert both_ways(flags, flags([True, False], 0.5, b"xy")) == bytes.fromhex(
        "0200000001000000003f020000007879"
    )


def test_ros1_values_have_no_padding() -> None:
    kind = one_field(
        Field("a", "string", "sequence"),
        Field("t", "time"),
        Field("d", "duration", "array", 1),
        Field("m", "std_msgs/String"),
    )
    nested: Any = field_class("std_msgs/String")
    sent = kind(["é", ""], Time(1, 2), [Duration(-1, 3)], nested("x"))
    assert both_ways(kind, sent) == bytes.fromhex(
        "0200000002000000c3a9000000000100000002000000ffffffff030000000100000078"
    )


@pytest.mark.parametrize(
    ("field", "data", "words"),
    [
        (Field("a", "uint16"), "01", "not a valid pkg/Name"),
        (Field("a", "uint16"), "010203", "1 bytes are left after a pkg/Name"),
        (Field("a", "string"), "050000006162", "a string is longer than the remaining bytes"),
        (Field("a", "uint8", "sequence"), "030000006162", "an array is longer than the remaining bytes"),
        (Field("a", "string", "sequence"), "ff000000", "an array of 255 elements does not fit 4 bytes"),
        (Field("a", "int32", "array", 2), "01000000", "not a valid pkg/Name"),
    ],
)
def test_wrong_number_of_ros1_bytes_is_refused(field: Field, data: str, words: str) -> None:
    with pytest.raises(WireError, match=words):
        ros1_wire.deserialize(one_field(field), bytes.fromhex(data), field_class)


def test_ros1_bytes_of_an_unknown_nested_type_are_refused() -> None:
    kind = SimpleNamespace(_type="a/B")

    class Made:
        _type, __slots__, _slot_types = "a/B", ("x",), ["nowhere/Kind"]

    with pytest.raises(WireError, match="message type nowhere/Kind is not known"):
        ros1_wire.deserialize(Made, b"12345678", lambda _: None)
    assert kind._type == "a/B"


def test_full_type_text_contains_each_nested_type_once() -> None:
    text = ros1_wire.full_text(field_class("geometry_msgs/PoseStamped"))
    assert text.startswith("std_msgs/Header header\ngeometry_msgs/Pose pose\n")
    assert text.count("MSG: geometry_msgs/Point\n") == 1
    assert text.count("=" * 80) == 4


class Structure:
    """A ROS 2 message of the given fields: name → type and value."""

    fields: dict[str, str] = {}  # noqa: RUF012 (replaced in each subclass)

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        return cls.fields


def structure(**fields: str) -> Any:
    return type("Made", (Structure,), {"fields": fields})


def ros2_bytes(kinds: dict[str, str], **given: Any) -> str:
    """Return the hexadecimal bytes of a message without their header; check that they are read back."""
    kind = structure(**kinds)
    message = kind()
    for name, value in given.items():
        setattr(message, name, value)
    data = ros2_wire.serialize(message)
    assert data[:4] == b"\x00\x01\x00\x00"
    again = ros2_wire.deserialize(data, kind)
    assert {name: getattr(again, name) for name in given} == given
    return data[4:].hex()


@pytest.mark.parametrize(
    ("kinds", "given", "expected"),
    [
        ({"a": "uint8", "b": "uint16"}, {"a": 1, "b": 2}, "01000200"),
        ({"a": "uint8", "b": "double"}, {"a": 1, "b": 1.0}, "0100000000000000000000000000f03f"),
        ({"a": "boolean", "b": "int8", "c": "int32"}, {"a": True, "b": -1, "c": -2}, "01ff0000feffffff"),
        ({"a": "sequence<uint8>", "b": "uint32"}, {"a": [1, 2, 3], "b": 4}, "030000000102030004000000"),
        ({"a": "sequence<int16, 4>"}, {"a": []}, "00000000"),
        ({"a": "int16[2]"}, {"a": [1, -1]}, "0100ffff"),
        ({"a": "octet", "b": "sequence<octet>"}, {"a": b"\x07", "b": [b"\x08"]}, "070000000100000008"),
        ({"a": "string", "b": "string<5>"}, {"a": "é", "b": ""}, "03000000c3a900000100000000"),
        ({"a": "wstring"}, {"a": "é€"}, "02000000e900ac20"),
        ({"a": "sequence<string>"}, {"a": ["x", "yz"]}, "02000000020000007800000003000000797a00"),
        ({"a": "uint8", "b": "sequence<double>"}, {"a": 1, "b": []}, "0100000000000000"),
    ],
)
def test_ros2_values_are_aligned_to_their_size(
    kinds: dict[str, str], given: dict[str, Any], expected: str
) -> None:
    assert ros2_bytes(kinds, **given) == expected


def test_ros2_structures_without_fields_have_one_byte() -> None:
    assert ros2_bytes({}) == "00"


def test_ros2_bytes_that_end_too_early_are_refused() -> None:
    for kinds, data in (
        ({"a": "uint32"}, "000100000102"),
        ({"a": "sequence<string>"}, "00010000ff000000"),
        ({"a": "string"}, "000100000500000061"),
    ):
        with pytest.raises(ValueError, match="the bytes are not a valid Made"):
            ros2_wire.deserialize(bytes.fromhex(data), structure(**kinds))  # type: ignore[arg-type]
