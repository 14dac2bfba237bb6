"""Run Ψ-TaLiRo's dual annealing as a peer: write points from -1 to 1 as JSON lines, and read their costs.

python psy_taliro_peer.py DIMENSIONS BUDGET SEED
"""

import json
import sys

from staliro import optimizers
from staliro.signals import Interval


class Asking:
    """An objective that the other process evaluates."""

    def eval_sample(self, sample):
        """Return the cost of a sample."""
        print(json.dumps([float(value) for value in sample.values]), flush=True)
        line = sys.stdin.readline()
        if not line:
            raise SystemExit(0)
        return float(line)


size, budget, seed = map(int, sys.argv[1:])
params = optimizers.Optimizer.Params(seed=seed, budget=budget, input_bounds=[Interval(-1.0, 1.0)] * size)
optimizers.DualAnnealing().optimize(Asking(), params)
