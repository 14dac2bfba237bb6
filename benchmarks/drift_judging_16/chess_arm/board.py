"""Geometry of the chess board: squares, pieces and the transform into the frame of the arm."""

import math
from dataclasses import dataclass

FILES = "abcdefgh"
GRIP_SHARE = 0.6  # height at which the fingers close, as a share of the piece's height
HEIGHTS = {"pawn": 0.042, "rook": 0.048, "knight": 0.054, "bishop": 0.062, "queen": 0.074, "king": 0.082}


@dataclass
class Board:
    square: float
    frame: float
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    seen: bool = False

    def update(self, x, y, yaw, share):
        """Average the pose of the corner near a1; the first one counts in full."""
        if not self.seen:
            share, self.seen = 1.0, True
        self.x += share * (x - self.x)
        self.y += share * (y - self.y)
        self.yaw += share * math.remainder(yaw - self.yaw, 2.0 * math.pi)

    def centre(self, name):
        column = FILES.index(name[0])
        row = int(name[1]) - 1
        along = self.frame + (column + 0.5) * self.square
        across = self.frame + (row + 0.5) * self.square
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return self.x + c * along - s * across, self.y + s * along + c * across


def grip_height(piece):
    return GRIP_SHARE * HEIGHTS.get(piece, 0.05)
