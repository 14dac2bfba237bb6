"""The examples measured by stress.py: for each, a test, one of its drifts, and the nominal value.

The simulator of `tank_external` runs in its own process and needs an installed ROS 2 (`make setup-ros2`).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

EXAMPLES_FOLDER = Path(__file__).resolve().parent.parent / "examples"


@dataclass(frozen=True)
class Example:
    """One direction of an example, from the nominal value to the drift declared by its test."""

    folder: str
    test: str  # pytest's id below the folder
    drift: str  # name of the drift
    nominal: float  # nominal value of the drift, or of its only entry

    @property
    def place(self) -> Path:
        """Return the folder of the test."""
        return EXAMPLES_FOLDER / self.folder


EXAMPLES = {
    "line_follower": Example("line_follower", "test_line_follower.py", "dusk", 1.0),
    "shuttle": Example("shuttle", "test_shuttle.py::test_delivers", "mud", 1.0),
    "shuttle_twice": Example("shuttle", "test_shuttle.py::test_shuttles", "mud", 1.0),
    "workspace": Example("workspace", "test_aisle.py", "worn tyres", 1.0),
    "quadrotor_payload": Example("quadrotor", "test_quadrotor.py", "payload", 0.0),
    "quadrotor_gust": Example("quadrotor", "test_quadrotor.py", "gust", 0.0),
    "pole_gymnasium": Example("pole_gymnasium", "test_balance.py", "long", 0.5),
    "cart_mujoco_loaded": Example("cart_mujoco", "test_docking.py", "loaded", 1.0),
    "cart_mujoco_wet": Example("cart_mujoco", "test_docking.py", "wet", 0.8),
    "tank_external": Example("tank_external", "test_tank.py", "clogged", 1.0),
}
