"""A cart that docks, in MuJoCo. Lengths in m, times in s, masses in kg, friction without unit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import mujoco

from pytest_tarl.ros import message_type

if TYPE_CHECKING:
    import numpy as np

    from pytest_tarl.ros import Bus

Odometry = message_type("nav_msgs/msg/Odometry")

DOCK, NEAR, BUMP = 2.0, 0.03, 0.05  # position of the dock, largest gap when docked, overrun at a collision
WHEEL, TRACK = 0.06, 0.26  # radius of a wheel, distance between the wheels
TIME_BOUND = 8.0
FRICTION, PAYLOAD = 0.8, 1.0


class World:
    """One docking. A drift changes the `friction` of the wheels or the `payload` in kg."""

    dt = 0.05

    def __init__(
        self, rng: np.random.Generator, friction: float = FRICTION, payload: float = PAYLOAD
    ) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(Path(__file__).with_name("cart.xml")))
        for name in ("left", "right"):
            self.model.geom(name).friction[0] = friction
        self.model.body("payload").inertia *= payload / self.model.body("payload").mass
        self.model.body("payload").mass = payload
        self.data = mujoco.MjData(self.model)
        self.data.joint("cart").qpos[1] = rng.uniform(-0.1, 0.1)
        self.data.joint("cart").qpos[0] = rng.uniform(-0.2, 0.2)
        self.failure = ""
        self.gap = DOCK - self.data.joint("cart").qpos[0]

    @property
    def docked(self) -> bool:
        """Return whether the cart stands at the dock."""
        return abs(self.gap) < NEAR and abs(self.data.joint("cart").qvel[0]) < 0.02

    def publish(self, bus: Bus) -> None:
        """Publish the pose and speed of the cart."""
        cart, message = self.data.joint("cart"), Odometry()
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x, pose.position.y, pose.position.z = map(float, cart.qpos[:3])
        pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z = map(
            float, cart.qpos[3:]
        )
        twist.linear.x, twist.angular.z = float(cart.qvel[0]), float(cart.qvel[5])
        bus.publish("/odom", message)

    def advance(self, bus: Bus) -> None:
        """Apply the latest command to the wheels for one step."""
        command = bus.latest("/cmd_vel")
        speed, turn = (command.linear.x, command.angular.z) if command else (0.0, 0.0)
        self.data.actuator("left").ctrl = (speed - turn * TRACK / 2) / WHEEL
        self.data.actuator("right").ctrl = (speed + turn * TRACK / 2) / WHEEL
        mujoco.mj_step(self.model, self.data, round(self.dt / self.model.opt.timestep))

    def monitor(self) -> dict[str, float]:
        """Return the parts of the reward for the last step."""
        before, self.gap = self.gap, DOCK - float(self.data.joint("cart").qpos[0])
        if self.gap < -BUMP:
            self.failure = "ran into the dock"
        elif self.data.time > TIME_BOUND:
            self.failure = "too slow"
        return {
            "progress": 5.0 * (abs(before) - abs(self.gap)) / DOCK,
            "time": -self.dt / TIME_BOUND,
            "end": -10.0 if self.failure else 5.0 if self.docked else 0.0,
        }
