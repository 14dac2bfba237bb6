"""Record the utility of robot code in simulation, locate the code that fails in another world, and repair it."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pytest_tarl import faults
    from pytest_tarl.drifts import Drift
    from pytest_tarl.episode import Tarl
    from pytest_tarl.formulas.signals import Signal
    from pytest_tarl.searching.ask_tell import Constant, Optimiser
    from pytest_tarl.sensors import Sensor

__all__ = ["Constant", "Drift", "Optimiser", "Sensor", "Signal", "Tarl", "faults"]

_HOMES = {
    "Constant": "pytest_tarl.searching.ask_tell",
    "Drift": "pytest_tarl.drifts",
    "Optimiser": "pytest_tarl.searching.ask_tell",
    "Sensor": "pytest_tarl.sensors",
    "Signal": "pytest_tarl.formulas.signals",
    "Tarl": "pytest_tarl.episode",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: every pytest run loads this package, but few use it."""
    if name in _HOMES:
        from pytest_tarl.extras import missing_extra

        sentence = missing_extra(f"pytest_tarl.{name}")
        if sentence is not None:
            raise ImportError(sentence)
        return getattr(import_module(_HOMES[name]), name)
    if name == "faults":
        return import_module("pytest_tarl.faults")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
