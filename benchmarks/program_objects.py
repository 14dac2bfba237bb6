"""Objects and functions of random programs."""

from __future__ import annotations

import random
import textwrap

from program_definitions import DEFINITIONS

NAMES = ("scan", "arm_left", "arm_right", "base-2", "Wheel7", "lidar", "tilt pan", "gps0", "cam_3", "")


class Objects:
    """Writes definitions, and returns expressions that use them; subclasses write the expressions of each type."""

    def __init__(self, source: random.Random) -> None:
        self.random = source
        self.definitions: list[str] = []
        self.made = 0

    def number(self) -> str:
        """Return a number."""
        raise NotImplementedError

    def text(self) -> str:
        """Return a text."""
        raise NotImplementedError

    def texts(self) -> str:
        """Return a list of texts."""
        raise NotImplementedError

    def numbers(self) -> str:
        """Return a list of numbers."""
        raise NotImplementedError

    def name(self, kind: str) -> str:
        """Return a new name."""
        self.made += 1
        return f"{kind}{self.made}"

    def word(self) -> str:
        """Return a text."""
        return repr(self.random.choice(NAMES))

    def small(self) -> str:
        """Return a small number."""
        return str(self.random.randint(1, 4))

    def define(self, kind: str, text: str, **parts: str) -> str:
        """Add a definition in which NAME and the names of the parts are replaced; return its name."""
        name = self.name(kind)
        for key, part in {**parts, "NAME": name}.items():
            text = text.replace(key, part)
        self.definitions.append(textwrap.dedent(text).strip("\n"))
        return name

    def converted(self) -> str:
        """Return the name of a function with `try`, `else` and `finally`."""
        return self.define(
            "convert",
            DEFINITIONS["convert"],
        )

    def guarded(self) -> str:
        """Return the name of a function with its own exceptions."""
        return self.define(
            "guarded",
            DEFINITIONS["guarded"],
            KIND=self.random.choice(("key", "not key", "table")),
        )

    def matched(self) -> str:
        """Return the name of a function with `match`."""
        return self.define(
            "matched",
            DEFINITIONS["matched"],
        )

    def subject(self) -> str:
        """Return a value for `match`."""
        return self.random.choice((
            self.texts(), self.text(), self.number(), "None", "{'kind': 'arm', 'size': 3}",
            f"{{'kind': {self.word()}, 'x': 1}}", "{'kind': 'x'}", "('scan', 1, 2)", f"[{self.word()}, {self.word()}]",
        ))  # fmt: skip

    def counted(self) -> str:
        """Return the name of a function with a closure and an endless iterator."""
        return self.define(
            "counted",
            DEFINITIONS["counted"],
            STEP=self.small(),
        )

    def generator(self) -> str:
        """Return the name of a generator."""
        return self.define(
            "generated",
            DEFINITIONS["generated"],
            LAST=self.small(),
        )

    def rotated(self) -> str:
        """Return the name of a decorated function."""
        return self.define(
            "rotated",
            DEFINITIONS["rotated"],
        )

    def sliced(self) -> str:
        """Return the name of a function with slices and iterators."""
        return self.define(
            "sliced",
            DEFINITIONS["sliced"],
            STEP=self.small(),
        )

    def grouped(self) -> str:
        """Return the name of a function with a defaultdict."""
        return self.define(
            "grouped",
            DEFINITIONS["grouped"],
            STEP=self.small(),
        )

    def merged(self) -> str:
        """Return the name of a function with an OrderedDict."""
        return self.define(
            "merged",
            DEFINITIONS["merged"],
        )

    def shape(self) -> str:
        """Return an object of a class with special methods."""
        name = self.define("Shape", DEFINITIONS["Shape"], STEP=self.small())  # fmt: skip
        return self.random.choice((
            f"{name}({self.word()}, {self.word()})", f"{name}.named({self.text()})", f"{name}.unit()",
            f"({name}('a', 'b') + {name}.unit())",
        ))  # fmt: skip

    def record(self) -> str:
        """Return an object of a data class."""
        known = [one for one in self.definitions if "class Record" in one]
        if known:
            name = known[0].split("class Record")[1].split(":")[0]
            name = f"Record{name}"
        else:
            frozen = self.random.choice(("True", "False"))
            name = self.define("Record", DEFINITIONS["Record"], FROZEN=frozen)
        return self.random.choice((
            f"{name}({self.number()})", f"{name}({self.number()}, {self.text()})",
            f"{name}(name={self.word()}, speed={self.number()}, tags=[{self.word()}])",
        ))  # fmt: skip

    def point(self) -> str:
        """Return a named tuple."""
        name = self.define("Point", self.random.choice((
            "NAME = namedtuple('NAME', 'x y', defaults=[2])",
            """
            class NAME(NamedTuple):
                x: float
                y: float = 1.5
            """,
        )))  # fmt: skip
        return self.random.choice((f"{name}({self.number()})", f"{name}({self.number()}, y={self.number()})",
                                   f"{name}(*[{self.number()}, {self.number()}])"))  # fmt: skip

    def level(self) -> str:
        """Return a member of a numeric enumeration."""
        name = self.define(
            "Level",
            DEFINITIONS["Level"],
            TOP=str(self.random.randint(4, 9)),
        )
        return self.random.choice((f"{name}.LOW", f"{name}['MID']", f"{name}(1)", f"max({name})"))

    def colour(self) -> str:
        """Return a member of an enumeration of texts."""
        name = self.define(
            "Colour",
            DEFINITIONS["Colour"],
        )
        return self.random.choice((f"{name}.RED", f"{name}('scan')", f"{name}.parse({self.text()})"))

    def flags(self) -> str:
        """Return a combination of flags."""
        name = self.define(
            "Flags",
            DEFINITIONS["Flags"],
        )
        return self.random.choice((
            f"{name}.A | {name}.C", f"{name}.BOTH & {name}.B", f"{name}.BOTH",
            f"({name}.A if {name}.B in {name}.BOTH else {name}.C)", f"({name}.NONE or {name}.C)",
        ))  # fmt: skip

    def index(self) -> str:
        """Return an object of a class that is a container."""
        name = self.define(
            "Index",
            DEFINITIONS["Index"],
            DEFAULT=self.small(),
        )
        return f"{name}(*{self.pairs_of_texts()})"

    def pairs_of_texts(self) -> str:
        """Return a list of pairs that begin with a text."""
        return f"list(zip({self.texts()}, {self.numbers()}))"

    def managed(self) -> str:
        """Return the name of a function with context managers."""
        return self.define(
            "managed",
            DEFINITIONS["managed"],
            STEP=self.small(),
        )

    def planet(self) -> str:
        """Return a member of an enumeration whose members have attributes."""
        name = self.define(
            "Planet",
            DEFINITIONS["Planet"],
            STEP=self.small(),
        )
        return self.random.choice((f"{name}.A", f"{name}(('a', 2.5))", f"{name}.B.next()"))

    def configured(self) -> str:
        """Return an object of a data class with arguments that are not fields."""
        name = self.define(
            "Configured",
            DEFINITIONS["Configured"],
            STEP=self.small(),
        )
        return self.random.choice((f"{name}({self.word()})", f"{name}({self.word()}, {self.number()})"))

    def layout(self) -> str:
        """Return an object of a class that is a list."""
        name = self.define(
            "Layout",
            DEFINITIONS["Layout"],
            STEP=self.small(),
        )
        return self.random.choice((f"{name}({self.texts()})", f"{name}().add({self.text()}).add('last')"))

    def lookup(self) -> str:
        """Return an object of a class that is a dict."""
        name = self.define(
            "Lookup",
            DEFINITIONS["Lookup"],
        )
        return self.random.choice((f"{name}(scan={self.word()})", f"{name}(('a', 'b'), c={self.text()})"))

    def countdown(self) -> str:
        """Return an object of a class that is an iterator."""
        name = self.define(
            "Countdown",
            DEFINITIONS["Countdown"],
        )
        return f"{name}({self.small()})"

    def celsius(self) -> str:
        """Return an object of a class that is a number."""
        name = self.define(
            "Celsius",
            DEFINITIONS["Celsius"],
            STEP=self.small(),
        )
        return self.random.choice((f"{name}({self.small()})", f"{name}('2.5').warmer()"))

    def mode(self) -> str:
        """Return a member of an enumeration."""
        name = self.define("Mode", DEFINITIONS["Mode"], WRITTEN=self.random.choice((
                "def __str__(self): return self.value.upper()", "steps = property(lambda self: 2)")))  # fmt: skip
        return self.random.choice((f"{name}.IDLE", f"{name}('drive')", f"{name}.ALIAS", f"list({name})[-1]"))
