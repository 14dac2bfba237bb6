"""Follow a car with adas-core: its pipeline and its ROS 2 bridge, with a detector for our camera."""

from pathlib import Path

import numpy as np
import rclpy
from adas.cli import build_pipeline
from adas.core.models import BoundingBox
from adas.ros2.bridge import ADASBridgeNode

CONFIG = Path(__file__).parent / "config" / "road.json"


class DarkCarDetector:
    """Find a dark car on a bright road."""

    def infer(self, frame, width, height):
        """Return the box of the car in the middle of the image."""
        darkness = 1.0 - frame["data"][:, width // 2] / 255.0
        tall = float(np.sum(darkness))
        if tall < 1.0:
            return []
        bottom = 0.8 * height
        return [BoundingBox(width * 0.4, bottom - tall, width * 0.6, bottom, 0.9, "vehicle")]


def main():
    """Run the bridge."""
    rclpy.init()
    pipeline, _ = build_pipeline(CONFIG)
    pipeline.detector = DarkCarDetector()
    rclpy.spin(ADASBridgeNode(pipeline))


if __name__ == "__main__":
    main()
