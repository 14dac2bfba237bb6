"""The page of a fleet contains the figures of the report, is legible with 10,000 robots, and needs no network."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.commands.cli import main
from pytest_tarl.fleet import html, ingest
from pytest_tarl.fleet.changed_robots import Robot
from pytest_tarl.fleet.ingest import Order
from pytest_tarl.fleet.question import Answer, Question, answer
from tests.plugin.monitoring import missions
from tests.plugin.report.test_browser import DARK, Seen, browser, opened

__all__ = ["browser"]
BEGAN = 1.76e9
MANY = 10_000

PROBE = """<script>(async () => {
const found = {violations: []}, root = document.documentElement;
addEventListener("securitypolicyviolation", event => found.violations.push(event.blockedURI));
const pause = time => new Promise(done => setTimeout(done, time));
for (let i = 0; i < 100 && !root.dataset.report; i++) await pause(50);
found.report = root.dataset.report;
const tiles = [...document.querySelectorAll("button.tile")];
found.tiles = tiles.map(tile => [tile.getAttribute("aria-label"), tile.textContent]);
const tile = document.querySelector("button.tile:last-of-type"); tile.click();
found.group = document.getElementById("group").textContent;
found.marks = document.querySelectorAll("#timeline .group").length;
found.bars = [...document.querySelectorAll("#timeline .robots title")].map(title => title.textContent);
found.cells = [...document.querySelectorAll("#cells .cell")].map(cell => cell.textContent);
found.rows = [...document.querySelectorAll("#table tbody tr")].map(row => row.cells[0].textContent);
const search = document.getElementById("search");
search.value = "WANTED"; search.dispatchEvent(new Event("input"));
found.searched = [...document.querySelectorAll("#table tbody tr")].map(row => row.cells[0].textContent);
found.count = document.getElementById("count").textContent;
document.querySelector("#table tbody button").click(); await pause(100);
found.card = document.getElementById("robot").textContent;
found.hash = location.hash;
const canvas = document.getElementById("dots"), box = canvas.getBoundingClientRect();
canvas.dispatchEvent(new MouseEvent("mousemove", {clientX: box.left + 2, clientY: box.top + 2}));
found.dot = document.getElementById("dot").textContent;
found.dots = [box.width, box.height];
const pixels = new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer);
found.colours = new Set(pixels).size;
found.overflow = root.scrollWidth - root.clientWidth;
found.resources = performance.getEntriesByType("resource").map(entry => entry.name);
document.body.dataset.found = JSON.stringify(found);
})();</script></body>"""


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return a data set of two sites; two robots of one site drift, and all names of robots contain markup."""
    folder = tmp_path_factory.mktemp("page")
    missions.fixture(folder / "test.npz", missions.walks(120, 1))
    for first, site in ((400, "north"), (200, "south")):
        logs = []
        for robot in range(first, first + 3):
            drift = float(robot in (200, 201))
            walks = missions.walks(20, robot) + missions.walks(40, robot + 50, drift)
            logs.append(missions.log(folder / f"<b>{robot}.log", walks, BEGAN))
        order = Order(tuple(logs), str(folder / "data"), folder / "test.npz", "{file}", "1", site)
        assert not [one.problem for one in ingest.ingest(order) if one.problem]
    return str(folder / "data")


@pytest.fixture(scope="module")
def found(data: str) -> Answer:
    return answer(Question(data))


def drawn(text: str) -> dict[str, Any]:
    """Return the data for the page's script."""
    told = re.search(r'<script type="application/json" id="tarl-data">(.*?)</script>', text, re.DOTALL)
    assert told is not None
    parsed: dict[str, Any] = json.loads(told[1])
    return parsed


def many(found: Answer) -> Answer:
    """Return the answer with 10,000 robots."""
    more = tuple(Robot(f"x{n:05}", 60, 60, -1.0, -1.0, None) for n in range(MANY - len(found.robots.every)))
    return replace(found, robots=replace(found.robots, every=(*found.robots.every, *more)))


def test_the_page_contains_the_figures_of_the_text_report(found: Answer) -> None:
    text = html.render(found)
    told = drawn(text)
    assert [one["values"] for one in told["groups"]] == [["1", "north"], ["1", "south"]]
    assert [one["found"] for one in told["groups"]] == [False, True]
    assert told["robots"]["name"] == [one.name for one in found.robots.every]
    named = {told["robots"]["name"][one["index"]]: one for one in told["named"]}
    assert named.keys() == {"<b>200", "<b>201"}
    for name, one in named.items():
        assert one["time"] == pytest.approx(BEGAN + 20, abs=4)
        assert {*one["like"], name} == {"<b>200", "<b>201"}
        assert "x 2-3" in one["cells"][0]["name"]
        assert one["cells"][0]["mean"] < 0
    assert told["cells"][0]["robots"] == 2
    seen = text.partition("<body>")[2].partition('<script type="application/json"')[0]
    assert "&lt;b&gt;200" in seen
    assert "<b>" not in seen


def test_page_of_many_robots_is_small(found: Answer) -> None:
    assert len(html.render(many(found))) < 600_000


def test_command_writes_fleet_and_robot_pages(
    data: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "robot.html"
    assert main(["fleet", data, "--robot", "<b>200", "--html", str(page)]) == 0
    text = page.read_text("utf-8")
    assert "Missions with the lowest reward" in text
    assert "1 of 1 robot named" in text
    assert main(["fleet", data, "--robot", "<b>200", "--html", str(tmp_path)]) == 2
    assert "cannot be written" in capsys.readouterr().err


def seen_by(browser: str, found: Answer, folder: Path, *more: str, width: int = 1280, wanted: str) -> Seen:
    return opened(browser, html.render(found), folder, width, *more, probe=PROBE.replace("WANTED", wanted))


@pytest.fixture(scope="module")
def seen(browser: str, found: Answer, tmp_path_factory: pytest.TempPathFactory) -> Seen:
    return seen_by(browser, many(found), tmp_path_factory.mktemp("many"), wanted="b>201")


def test_page_logs_nothing_and_sends_no_request(seen: Seen) -> None:
    assert seen.found["report"] == "drawn"
    assert seen.console == []
    assert seen.found["resources"] == seen.found["violations"] == []
    assert seen.found["overflow"] <= 0


def test_map_describes_each_group_in_words(seen: Seen) -> None:
    (north, _), (south, sign) = seen.found["tiles"]
    assert north.startswith("1 north: no difference")
    assert south.startswith("1 south: degraded")
    assert sign == "▼"
    assert seen.found["group"].startswith("version 1, site south: 180 missions of 3 robots")
    assert seen.found["marks"] == 1
    assert sum(int(one.split()[0]) for one in seen.found["bars"]) == 2
    assert any("2 robots" in one for one in seen.found["cells"])


def test_each_of_ten_thousand_robots_can_be_found(seen: Seen) -> None:
    assert seen.found["rows"][:2] in (["<b>200", "<b>201"], ["<b>201", "<b>200"])
    assert len(seen.found["rows"]) == 20
    assert seen.found["searched"] == ["<b>201"]
    assert seen.found["count"] == "1 of 10,000 robots"
    assert "Robots with similar drifts: <b>200" in seen.found["card"]
    assert "--robot '<b>201' --html '<b>201.html'" in seen.found["card"]
    assert seen.found["dot"].startswith("<b>200")
    width, height = seen.found["dots"]
    assert width * height >= MANY * 64
    assert height < 900
    assert seen.found["colours"] >= 3  # the ground, no evidence, named


def test_the_page_fits_a_narrow_dark_screen(browser: str, found: Answer, tmp_path: Path) -> None:
    narrow = seen_by(browser, found, tmp_path, DARK, width=500, wanted="400")
    assert narrow.found["report"] == "drawn"
    assert narrow.found["overflow"] <= 0
    assert narrow.console == []
    assert "Not named." in narrow.found["card"]
