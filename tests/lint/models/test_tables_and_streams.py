"""Tables by tainted keys, tables and arrays of libraries, trees of XML, and objects that write into streams."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, in_callback, sections

HEAD = """
import collections, configparser, csv, gzip, io, json, lxml.etree, pickle, wave, zipfile
import numpy as np
import pandas as pd
import xml.etree.ElementTree as ET
from PIL import Image
"""
BODIES = """\
### keys that are data
table = {}
table[msg.name] = 1.0
if "x" in table:
    out.publish(1.0)  # control
out.publish(table.get("x"))  # data
for key in table:
    out.publish(2.0)  # clean
### keys of a literal
out.publish({msg.name: 1.0}["a"])  # control
table = {msg.name: 1.0, "b": 2.0}
out.publish(table["a"])  # control
out.publish(table["b"])  # clean
out.publish(list(table.values())[0])  # clean
if "a" in table:
    out.publish(3.0)  # control
### keys of other new mappings
out.publish({name: 1.0 for name in msg.names}["x"])  # control
out.publish(dict.fromkeys(msg.names, 0.0)["x"])  # control
out.publish(dict([(msg.name, 1.0)])["x"])  # control
### keys that are missing
table, other = {msg.name: 1.0}, {"a": 1.0}
try:
    value = table["x"]
except KeyError:
    out.publish(1.0)  # control
if table.pop("dock", None) is not None:
    out.publish(2.0)  # control
other.setdefault(msg.name, 1.0)
if "x" in other:
    out.publish(3.0)  # control
### keys that are constant
table = {"a": msg.data}
table["c"] = 2.0
if "a" in table and "b" not in table:
    out.publish(1.0)  # clean
out.publish(table["c"])  # clean
### rows of a table of pandas
table, other = pd.DataFrame(columns=["a"]), pd.DataFrame(columns=["a"])
table.loc[len(table)] = [msg.data]
if table.empty:
    out.publish(1.0)  # control
if other.empty:
    out.publish(1.0)  # clean
out.publish(table.iloc[-1]["a"])  # data
out.publish(table["a"].mean())  # data
out.publish(table.shape[0])  # data
out.publish(other.iloc[-1]["a"])  # clean
other.at[0, "a"] = msg.data
out.publish(other.values)  # data
### the shape of an array does not depend on its elements
depth, grid = np.zeros((4, 5)), np.zeros(shape=msg.width)
depth[1, 2] = msg.data
if 3 < depth.shape[0] and depth.size and depth.ndim:
    out.publish(len(depth))  # clean
for row in depth:
    out.publish(1.0)  # clean
if depth.any():
    out.publish(1.0)  # control
out.publish(depth.max())  # data
out.publish(np.zeros_like(depth).shape)  # clean
out.publish(len(grid))  # data
out.publish(grid.shape)  # data
raw = bytearray(2)
raw.extend(msg.raw)
out.publish(len(raw))  # data
### a tree of XML
root, other, clean = ET.Element("a"), ET.Element("a"), io.StringIO()
ET.SubElement(root, "b").text = str(msg.data)
for tree, stream in ((ET.ElementTree(root), io.BytesIO()), (ET.ElementTree(file="plan.xml"), io.BytesIO())):
    tree.write(stream)
    out.publish(stream.getvalue())  # data
ET.ElementTree(other).write(clean, encoding="unicode")
out.publish(clean.getvalue())  # clean
out.publish(lxml.etree.tostring(root))  # data
### a method that writes its object into a stream
config, first, second, third = configparser.ConfigParser(), io.StringIO(), io.BytesIO(), io.BytesIO()
config["a"] = {"b": msg.data}
config.write(first)
out.publish(first.getvalue())  # data
size = Image.fromarray(msg.data).save_to(second)
out.publish(second.getvalue())  # data
image = Image.open(third, msg.data)
out.publish(third.getvalue())  # clean
### objects that write into a stream which they got
first, second, third, fourth, fifth = io.BytesIO(), io.BytesIO(), io.BytesIO(), io.BytesIO(), io.BytesIO()
with zipfile.ZipFile(first, "w") as archive:
    archive.writestr("a", msg.data)
    archive.read("b")
out.publish(first.getvalue())  # data
with wave.open(second, "wb") as sound:
    sound.writeframes(msg.data)
out.publish(second.getvalue())  # data
with gzip.GzipFile(fileobj=third, mode="wb") as packed:
    packed.write(msg.data)
out.publish(third.getvalue())  # data
pickle.Pickler(fourth).dump(msg.data)
out.publish(fourth.getvalue())  # data
zipfile.ZipFile(fifth).open(msg.name).read()
out.publish(fifth.getvalue())  # clean
### an attribute that is set by its name
class Kept:
    pass
kept = Kept()
kept.__setattr__("near", msg.data)
out.publish(kept.near)  # data
kept.__setattr__("near", 1.0)
out.publish(kept.near)  # clean
### a function that writes through another object into a stream
stream, other = io.BytesIO(), io.BytesIO()
writer, encoder = Writer(1), Encoder(stream)
writer.write(msg.data, encoder)
out.publish(stream.getvalue())  # data
out.publish(other.getvalue())  # clean
"""


@pytest.mark.parametrize("title", sections(BODIES))
def test_a_read_has_the_data_that_was_stored(title: str) -> None:
    assert differing(in_callback(sections(BODIES)[title], HEAD + "from avro import Writer, Encoder\n")) == {}
