"""Fit a cost model of `tarl ingest` and `tarl fleet` to measurements, and extrapolate it to a larger fleet.

    python benchmarks/fleet_cost.py [--missions 1e9] [--core-hour 0.05] [--gb-month 0.023]

The measurements are those in docs/benchmarks/fleet.md, section "A fleet". Pass others as `--measured 100000:20.1:500
1000000:80.2:1300`: number of missions, CPU seconds of a query, and peak memory (MB). Prices are assumptions in dollars;
replace them by those of your provider.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

MEASURED = ("100000:12.9:571", "400000:29.7:813", "1000000:61.4:1242")
BYTES = 193  # stored bytes per mission without taint lists
INGESTED = 2000  # missions ingested per CPU second
# bytes that a worker returns per mission: the mission's number, and one byte per score
SCORES = 26 + 16
TAKEN = 26 + 25  # bytes that a task receives per mission: scores and results
PARALLEL = 0.75  # share of a query's CPU time spent on workers
TRANSFER = 1.25e9  # bytes per second between client and workers (10 Gbit/s)


@dataclass(frozen=True)
class Line:
    """A quantity as a linear function of the number of missions."""

    fixed: float
    each: float

    def at(self, missions: float) -> float:
        """Return the quantity for this number of missions."""
        return self.fixed + self.each * missions


def fitted(missions: list[float], values: list[float]) -> Line:
    """Fit the line with the smallest sum of squared relative errors."""
    weight = 1.0 / np.array(values)
    columns = np.stack([np.ones(len(missions)), np.array(missions)], axis=1)
    fixed, each = np.linalg.lstsq(columns * weight[:, None], np.ones(len(values)), rcond=None)[0].tolist()
    return Line(fixed, each)


def main() -> None:
    """Print the fit and the plan."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--missions", type=float, default=1e9)
    parser.add_argument("--core-hour", type=float, default=0.05, help="dollars")
    parser.add_argument("--gb-month", type=float, default=0.023, help="dollars for stored data")
    parser.add_argument("--measured", nargs="+", default=MEASURED, metavar="MISSIONS:SECONDS:MB")
    order = parser.parse_args()
    rows = [[float(part) for part in one.split(":")] for one in order.measured]
    sizes, seconds, memory = (list(column) for column in zip(*rows, strict=True))
    cpu, peak = fitted(sizes, seconds), fitted(sizes, memory)
    print(f"query:    {cpu.fixed:.1f} s + {1e6 * cpu.each:.1f} s for 10^6 missions (CPU)")
    print(f"memory:   {peak.fixed:.0f} MB + {1e6 * peak.each:.0f} MB for 10^6 missions")
    for size, told, used in zip(sizes, seconds, memory, strict=True):
        print(
            f"  {size:,.0f} missions: {told:.1f} s (fit {cpu.at(size):.1f}), {used:.0f} MB (fit {peak.at(size):.0f})"
        )
    many = order.missions
    stored, hours, ingest = BYTES * many / 1e9, cpu.at(many) / 3600, many / INGESTED / 3600
    print(f"{many:,.0f} missions:")
    print(f"  stored: {stored:,.0f} GB, {stored * order.gb_month:,.2f} dollars a month")
    print(f"  ingest: {ingest:,.0f} core hours, {ingest * order.core_hour:,.2f} dollars, once")
    print(f"  a query: {hours:,.1f} core hours, {hours * order.core_hour:,.2f} dollars")
    print(f"  of these, on one machine for any size of the cluster: {(1 - PARALLEL) * hours:,.1f} core hours")
    print(f"  memory of the machine that asks: {peak.at(many) / 1000:,.0f} GB")
    # TAKEN counts twice, because robots and groups are judged in separate tasks
    moved = many * (SCORES + 2 * TAKEN)
    print(f"  scores from and to the workers: {moved / 1e9:,.0f} GB, {moved / TRANSFER / 60:,.0f} minutes")


if __name__ == "__main__":
    main()
