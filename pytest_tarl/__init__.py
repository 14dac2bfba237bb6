"""Record what robot code is worth in simulation, see where another world breaks it, repair it."""

from pytest_tarl.episode import Tarl
from pytest_tarl.sensors import Sensor

__all__ = ["Sensor", "Tarl"]
