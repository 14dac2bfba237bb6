"""The report page in a real browser: no console output, no requests, and the expected content."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from dataclasses import dataclass
from html import unescape
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.report.html import render
from website import assets

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
BROWSER = next((found for name in BROWSERS if (found := shutil.which(name))), None)
QUIET = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync --enable-logging=stderr --v=0 --virtual-time-budget=15000"
)
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND"
DARK = "--blink-settings=preferredColorScheme=0"

# After the page is drawn, this script clicks and hovers like a reader and stores the results.
PROBE = """<script>(async () => {
const found = {violations: []}, root = document.documentElement;
addEventListener("securitypolicyviolation", event => found.violations.push(event.blockedURI));
const pause = time => new Promise(done => setTimeout(done, time));
for (let i = 0; i < 100 && !root.dataset.report; i++) await pause(50);
found.report = root.dataset.report;
const plots = [...document.querySelectorAll(".plot")].filter(plot => plot.clientWidth);
found.plots = plots.map(plot => plot.dataset.figure);
const images = [...document.querySelectorAll(".heatmaplayer image")];
found.images = images.map(image => image.getAttribute("href") ?? image.getAttribute("xlink:href"));
found.across = [...new Set(images.map(image => Math.round(image.getBoundingClientRect().left)))].length;
found.curves = [...document.querySelectorAll(".scatterlayer path.js-line")].map(path => path.getAttribute("d"));
found.outlines = document.querySelectorAll(".shapelayer path").length;
found.labels = [...document.querySelectorAll(".ytick text, .y2tick text, .y3tick text")].map(text => text.textContent);
found.legend = [...document.querySelectorAll(".legendtext")].map(text => text.textContent);
for (const plot of window.Plotly ? plots : [])
  Plotly.Fx.hover(plot, plot.dataset.figure === "utility" ? {xval: 5.5, yval: 4} : [{curveNumber: 1, pointNumber: 4}],
                  "xy");
await pause(100);
found.hover = [...document.querySelectorAll(".hovertext")].map(text => text.textContent.replaceAll("\\u00a0", " "));
found.tabs = [];
for (const tab of document.querySelectorAll("[role=tab]")) {
  tab.click(); await pause(300);
  const panel = document.getElementById(tab.getAttribute("aria-controls"));
  found.tabs.push([tab.textContent, panel.hidden, panel.querySelectorAll(".heatmaplayer image").length]);
}
found.background = getComputedStyle(document.body).backgroundColor;
found.overflow = root.scrollWidth - root.clientWidth;
found.resources = performance.getEntriesByType("resource").map(entry => entry.name);
document.body.dataset.found = JSON.stringify(found);
})();</script></body>"""


AUDIT = """<script>(async () => {
const pause = time => new Promise(done => setTimeout(done, time));
for (let i = 0; i < 100 && !document.documentElement.dataset.report; i++) await pause(50);
const result = await axe.run(document, {runOnly: ["wcag2a", "wcag2aa"]});
document.body.dataset.found = JSON.stringify({
  violations: result.violations.map(one => one.id + ": " + one.nodes.map(node => node.html.slice(0, 200)).join(" ")),
  passed: result.passes.map(one => one.id)});
})();</script></body>"""


@dataclass(frozen=True)
class Seen:
    """The results of a script that ran in the page, and the lines of the browser's console."""

    found: dict[str, Any]
    console: list[str]


@pytest.fixture(scope="session")
def browser() -> str:
    """Return the path of a browser, or skip."""
    if BROWSER is None:
        pytest.skip(f"none of {', '.join(BROWSERS)} is installed, so the report page was not opened")
    return BROWSER


def opened(
    browser: str, text: str, directory: Path, width: int = 1280, *flags: str, probe: str = PROBE
) -> Seen:
    page = directory / "page.html"
    page.write_text(text.replace("</body>", probe), encoding="utf-8")
    command = [
        browser,
        *QUIET.split(),
        OFFLINE,
        *flags,
        f"--user-data-dir={directory / 'profile'}",
        f"--window-size={width},900",
        "--dump-dom",
        page.as_uri(),
    ]
    ran = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=120, check=True)
    body = re.search(r'<body data-found="([^"]*)"', ran.stdout)
    assert body, f"The page never finished: {ran.stderr[-2000:]}"
    return Seen(
        json.loads(unescape(body[1])), [line for line in ran.stderr.splitlines() if "CONSOLE" in line]
    )


@pytest.fixture(scope="session")
def shuttle_seen(browser, shuttle, tmp_path_factory) -> Seen:
    return opened(browser, render(shuttle), tmp_path_factory.mktemp("shuttle"))


@pytest.fixture(scope="session")
def follower_seen(browser, two_lists, tmp_path_factory) -> Seen:
    """The page of a comparison with two taint lists, in dark mode, on a screen too narrow for three panels."""
    return opened(browser, render(two_lists), tmp_path_factory.mktemp("follower"), 500, DARK)


@pytest.fixture(params=["shuttle_seen", "follower_seen"])
def seen(request) -> Seen:
    return request.getfixturevalue(request.param)


def test_the_page_prints_nothing_to_the_console(seen):
    assert seen.found["report"] == "drawn"
    assert seen.console == []


def test_the_page_sends_no_requests(seen):
    assert seen.found["resources"] == []
    assert seen.found["violations"] == []


def test_the_check_detects_a_page_that_sends_a_request(browser, listless, tmp_path):
    asking = (
        '<img src="http://127.0.0.1:9/pixel.png" alt=""><script>fetch("https://example.org/")</script></main>'
    )
    seen = opened(browser, render(listless).replace("</main>", asking), tmp_path)
    assert seen.found["violations"] or seen.found["resources"]
    assert seen.console


def test_the_page_is_never_wider_than_the_screen(seen):
    assert seen.found["overflow"] <= 0


def test_utility_is_drawn_per_terrain(shuttle_seen):
    images = shuttle_seen.found["images"]
    assert len(images) == len(set(images)) == 6
    assert all(image.startswith("data:image/png;base64,") and len(image) > 100 for image in images)
    assert shuttle_seen.found["plots"] == ["utility", "curves"]


def test_code_lines_are_next_to_the_panels(shuttle_seen):
    labels = [label.replace("\u00a0", " ").strip() for label in shuttle_seen.found["labels"]]
    assert "30  vel = 5 * delta" in labels


def test_regions_have_outlines_and_a_tolerance_band(shuttle_seen):
    assert (
        shuttle_seen.found["outlines"] == 3 + 1
    )  # shapes: the region, two regions of the paper, and the band


def test_every_reward_curve_is_drawn_with_a_name(shuttle_seen):
    names = [
        "designed",
        "deployed (mud)",
        "search: epsilon-greedy",
        "search: sweep",
        "repaired",
        "repaired, designed world",
    ]
    assert shuttle_seen.found["legend"] == names
    assert len(shuttle_seen.found["curves"]) == len(names)
    assert all(curve.count("L") >= 1 for curve in shuttle_seen.found["curves"])


def test_the_tooltip_shows_value_line_and_cell(shuttle_seen):
    utility, reward = shuttle_seen.found["hover"]
    assert re.fullmatch(r"designed \d\.\d\d29  err = abs\(delta\)x 5\.4-5\.8 m, terrain false", utility)
    assert re.match(r"designed \d+\.\d\depisode 5: ", reward)


def test_every_list_has_a_tab_with_its_figures(follower_seen):
    assert follower_seen.found["tabs"] == [
        ["/reflectance → /cmd_vel", False, 9],
        ["/reflectance → /status", False, 9],
    ]


def test_panels_are_stacked_on_a_narrow_screen(shuttle_seen, follower_seen):
    assert shuttle_seen.found["across"] > 2
    assert follower_seen.found["across"] == 1


def test_the_colour_scheme_follows_the_setting_of_the_reader(shuttle_seen, follower_seen):
    def brightness(seen: Seen) -> int:
        return sum(int(part) for part in re.findall(r"\d+", seen.found["background"])[:3])

    assert brightness(shuttle_seen) > 700
    assert brightness(follower_seen) < 120


def test_a_page_without_lists_shows_the_rewards(browser, listless, tmp_path):
    seen = opened(browser, render(listless), tmp_path)
    assert (seen.found["report"], seen.found["plots"], seen.console) == ("drawn", ["curves"], [])


def test_a_browser_that_cannot_draw_shows_a_message(browser, shuttle, tmp_path):
    broken = re.sub(r'(id="tarl-library">).{100}', r"\1", render(shuttle), count=1)
    seen = opened(browser, broken, tmp_path)
    assert seen.found["report"] == "failed"
    assert len(seen.console) == 1


@pytest.mark.parametrize("flags", [(), (DARK,)], ids=["light", "dark"])
def test_the_page_is_accessible(browser, shuttle, tmp_path, flags):
    if not assets.available(assets.TESTED_WITH):
        pytest.skip("run `make docs-assets` once: axe-core is not in build/assets")
    axe = (assets.KEPT / "axe" / "axe.min.js").read_text("utf-8").replace("</script>", "<\\/script>")
    found = opened(
        browser, render(shuttle), tmp_path, 1280, *flags, probe=f"<script>{axe}</script>{AUDIT}"
    ).found
    assert found["violations"] == []
    assert "color-contrast" in found["passed"]
