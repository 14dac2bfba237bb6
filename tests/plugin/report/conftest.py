"""Comparisons with realistic values, written by hand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from difflib import unified_diff
from random import Random

import numpy as np
import pytest

from pytest_tarl.model import (
    Comparison,
    Culprit,
    Edit,
    ListComparison,
    LossInterval,
    OperandEffect,
    Region,
    Repair,
    SearchTrace,
    SitePlace,
    Slice,
    TaintList,
    Verdict,
)
from pytest_tarl.sensors import Sensor

X = Sensor("x", topic="/odom", field="pose.pose.position.x", low=0, high=10, bins=24, unit="m")
TERRAIN = Sensor("terrain", topic="/terrain", field="data")
LIGHT = Sensor("light", topic="/light", field="data", categories=("day", "dusk <&>", "night"))

TRAVELLER = (
    (22, "rospy.Subscriber('odom', Odometry, callback)", "data", "register"),
    (17, "def callback(data):", "data", "receive"),
    (19, "pos = data.pose.pose.position.x", "data", "assign"),
    (28, "delta = goal - pos", "data", "assign"),
    (29, "err = abs(delta)", "control", "assign"),
    (30, "vel = 5 * delta", "data", "assign"),
    (31, "pub.publish(vel)", "data", "publish"),
)
BEFORE = """\
import rospy

pos = 0.0


def callback(data):
    global pos
    pos = data.pose.pose.position.x


def travel(goal, pub):
    delta = goal - pos
    while abs(delta) > 0.05:
        delta = goal - pos
        err = abs(delta)
        vel = 5 * delta
        pub.publish(vel)
"""
AFTER = (
    BEFORE.replace("import rospy\n", "import rospy\nfrom std_msgs.msg import Bool\n")
    .replace("pos = 0.0\n", "pos = 0.0\nterrain = False\n")
    .replace(
        "def travel",
        "def on_terrain(message):\n    global terrain\n    terrain = message.data\n\n\ndef travel",
    )
    .replace("vel = 5 *", "vel = (12.0 if terrain and 4.167 <= pos <= 7.083 else 5) *")
)
DIFF = "".join(
    unified_diff(
        BEFORE.splitlines(keepends=True), AFTER.splitlines(keepends=True), "a/traveller.py", "b/traveller.py"
    )
)


def sites(path: str, written: tuple[tuple[int, str, str, str], ...]) -> tuple[SitePlace, ...]:
    module = path.removesuffix(".py").replace("/", ".")
    return tuple(SitePlace(f"{module}:{code}", path, line, code, *kind) for line, code, *kind in written)


def compared(name: tuple[str, str], places: tuple[SitePlace, ...], cells, bad, peak: int) -> ListComparison:
    """Return utilities that rise towards the goal and fall in the bad cells, most of all at the site `peak`."""
    noise = np.random.default_rng(len(places))
    progress = np.array([cell[0] / 24 for cell in cells])[:, None]
    weight = 1.0 + np.exp(-0.5 * (np.arange(len(places)) - peak) ** 2)
    offline = 2 + 6 * progress * weight + noise.normal(0, 0.15, (len(cells), len(places)))
    online = offline + noise.normal(0, 0.15, offline.shape)
    rows = [i for i, cell in enumerate(cells) if cell in bad]
    online[rows] -= 4.5 * weight * (1 + 0.2 * noise.normal(size=(len(rows), 1)))
    offline[0, :2] = online[-1, 3:] = np.nan
    taint_list = TaintList(*name, places)
    totals = np.nansum(offline[rows], axis=0), np.nansum(online[rows], axis=0)
    slices = tuple(
        Slice(site, taint_list.name, float(a), float(b)) for site, a, b in zip(places, *totals, strict=True)
    )
    return ListComparison(taint_list, offline, online, slices)


def replace_slices(one: ListComparison, value: float) -> ListComparison:
    """Return the list with equal values in both worlds for every slice, as for an empty region."""
    slices = tuple(replace(one_slice, offline=value, online=value) for one_slice in one.slices)
    return replace(one, slices=slices)


def rewards(mean: float, count: int, spread: float = 1.2) -> tuple[float, ...]:
    random = Random(f"{mean} {count}")
    return tuple(random.gauss(mean, spread) for _ in range(count))


def search() -> SearchTrace:
    random, totals, labels = Random(3), [], []
    for episode in range(60):
        best = random.random() < min(0.9, episode / 30)
        factor = 12.0 if best else random.choice([0.75, 2.0, 5.0, 8.0, 50.0])
        totals.append(random.gauss(9.3 if best else -6 + factor / 4, 1.0))
        labels.append(f"5 → {factor:g}")
    return SearchTrace("epsilon-greedy", tuple(totals), tuple(labels))


@pytest.fixture(scope="session")
def shuttle() -> Comparison:
    """A comparison of the delivery robot: two sensors, one list of seven sites, degraded and repaired."""
    cells = tuple(sorted([(i, 0) for i in range(24)] + [(i, 1) for i in range(10, 17)]))
    bad = tuple(cell for cell in cells if cell[1])
    places = sites("traveller.py", TRAVELLER)
    only = compared(("/odom", "/velocity"), places, cells, bad, peak=5)
    five = OperandEffect("5", 5, 12.0, 14.2)
    culprits = (
        Culprit(places[5], 0.93, "sweep", (five,)),
        *(Culprit(site, 0.0, "slices") for site in (places[3], places[6], places[4], places[2])),
    )
    return Comparison(
        test="tests/test_traveller.py::test_delivers",
        drift="mud",
        seed=1,
        sensors=(X, TERRAIN),
        cells=cells,
        lists=(only,),
        verdict=Verdict("degraded", 0.001, 0.0005, 16.9, 0.41, 0.5, LossInterval(15.4, 18.1, 0.9)),
        region=Region(bad),
        paper_region=((10, 0), *bad[1:-1]),
        totals={
            "offline": rewards(9.8, 120),
            "online": rewards(-7.1, 40, 4),
            "repaired": rewards(9.6, 28),
            "nominal_repaired": rewards(9.8, 17),
        },
        culprits=culprits,
        searches=(search(), SearchTrace("sweep", rewards(2.0, 31, 5.0))),
        repair=Repair(
            True,
            "terrain and 4.167 <= pos <= 7.083",
            (Edit("traveller.py", 30, "5", 12.0),),
            DIFF,
            ".tarl/patches/test-delivers-mud-1a2b3c4d.patch",
        ),
        notes=("The site `err = abs(delta)` is only reached by a condition.",),
        parts={"progress": (12.4, 3.1), "clearance": (-2.6, -10.2)},
    )


@pytest.fixture(scope="session")
def two_lists(shuttle: Comparison) -> Comparison:
    """A comparison with two lists that share a site, three sensors, a new value of the light, and a refused repair."""
    cells = tuple(
        sorted(
            (x, terrain, light)
            for x in range(-1, 25)
            for terrain in (0, 1)
            for light in (0, 1, 2)
            if not (terrain and 6 < x < 12)
        )
    )
    bad = tuple(cell for cell in cells if cell[2] == 1 and 3 <= cell[0] <= 20)
    novel = tuple(cell for cell in cells if cell[2] == 2 and cell[0] > 18)
    turn = sites(
        "src/follower/node.py",
        (
            (
                41,
                "self.create_subscription(Float32MultiArray, 'reflectance', self.on_line, qos_sensor)",
                "data",
                "register",
            ),
            (52, "values = [v for v in message.data if v < LIMIT & 0xFF]", "data", "assign"),
            (
                57,
                "error = (values[0] - values[-1]) / max(sum(values), 1e-6)  # größer → links",
                "data",
                "assign",
            ),
            (61, 'if error < -0.5 and name != "<b>\'&amp;":', "control", "condition"),
            (63, "twist.angular.z = self.kp * error + self.kd * (error - self.last)", "data", "assign"),
            (70, "self.publisher.publish(twist)", "data", "publish"),
        ),
    )
    speed = (
        *turn[:2],
        *sites(
            "src/follower/node.py",
            (
                (66, "twist.linear.x = SPEED * (1 - min(abs(error), 1.0))", "data", "assign"),
                (71, "self.status.publish(String(data=f'{error:+.2f} ½'))", "data", "publish"),
            ),
        ),
    )
    lists = (
        compared(("/reflectance", "/cmd_vel"), turn, cells, bad, 4),
        compared(("/reflectance", "/status"), speed, cells, bad, 2),
    )
    kp = OperandEffect("self.kp", None, 2.2, 3.4)
    return replace(
        shuttle,
        test="tests/test_follower.py::test_follows[a b]",
        drift=None,
        sensors=(X, TERRAIN, LIGHT),
        cells=cells,
        lists=lists,
        verdict=Verdict("degraded", 0.013, 0.021, 3.72, 0.8, 0.5, LossInterval(0.31, 6.9, 0.9)),
        region=Region(bad, novel),
        paper_region=(),
        totals={"offline": rewards(4.2, 40), "online": rewards(0.5, 12)},
        searches=(),
        culprits=(
            Culprit(turn[4], 0.5, "sweep", (kp, OperandEffect("self.kd", 0.1, 0.22, 0.4))),
            *(Culprit(site, 0.0, "slices") for site in (turn[2], speed[2], turn[1])),
        ),
        repair=Repair(
            False,
            "light == 'dusk <&>'",
            (Edit("src/follower/node.py", 63, "self.kp", 2.2, factor=True),),
            reason="gain too small",
        ),
        notes=("</script><script>alert('note')</script>", "Second note", "Third note", "Fourth"),
        parts={},
    )


@pytest.fixture(scope="session")
def unrepaired(shuttle: Comparison) -> Comparison:
    """A degraded comparison without a search for a repair."""
    totals = {world: shuttle.totals[world] for world in ("offline", "online")}
    slices_only = tuple(replace(culprit, method="slices", operands=()) for culprit in shuttle.culprits)
    return replace(shuttle, repair=None, searches=(), totals=totals, culprits=slices_only, parts={})


@pytest.fixture(scope="session")
def unchanged(unrepaired: Comparison) -> Comparison:
    """A comparison of two equal worlds."""
    flat = [replace_slices(one, 0.0) for one in unrepaired.lists]
    noise = np.random.default_rng(5).normal(0, 0.05, unrepaired.lists[0].offline.shape)
    same = tuple(replace(one, online=one.offline + noise) for one in flat)
    return replace(
        unrepaired,
        lists=same,
        verdict=Verdict("no difference", 0.42, 0.63, -0.03, 0.71, 0.5),
        region=Region(),
        paper_region=(),
        culprits=(),
        notes=(),
        drift=None,
        totals={"offline": rewards(9.8, 120), "online": rewards(9.83, 40)},
    )


@pytest.fixture(scope="session")
def placeless(unrepaired: Comparison) -> Comparison:
    """A loss without a region, so there are no slices."""
    empty = tuple(replace_slices(one, 0.0) for one in unrepaired.lists)
    return replace(unrepaired, region=Region(), paper_region=(), lists=empty)


@pytest.fixture(scope="session")
def listless(unrepaired: Comparison) -> Comparison:
    """A comparison without taint lists, because every site was edited since the recording."""
    note = "All sites of /odom → /velocity changed since the recording: record again to see slices."
    return replace(unrepaired, lists=(), culprits=(), notes=(note,))


@pytest.fixture(
    scope="session", params=["shuttle", "two_lists", "unrepaired", "unchanged", "placeless", "listless"]
)
def any_comparison(request: pytest.FixtureRequest) -> Comparison:
    """Each of the comparisons in turn."""
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="session")
def varied(shuttle: Comparison) -> Callable[..., Comparison]:
    """Return the shuttle's comparison with other values in some fields."""
    return lambda **changes: replace(shuttle, **changes)
