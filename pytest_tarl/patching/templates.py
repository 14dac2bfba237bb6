"""Templates of structural repairs: TOML files whose examples serve as tests and documentation."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.patching.expression_texts import ARITHMETIC, ATOM, TERM, enclosed
from pytest_tarl.symptoms.symptoms import SYMPTOMS

if sys.version_info >= (3, 11):
    import tomllib
else:  # pragma: no cover
    import tomli as tomllib

SHIPPED = Path(__file__).parent.parent / "templates"
OWN = "tarl_templates"  # folder below pytest's rootdir for the project's own templates
KINDS = (
    "value",
    "input",
    "tracked",
    "number",
    "comparison",
    "pair",
    "sent",
    "field",
    "sensor",
    "sent by sensor",
    "constant",
)
CONSTANT = "constant"  # a constant that follows a sensor or a variable
TRACKED = "tracked"  # a side of a difference, such as the target in `target - position`
PAIR = "pair"  # two expressions that differ only in their axis
FIELD = "field"  # a field of a published message that several statements build
SENT_BY_SENSOR = "sent by sensor"  # a published value
OF_SENSORS = ("sensor", SENT_BY_SENSOR)  # kinds that are tried with each numeric sensor
SCALES = (  # units of a parameter's default
    "",  # the default itself, unscaled
    "typical",  # the value's usual size in the designed world
    "larger",  # the larger of the value's usual sizes in the designed and the drifted world
    "sensor",  # 1 divided by the sensor's usual size in the drifted world
    "usual",  # the sensor's usual size in the drifted world
    "ratio",  # `larger` divided by the sensor's usual size in the drifted world
    "designed",  # the sensor's usual size in the designed world, for sensors that are never negative
)
FIXED = "designed"  # parameters with this scale are not searched
STRONGER = ("larger", "smaller")
# Values of `without`: expressions with this kind of constant at their top level are skipped, because the search can
# change the constant instead.
WITHOUT = ("", "factor", "term")
# placeholders of a comparison: its operator, the operator with or without equality, and the reversed operator
OPERATORS = ("op", "closed", "back")
_KEYS = {
    "summary",
    "on",
    "without",
    "inside",
    "cost",
    "lines",
    "expression",
    "state",
    "symptoms",
    "parameters",
    "example",
}
_PLACEHOLDER = re.compile(r"\{(\w+)\}")
_ADDED = re.compile(r"\+ \{(\w+)\}(?= \*|$)")
_NEGATIVE = re.compile(r"-([0-9][0-9.e+-]*)")
LEADING = {
    "*": TERM,
    "+": ARITHMETIC,
}  # operator → lowest precedence of a first operand without parentheses


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter to search, and its start value.

    `stronger` says whether larger or smaller values have more effect. With a `grid`, only multiples of it are tried. A
    `signed` parameter may change its sign.
    """

    name: str
    default: float
    of: str = ""
    stronger: str = "larger"
    grid: float = 0.0
    signed: bool = False


@dataclass(frozen=True, slots=True)
class Template:
    """The replacement for an expression, the lines to add before it, and the state kept between calls."""

    name: str
    summary: str
    on: str
    cost: int
    expression: str
    lines: tuple[str, ...] = ()
    state: tuple[tuple[str, str], ...] = ()
    parameters: tuple[Parameter, ...] = ()
    without: str = ""
    symptoms: tuple[str, ...] = ()  # symptoms that suggest the template (see `pytest_tarl.symptoms`)
    inside: bool = False  # for sensors: whether the change goes inside a clamp

    @property
    def from_first(self) -> bool:
        """Return whether the state starts from the first value, so that a value that never varies stays unchanged."""
        return any(initial in ("None", "[]") for _, initial in self.state)

    @property
    def from_zero(self) -> bool:
        """Return whether the result is a state that starts from 0, as if all earlier values had been 0."""
        return any(initial == "0.0" and self.expression == f"{{{name}}}" for name, initial in self.state)

    def uses(self, placeholder: str) -> int:
        """Return how often the lines and the expression contain a placeholder."""
        return sum(_PLACEHOLDER.findall(text).count(placeholder) for text in (*self.lines, self.expression))


def templates(root: Path) -> tuple[Template, ...]:
    """Return the templates of TARL and of the project, cheapest first. Raise SettingsError."""
    files = [*sorted(SHIPPED.glob("*.toml")), *sorted((root / OWN).glob("*.toml"))]
    found = {path.stem: template(path) for path in files}
    return tuple(sorted(found.values(), key=lambda one: one.cost))


def template(path: Path) -> Template:
    """Read a template. Raise SettingsError if the file is not a template."""
    data = contents(path)
    unknown = sorted(data.keys() - _KEYS)
    if unknown:
        raise SettingsError(
            f"{path}: a template has no key {unknown[0]!r}; its keys are {', '.join(sorted(_KEYS))}."
        )
    try:
        parameters = tuple(
            Parameter(
                name,
                float(one["default"]),
                one.get("of", ""),
                one.get("stronger", STRONGER[0]),
                float(one.get("grid", 0.0)),
                bool(one.get("signed", False)),
            )
            for name, one in data.get("parameters", {}).items()
        )
        made = Template(
            path.stem,
            str(data["summary"]),
            str(data["on"]),
            int(data["cost"]),
            str(data["expression"]),
            tuple(map(str, data.get("lines", ()))),
            tuple((name, str(initial)) for name, initial in data.get("state", {}).items()),
            parameters,
            str(data.get("without", "")),
            tuple(map(str, data.get("symptoms", ()))),
            bool(data.get("inside", False)),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as problem:
        raise SettingsError(
            f"{path}: not a template ({type(problem).__name__}: {problem}); it needs summary, on, cost and "
            "expression."
        ) from problem
    if made.on not in KINDS:
        raise SettingsError(f"{path}: on = {made.on!r} is unknown; use one of {', '.join(KINDS)}.")
    if made.without not in WITHOUT:
        raise SettingsError(f"{path}: without = {made.without!r} is unknown; use factor or term, or omit it.")
    for name in made.symptoms:
        if name not in SYMPTOMS:
            raise SettingsError(
                f"{path}: the symptom {name!r} is unknown; known are {', '.join(sorted(SYMPTOMS))}."
            )
    _check_placeholders(path, made)
    return made


def contents(path: Path) -> Mapping[str, Any]:
    """Read a TOML file. Raise SettingsError."""
    try:
        return tomllib.loads(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as problem:
        raise SettingsError(f"{path} cannot be read as TOML: {problem}.") from problem


def filled(text: str, values: Mapping[str, str]) -> str:
    """Replace the placeholders in a text, with parentheses where the surrounding expression needs them."""

    def put(match: re.Match[str]) -> str:
        code = values[match[1]]
        if match[1] in OPERATORS:
            return code
        before, after = text[: match.start()].rstrip()[-1:], text[match.end() :].lstrip()[:1]
        free = before in ("", "(", ",") and after in ("", ")", ",")
        first = before in ("", "(", ",")
        return code if free else enclosed(code, LEADING.get(after, ATOM) if first else ATOM)

    return _PLACEHOLDER.sub(put, _ADDED.sub(partial(_subtracted, values), text))


def _subtracted(values: Mapping[str, str], match: re.Match[str]) -> str:
    """Write a sum with a negative number as a difference (`- 0.2`, not `+ -0.2`), also before products."""
    negative = _NEGATIVE.fullmatch(values.get(match[1], ""))
    return f"- {negative[1]}" if negative else match[0]


def plainly(text: str, values: Mapping[str, str]) -> str:
    """Return a sentence with its placeholders replaced; unknown placeholders stay."""
    return _PLACEHOLDER.sub(lambda match: values.get(match[1], match[0]), text)


def _check_placeholders(path: Path, made: Template) -> None:
    known = {"x", "y", "left", "right", "sensor", *OPERATORS}
    known |= {name for name, _ in made.state} | {one.name for one in made.parameters}
    for name in _placeholders(made):
        if name not in known:
            raise SettingsError(
                f"{path}: unknown placeholder {{{name}}}; known are {', '.join(sorted(known))}."
            )
    for one in made.parameters:
        if one.of not in SCALES:
            raise SettingsError(
                f"{path}: of = {one.of!r} is unknown; use {', '.join(SCALES[1:])}, or omit it."
            )
        if one.stronger not in STRONGER:
            raise SettingsError(f"{path}: stronger = {one.stronger!r} is unknown; use larger or smaller.")


def _placeholders(made: Template) -> Iterator[str]:
    for text in (*made.lines, made.expression):
        yield from _PLACEHOLDER.findall(text)
