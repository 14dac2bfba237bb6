"""A sweeper follows the kerb. It was made for footpaths at walking pace, and now sweeps roads at 2 to 4.2 m/s."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Float32 = message_type("std_msgs/msg/Float32")
Odometry = message_type("nav_msgs/msg/Odometry")
Path = message_type("nav_msgs/msg/Path")
PoseStamped = message_type("geometry_msgs/msg/PoseStamped")

DT = 0.1
GRID = 0.2  # m between the points of the route
WHEELBASE = 1.6
OFF = 0.22  # m, how far off the brush still reaches the gutter
FOOTPATH = (0.6, 1.2)  # m/s
ROAD = (2.0, 4.2)


class Street:
    """A route with two bends, which are wider where the speed is higher."""

    def __init__(self, rng, speeds):
        self.rng = rng
        self.wish = float(rng.uniform(*speeds))
        radius = 2.7 * (self.wish / 2.0) ** 2.7 if self.wish > 1.5 else 2.2 + 1.5 * (self.wish - 0.5)
        self.points = self.route(radius, 5.0 + 1.5 * self.wish)
        self.x, self.y = 0.0, float(rng.uniform(-0.06, 0.06))
        self.yaw, self.steer, self.speed = float(rng.normal(0.0, 0.02)), 0.0, 0.0
        self.seen = [(self.x, self.y, self.yaw)] * 3  # the pose is 0.2 s old
        self.near, self.out = 0, 0
        self.time, self.gained, self.failure, self.over = 0.0, 0.0, "", False

    def route(self, radius, lead):
        """Return the points of the route."""
        points, x, y, yaw = [], 0.0, 0.0, 0.0
        bends = [float(self.rng.choice((-1.0, 1.0)) * self.rng.uniform(0.8, 1.2)) for _ in range(2)]
        for length, bend in ((lead, 0.0), (0.0, bends[0]), (lead, 0.0), (0.0, bends[1]), (1.4 * lead, 0.0)):
            for _ in range(round((length + radius * abs(bend)) / GRID)):
                points.append((x, y))
                yaw += GRID / radius * math.copysign(1.0, bend) if bend else 0.0
                x += GRID * math.cos(yaw)
                y += GRID * math.sin(yaw)
        return points

    @property
    def done(self):
        """Return whether the route is swept, or something went wrong."""
        return bool(self.failure) or self.over

    def publish(self, bus):
        """Publish the route, the speed and the pose."""
        if self.time == 0.0:
            path = Path()
            for x, y in self.points:
                pose = PoseStamped()
                pose.pose.position.x, pose.pose.position.y = x, y
                path.poses.append(pose)
            bus.publish("route", path)
        if round(self.time / DT) % 10 == 0:
            bus.publish("sweep/speed", Float32(data=self.wish))
        x, y, yaw = self.seen[0]
        yaw += self.rng.normal(0.0, 0.005)
        odom = Odometry()
        odom.pose.pose.position.x = x + self.rng.normal(0.0, 0.01)
        odom.pose.pose.position.y = y + self.rng.normal(0.0, 0.01)
        odom.pose.pose.orientation.z = math.sin(yaw / 2)
        odom.pose.pose.orientation.w = math.cos(yaw / 2)
        odom.twist.twist.linear.x = self.speed + self.rng.normal(0.0, 0.02)
        bus.publish("odom", odom)

    def off(self):
        """Return how far the sweeper is off its route, in m, and go on to the nearest point."""
        last = min(len(self.points), self.near + 30)
        away = [math.hypot(p[0] - self.x, p[1] - self.y) for p in self.points[self.near : last]]
        least = min(away)
        self.near += away.index(least)
        return least

    def advance(self, drive, finished):
        """Drive for one step; the steering follows with a lag of 0.35 s."""
        wish, steer = (drive.speed, drive.steering_angle) if drive else (0.0, 0.0)
        self.speed += max(-DT, min(DT, wish - self.speed))
        self.steer += DT / 0.35 * (steer - self.steer)
        self.yaw += DT * self.speed * math.tan(self.steer) / WHEELBASE
        self.x += DT * self.speed * math.cos(self.yaw)
        self.y += DT * self.speed * math.sin(self.yaw)
        self.seen = [*self.seen[1:], (self.x, self.y, self.yaw)]
        self.time += DT
        before = self.near
        off = self.off()
        share = GRID * (self.near - before) / (GRID * len(self.points))
        self.gained = 8.0 * share * max(-1.0, 1.0 - (off / OFF) ** 2) - 0.0005
        self.out += off > OFF
        self.over = bool(finished and finished.data)
        if off > 1.0:
            self.failure = "sweeper leaves the road"
        elif self.out > 10:
            self.failure = "brush does not reach the gutter"
        elif self.time > 120.0:
            self.failure = "route is not swept"
        if self.failure:
            self.gained -= 5.0


@pytest.mark.tarl(
    nodes=["kerb_sweeper.py", "route.py"],
    sensors=[
        Sensor("speed", topic="odom", field="twist.twist.linear.x", low=0.0, high=4.2, bins=5, unit="m/s"),
        Sensor("steering", topic="drive", field="steering_angle", low=-0.7, high=0.7, bins=5, unit="rad"),
    ],
    drifts={"roads": ROAD},
    episodes=200,
    min_success=0.97,
)
def test_sweeps(tarl, tarl_drift):
    """Sweep one route."""
    street = Street(tarl.rng("street"), tarl_drift or FOOTPATH)
    tarl.start("kerb_sweeper.py")
    while not street.done:
        street.publish(tarl.bus)
        tarl.step(DT)
        street.advance(tarl.bus.latest("drive"), tarl.bus.latest("sweeper/finished"))
        tarl.reward(street.gained)
    assert not street.failure, street.failure
