"""JSK's odometry_iir_filter.py smooths the odometry of a biped. A gait that sways more needs a lower cutoff."""

import math

import pytest

from pytest_tarl import Drift, Sensor
from pytest_tarl.ros import message_type

Odometry = message_type("nav_msgs/Odometry")

PACKAGE = "jsk_robot_common/jsk_robot_startup"
LAUNCH = f"{PACKAGE}/launch/particle_odometry.launch"
FILES = [
    f"{PACKAGE}/scripts/odometry_iir_filter.py",
    f"{PACKAGE}/src/jsk_robot_startup/OdometryIIRFilter.py",
    f"{PACKAGE}/src/jsk_robot_startup/IIRFilter.py",
    f"{PACKAGE}/src/jsk_robot_startup/odometry_utils.py",
]
DT = 0.05
TIME_BOUND = 6.0
SPEED = 0.4
STEPS = 4.0  # steps per second, at which the body sways


class Beam:
    """A walk along a narrow beam; the odometry reports the swaying body, the feet stand where the mean is."""

    def __init__(self, rng, sway=0.005):
        self.rng = rng
        self.sway = sway
        self.y = rng.uniform(-0.06, 0.06)
        self.drift = rng.uniform(-0.03, 0.03)
        self.phase = rng.uniform(0.0, 2.0 * math.pi)
        self.x, self.time = 0.0, 0.0
        self.failure = ""

    @property
    def over(self):
        """Return whether the mission has ended."""
        return bool(self.failure) or self.time > TIME_BOUND

    def publish(self, bus):
        """Publish the odometry of the legs."""
        odom = Odometry()
        odom.pose.pose.position.x = self.x
        odom.pose.pose.position.y = self.y + self.sway * math.sin(
            2.0 * math.pi * STEPS * self.time + self.phase
        )
        odom.pose.pose.orientation.w = 1.0
        bus.publish("/biped_odom_particle_raw", odom)

    def advance(self, filtered):
        """Step to where the filtered odometry says that the middle of the beam is."""
        seen = filtered.pose.pose.position.y if filtered else 0.0
        aside = max(-0.6, min(0.6, -3.0 * seen))
        self.x += SPEED * DT
        self.y += (aside + self.drift) * DT
        self.effort = abs(aside)
        self.time += DT

    def judge(self):
        """Return the reward of the step: for the way and a quiet walk."""
        if abs(self.y) > 0.09:
            self.failure = "stepped off"
        return -5.0 if self.failure else SPEED * DT * 4.0 * max(0.0, 1.0 - 4.0 * self.effort)


@pytest.mark.tarl(
    nodes=FILES,
    sensors=[
        Sensor(
            "aside",
            topic="/biped_odom_particle_raw",
            field="pose.pose.position.y",
            low=-0.1,
            high=0.1,
            bins=6,
            unit="m",
        ),
    ],
    drifts={"worn hips": Drift({"sway": 0.05}, permanent=True)},
    episodes=30,
    min_success=0.95,
)
def test_walks_on_the_beam(tarl, tarl_drift):
    """Walk."""
    beam = Beam(tarl.rng("beam"), **(tarl_drift or {}))
    arguments = {"use_odometry_iir_filter": "true"}
    tarl.launch(LAUNCH, arguments=arguments, only=["biped_particle_odometry_iir_filter"])
    while not beam.over:
        beam.publish(tarl.bus)
        tarl.step(DT)
        beam.advance(tarl.bus.latest("/biped_odom_particle"))
        tarl.reward(beam.judge())
    assert not beam.failure, beam.failure
