"""Values with hostile text in the places where a page shows text from elsewhere, and a script that finds what ran."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import fields, is_dataclass, replace
from typing import Any

MARK = "document.documentElement.dataset.ran=1"
PIECES = (
    f"</script><script>{MARK}</script>",
    f'"><img src=x onerror="{MARK}">',
    f"'><svg onload='{MARK}'>",
    f"</style></title></textarea><script>{MARK}</script>",
    f'<a href="javascript:{MARK}">link</a>',
    f"javascript:{MARK}//",
    f'<iframe srcdoc="<script>parent.{MARK}</script>">',
    f"<!--<script>{MARK}//-->",
    f"{{{{ 7*7 }}}}${{{MARK}}}",
    "\u202eevil\u2066\u2028\u2029\x00\x1b[31m\ufffe",
)
HOSTILE = " ".join(PIECES)
HUGE = HOSTILE + "W" * 100_000

# Click and hover everywhere, as a reader does, and report what ran or could run
PROBE = """<script>(async () => {
const found = {violations: []}, root = document.documentElement;
addEventListener("securitypolicyviolation", event => found.violations.push(event.blockedURI));
const pause = time => new Promise(done => setTimeout(done, time));
for (let i = 0; i < 100 && !root.dataset.report; i++) await pause(50);
found.report = root.dataset.report;
for (const one of document.querySelectorAll("a, button, summary, [role=tab], .cell, text")) {
  for (const kind of ["mouseover", "click"]) one.dispatchEvent(new MouseEvent(kind, {bubbles: true}));
}
await pause(300);
found.ran = root.dataset.ran ?? null;
found.scripts = document.scripts.length;
const handled = one => [...one.attributes].some(at => /^on/i.test(at.name));
found.handlers = [...document.querySelectorAll("*")].filter(handled).map(one => one.outerHTML.slice(0, 100));
found.links = [...document.querySelectorAll("[href], [src], [*|href]")].map(one => one.getAttribute("href") ??
  one.getAttribute("src") ?? one.getAttribute("xlink:href")).filter(one => /^\\s*javascript:/i.test(one ?? ""));
found.foreign = document.querySelectorAll("iframe, object, embed, body svg[onload], img[src=x]").length;
found.text = document.body.innerText.includes("dataset.ran=1") || document.body.textContent.includes("dataset.ran=1");
document.body.dataset.found = JSON.stringify(found);
})();</script></body>"""


def planted(value: Any, names: Collection[str], text: str = HOSTILE) -> Any:
    """Return a value of dataclasses, tuples and dictionaries with `text` added to each string field in `names`."""
    if is_dataclass(value) and not isinstance(value, type):
        changes = {}
        for one in fields(value):
            held = getattr(value, one.name)
            if one.init and isinstance(held, str) and held and one.name in names:
                changes[one.name] = held + text
            elif one.init and (inner := planted(held, names, text)) is not held:
                changes[one.name] = inner
        return replace(value, **changes) if changes else value
    if isinstance(value, tuple) and type(value) is tuple:
        new = tuple(planted(one, names, text) for one in value)
        return new if any(a is not b for a, b in zip(new, value, strict=True)) else value
    return value
