from enum import Enum, auto
from dataclasses import dataclass, field
from typing import Callable, Dict, Optional, List
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist, PoseStamped
from std_msgs.msg import String, Bool, UInt8
from sensor_msgs.msg import BatteryState


class S(Enum):
    IDLE = auto()
    MOVE = auto()
    DOCK = auto()


@dataclass
class Context:
    battery: float = 1.0
    goal: Optional[PoseStamped] = None
    done: bool = False
    log: List[str] = field(default_factory=list)


@dataclass
class Transition:
    source: S
    target: S
    guard: Callable[[Context], bool]


class Machine:
    def __init__(self, ctx):
        self._state = S.IDLE
        self.ctx = ctx
        self.transitions: List[Transition] = []
        self.listeners: List[Callable] = []

    @property
    def state(self):
        return self._state

    @state.setter
    def state(self, new):
        if new is not self._state:
            self._state = new
            for cb in self.listeners:
                cb(new)

    def add(self, *args):
        self.transitions.append(Transition(*args))
        return self

    def step(self):
        for t in self.transitions:
            if t.source == self.state and t.guard(self.ctx):
                self.state = t.target
                break


class Brain(Node):
    def __init__(self):
        super().__init__('brain')
        self.ctx = Context()
        self.m = Machine(self.ctx)
        self.m.add(S.IDLE, S.MOVE, lambda c: c.goal is not None) \
              .add(S.MOVE, S.DOCK, lambda c: c.battery < 0.2) \
              .add(S.DOCK, S.IDLE, lambda c: c.battery > 0.9)
        self.m.listeners.append(self.announce)
        self.state_pub = self.create_publisher(String, 'state', 10)
        self.cmd = self.create_publisher(Twist, 'cmd_vel', 10)
        self.goal_pub = self.create_publisher(PoseStamped, 'goal', 10)
        self.create_subscription(BatteryState, 'battery', lambda m: setattr(self.ctx, 'battery', m.percentage), 10)  # source bat
        self.create_subscription(PoseStamped, 'target', self.on_target, 10)  # source target
        self.create_timer(0.1, self.loop)

    def on_target(self, msg):
        self.ctx.goal = msg
        self.ctx.log.append('goal')

    def announce(self, state):
        self.state_pub.publish(String(data=state.name))  # sink ~bat

    def loop(self):
        self.m.step()
        if self.m.state == S.MOVE:
            self.goal_pub.publish(self.ctx.goal)  # sink target ~bat
        t = Twist()
        t.linear.x = {S.IDLE: 0.0, S.MOVE: 0.3, S.DOCK: -0.1}[self.m.state]
        self.cmd.publish(t)  # sink ~bat
        self.state_pub.publish(String(data=self.ctx.log[-1]))  # clean


def main():
    rclpy.init()
    rclpy.spin(Brain())
