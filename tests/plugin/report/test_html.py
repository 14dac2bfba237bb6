from __future__ import annotations

import importlib.util
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from pytest_tarl.errors import TarlError
from pytest_tarl.model import OperandEffect
from pytest_tarl.report import html
from pytest_tarl.report.html import in_script, render, typeset, write

NASTY = "</script><script>alert('note')</script>"


class Page(HTMLParser):
    """The elements, ids, texts and addresses of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.words: list[str] = []
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        self.open.append(tag)

    def handle_endtag(self, tag):
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("script", "style"):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def page(any_comparison):
    return Page(render(any_comparison))


def test_the_page_loads_no_other_resource(page):
    addresses = {
        attributes[name]
        for _, attributes in page.elements
        for name in ("src", "href", "srcset")
        if name in attributes
    }
    assert {address for address in addresses if not address.startswith(("#", "data:,"))} == set()
    policy = [a["content"] for tag, a in page.elements if tag == "meta" and "http-equiv" in a]
    assert len(policy) == 1
    assert policy[0].startswith("default-src 'none'; ")


def test_ids_are_unique_and_every_link_has_its_target(page):
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    links = {a["href"][1:] for tag, a in page.elements if tag == "a"}
    controlled = {a["aria-controls"] for _, a in page.elements if "aria-controls" in a}
    assert (links | controlled) <= set(ids)


def test_every_figure_has_a_caption_and_a_label(page):
    tags = [tag for tag, _ in page.elements]
    assert tags.count("figure") == tags.count("figcaption")
    plots = [attributes for _, attributes in page.elements if attributes.get("class") == "plot"]
    assert all(len(attributes["aria-label"]) > 40 for attributes in plots)


def test_page_scripts_never_come_from_the_data(page, any_comparison):
    assert [tag for tag, _ in page.elements].count("script") == 3


def test_page_is_small(any_comparison):
    assert len(render(any_comparison).encode()) < 2_250_000


def test_the_most_important_results_are_at_the_top(shuttle):
    top = Page(render(shuttle)).text.partition("Where: utility")[0]
    for said in (
        "Degraded",
        "9.78",
        "−6.83",
        "9.42",
        "10.09",
        "16.90",
        "p < 0.001",
        "p = 0.001",
        "x 4.2–7.1 m, terrain true",
        "restores 98 % of the loss",
        "vel = 5 * delta",
        "terrain and 4.167 <= pos <= 7.083",
    ):
        assert said in top


def test_markup_in_notes_code_and_categories_is_escaped(two_lists):
    text = render(two_lists)
    assert NASTY not in text
    shown = Page(text).text
    assert NASTY in shown
    assert "light dusk <&>" in shown
    assert "größer → links" in shown
    code = 'if error < -0.5 and name != "<b>\'&amp;":'
    assert code in "".join(Page(text).words)


def test_page_contains_patch_and_apply_command(shuttle):
    text = Page(render(shuttle)).text
    assert "vel = ( 12.0 if terrain and 4.167 <= pos <= 7.083 else 5 ) * delta" in text
    assert "tarl apply .tarl/patches/test-delivers-mud-1a2b3c4d.patch" in text


def test_exponent_is_not_shown_as_the_constant(shuttle):
    law = OperandEffect("KP", 4.0, -1.7, 2.5, what="KP follows light")
    culprits = (replace(shuttle.culprits[0], operands=(law,)), *shuttle.culprits[1:])
    text = Page(render(replace(shuttle, culprits=culprits))).text
    assert "KP follows light" in text
    assert "-1.7" not in text


def test_several_lists_are_tabs_with_panels(two_lists):
    found = Page(render(two_lists)).elements
    assert sum(a.get("role") == "tab" for _, a in found) == 2
    assert [a["aria-labelledby"] for _, a in found if a.get("role") == "tabpanel"] == ["tab-0", "tab-1"]


def test_one_list_has_no_tabs(shuttle):
    assert not any(a.get("role") == "tab" for _, a in Page(render(shuttle)).elements)


def test_page_without_lists_gives_the_next_step(listless):
    text = Page(render(listless)).text
    assert "No taint list can be compared" in text
    assert "pytest tests/test_traveller.py::test_delivers --tarl-record" in text


def test_page_without_a_region_has_no_slices(placeless):
    text = Page(render(placeless)).text
    assert "No single situation stands out." in text
    assert "There are no slices, because no region was found." in text


def test_without_a_difference_no_line_is_blamed(unchanged):
    found = Page(render(unchanged))
    assert "No difference was found" in found.text
    assert not any(a.get("class") == "peak" for _, a in found.elements)
    assert "Culprits" not in found.text


def test_a_refused_repair_is_explained(two_lists):
    assert "None was accepted: the best change found gains too little." in Page(render(two_lists)).text


def test_the_title_can_be_set_and_is_escaped(shuttle):
    assert "<title>Degraded: A &lt;b&gt; world (mud)</title>" in render(shuttle, title="A <b> world")


def test_same_comparison_gives_the_same_file(shuttle, tmp_path):
    path = tmp_path / "report" / "delivers.html"
    write(shuttle, path)
    first = path.read_bytes()
    write(shuttle, path)
    assert path.read_bytes() == first
    assert list(path.parent.iterdir()) == [path]


def test_a_missing_package_is_reported_with_the_install_command(shuttle, monkeypatch):
    found = importlib.util.find_spec
    monkeypatch.setattr(html, "find_spec", lambda name: None if name == "plotly" else found(name))
    with pytest.raises(
        TarlError, match=r'needs plotly, which is not installed: run pip install .*\[report\]"'
    ):
        render(shuttle)


def test_an_unwritable_path_is_reported_in_one_sentence(shuttle, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("not a directory")
    with pytest.raises(TarlError, match=r"The report .*report\.html cannot be written \("):
        write(shuttle, blocked / "report.html")


def test_data_cannot_close_the_script_element_and_is_unchanged():
    data = {"code": NASTY + "\u2028 & <!--"}
    text = in_script(data)
    assert not re.search(r"[<>&\u2028]", text)
    assert json.loads(text) == data


@pytest.mark.parametrize(
    ("plain", "set_in_type"),
    [
        ("x 4.2-7.1 m", "x 4.2–7.1 m"),
        ("-6.83", "−6.83"),
        ("heading -3 to -1 rad", "heading −3 to −1 rad"),
        ("off-line", "off-line"),
        ("a-1", "a-1"),
    ],
)
def test_ranges_and_minus_signs_are_typeset(plain, set_in_type):
    assert typeset(plain) == set_in_type


def test_page_cites_the_paper_only_in_a_footnote(shuttle):
    page = render(replace(shuttle, purpose="Bring one parcel <from G1> to G2."))
    assert '<p class="purpose">Bring one parcel &lt;from G1&gt; to G2.</p>' in page
    body = page[page.index("<body>") : page.index('<script type="application/json"')]
    before, _, footnote = body.partition('<p class="footnote">')
    assert "Eq." not in before
    assert "Figure " not in before
    assert "paper" not in re.sub(r'class="[^"]*"', "", before)
    assert "figures 2 to 5" in footnote
