"""A four-legged robot patrols a solar park. In June the grass is tall, and its feet catch in it."""

import math

import pytest

from pytest_tarl import Sensor
from pytest_tarl.ros import message_type

Pose = message_type("geometry_msgs/msg/Pose")
PoseArray = message_type("geometry_msgs/msg/PoseArray")
PoseStamped = message_type("geometry_msgs/msg/PoseStamped")
UInt8 = message_type("std_msgs/msg/UInt8")

DT = 0.2
MOWN = {"grass": 0.02, "seen": 2}
JUNE = {"grass": 0.085, "seen": 3}  # m of grass that holds a foot, class of the terrain


class Park:
    """A park with grass that holds a foot below `grass`, in m; a camera names the terrain."""

    def __init__(self, rng, grass, seen):
        self.rng = rng
        self.grass = grass * rng.uniform(0.9, 1.1)
        self.seen = seen
        turn = rng.uniform(-0.6, 0.6, 3).cumsum()
        legs = rng.uniform(2.5, 3.5, 3)
        east, north = (
            (legs * [math.cos(t) for t in turn]).cumsum(),
            (legs * [math.sin(t) for t in turn]).cumsum(),
        )
        self.posts = list(zip(east.tolist(), north.tolist(), strict=True))
        self.at, self.yaw = [0.0, 0.0], float(rng.uniform(-0.3, 0.3))
        self.charge, self.down, self.falls, self.looked = 1.0, 0, 0, 0
        self.time, self.gained, self.failure = 0.0, 0.0, ""

    @property
    def done(self):
        """Return whether all posts are seen, or the walker is lost."""
        return bool(self.failure) or self.looked == len(self.posts)

    def publish(self, bus):
        """Publish the pose, the terrain, and now and then the posts."""
        pose = PoseStamped()
        pose.pose.position.x = self.at[0] + self.rng.normal(0.0, 0.01)
        pose.pose.position.y = self.at[1] + self.rng.normal(0.0, 0.01)
        pose.pose.orientation.z, pose.pose.orientation.w = math.sin(self.yaw / 2.0), math.cos(self.yaw / 2.0)
        bus.publish("pose", pose)
        if round(self.time / DT) % 10 == 0:
            bus.publish("terrain/class", UInt8(data=self.seen))
            posts = PoseArray()
            for x, y in self.posts:
                post = Pose()
                post.position.x, post.position.y = x, y
                posts.poses.append(post)
            bus.publish("patrol/posts", posts)

    def advance(self, gait, status):
        """Walk for one step; a foot that stays low may catch, and a step higher than needed slams."""
        cadence, height, rate = gait.data if gait else (0.0, 0.05, 0.0)
        self.time += DT
        self.gained = -0.004
        if self.down:
            self.down -= 1
            return
        steps = DT * cadence
        drag = 1.0 - min(0.6, 4.0 * max(0.0, self.grass - height))
        self.yaw += DT * rate + self.rng.normal(0.0, 0.01)
        self.at[0] += 0.22 * steps * drag * math.cos(self.yaw)
        self.at[1] += 0.22 * steps * drag * math.sin(self.yaw)
        self.charge -= steps * (0.004 + 0.15 * max(0.0, height - 0.03))
        self.gained -= 0.45 * steps * max(0.0, height - self.grass - 0.045)
        margin = (height - self.grass) / 0.01
        if self.rng.random() < 0.25 * steps / (1.0 + math.exp(2.0 * margin)):
            self.falls += 1
            self.down = 12
            self.gained -= 0.7
        if self.falls > 2:
            self.failure = "walker fell three times and lies there"
        elif self.charge < 0.0:
            self.failure = "pack is empty"
        elif self.time > 90.0:
            self.failure = "patrol takes too long"
        elif status and status.data == "look":
            self.see()
        if self.failure:
            self.gained -= 4.0

    def see(self):
        """Look at the next post, if it is near."""
        x, y = self.posts[self.looked]
        if math.hypot(x - self.at[0], y - self.at[1]) < 0.5:
            self.looked += 1
            self.gained += 3.0


@pytest.mark.tarl(
    nodes=["grass_walker.py", "gait.py"],
    sensors=[
        Sensor("terrain", topic="terrain/class", field="data", low=0.0, high=5.0, bins=6),
        Sensor("x", topic="pose", field="pose.position.x", low=0.0, high=10.0, bins=5, unit="m"),
    ],
    drifts={"june": JUNE},
    episodes=200,
    min_success=0.97,
)
def test_patrols(tarl, tarl_drift):
    """Look at three posts."""
    park = Park(tarl.rng("park"), **(tarl_drift or MOWN))
    tarl.start("grass_walker.py")
    while not park.done:
        park.publish(tarl.bus)
        tarl.step(DT)
        park.advance(tarl.bus.latest("legs/gait"), tarl.bus.latest("patrol/status"))
        tarl.reward(park.gained)
    assert not park.failure, park.failure
