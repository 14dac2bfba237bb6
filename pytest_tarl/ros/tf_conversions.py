"""Stand-in for `tf_conversions`: `posemath`, and `transformations` as in tf."""

from __future__ import annotations

from pytest_tarl.ros import posemath, transformations
from pytest_tarl.ros.posemath import fromMatrix, fromMsg, fromTf, toMatrix, toMsg, toTf

__all__ = ["fromMatrix", "fromMsg", "fromTf", "posemath", "toMatrix", "toMsg", "toTf", "transformations"]
