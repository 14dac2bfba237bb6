"""The recording of the terminal shows the tutorial, whose commands the tests run."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from website.page_commands import TUTORIAL, VARIES, blocks
from website.terminal import SHOWN, TARGET

TEXT = "{http://www.w3.org/2000/svg}text"


def test_every_line_of_the_recording_is_in_the_tutorial() -> None:
    drawn = [VARIES.sub("~", element.text or "") for element in ElementTree.parse(TARGET).iter(TEXT)]
    commands = [one for block in blocks(TUTORIAL.read_text("utf-8")) for one in block.commands()]
    known = {
        VARIES.sub("~", line) for one in commands for line in (f"$ {one.line}", *one.output.splitlines())
    }
    assert [line for line in drawn if line not in known] == []
    begun = [line for line in drawn if line.startswith("$ ")]
    assert all(any(line.startswith(f"$ {name}") for line in begun) for name in SHOWN)


def test_lines_appear_in_order() -> None:
    picture = TARGET.read_text("utf-8")
    seconds = [float(second) for second in re.findall(r"animation-delay:([\d.]+)s\"", picture)]
    assert seconds == sorted(seconds)
    last = max(float(y) for y in re.findall(r'<text x="\d+" y="([\d.]+)"', picture))
    height = float(re.findall(r'viewBox="0 0 \d+ (\d+)"', picture)[0])
    scrolled = float(re.findall(r"(?<![\d.])100%\{transform:translateY\((-?\d+)px\)", picture)[0])
    assert 0 < last + scrolled < height
