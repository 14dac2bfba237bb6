"""Ready-made faults of topics and nodes for `Drift.space`, such as `faults.bias("/odom", "x", 0.0, 0.5)`."""

from pytest_tarl.faults.bias import bias
from pytest_tarl.faults.dropout import dropout
from pytest_tarl.faults.duplicates import duplicates
from pytest_tarl.faults.freeze import freeze
from pytest_tarl.faults.jitter import jitter
from pytest_tarl.faults.latency import latency
from pytest_tarl.faults.noise import noise
from pytest_tarl.faults.quantisation import quantisation
from pytest_tarl.faults.reordering import reordering
from pytest_tarl.faults.restart import restart
from pytest_tarl.faults.scale import scale
from pytest_tarl.faults.sign import sign
from pytest_tarl.faults.swapped import swapped

__all__ = [
    "bias",
    "dropout",
    "duplicates",
    "freeze",
    "jitter",
    "latency",
    "noise",
    "quantisation",
    "reordering",
    "restart",
    "scale",
    "sign",
    "swapped",
]
