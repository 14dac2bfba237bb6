"""Run STGEM's test suite generator OGAN as a peer: write points from -1 to 1 as JSON lines, and read their costs.

python stgem_peer.py DIMENSIONS BUDGET SEED

STGEM's own faster parameters are used (512 instead of 8192 noise vectors per training), with a single thread: a run of
149 tests takes 14 s of CPU time. With its default parameters, it takes more than a minute.
"""

import json
import os
import sys

os.environ["CICD"] = "1"  # STGEM reads this variable on import; it selects faster parameters

import torch
from stgem.features import FeatureVector, Real
from stgem.limit import TestCount
from stgem.monitor import Monitor
from stgem.sut import SystemUnderTest
from stgem.testsuitegenerator import run
from stgem.testsuitegenerator.ogan import OGAN_TestSuiteGenerator

torch.set_num_threads(1)
WORST = 2.0  # the largest cost; STGEM expects outputs from 0 to 1
size, budget, seed = map(int, sys.argv[1:])
points = sys.stdout
sys.stdout = sys.stderr


class Asking(SystemUnderTest):
    """A system that the other process evaluates."""

    def new_ifv(self):
        """Return the inputs."""
        return FeatureVector(features=[Real(f"x{i}", -1.0, 1.0) for i in range(size)])

    def new_ofv(self):
        """Return the output."""
        return FeatureVector(features=[Real("cost", 0.0, 1.0, clip=True)])

    def from_ifv_to_testinput(self, input_fv):
        """Return the numbers of an input."""
        return input_fv.to_list()

    def from_testouput_to_ofv(self, output):
        """Return the output for a number."""
        found = self.new_ofv()
        found.set([output])
        return found

    def execute_test(self, test_input):
        """Return the cost of a point."""
        print(json.dumps([float(value) for value in test_input]), file=points, flush=True)
        line = sys.stdin.readline()
        if not line:
            raise SystemExit(0)
        return min(float(line) / WORST, 1.0), {}


class Cost(Monitor):
    """The cost, used as robustness; the search does not stop at a failure."""

    def __call__(self, obj, strict_horizon_check=True, scale=False):  # noqa: ARG002
        """Return the cost of an execution."""
        return float(obj["cost"] if isinstance(obj, dict) else obj.to_list()[-1])


run(OGAN_TestSuiteGenerator(sut=Asking(), goal=Cost(), limit=TestCount(budget)), seed=seed)
