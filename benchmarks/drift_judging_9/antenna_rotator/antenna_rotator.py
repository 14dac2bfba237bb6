"""Point a dish at a satellite that passes: drive the azimuth rotator after the predicted azimuth."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32


class AntennaRotator(Node):
    def __init__(self):
        super().__init__("antenna_rotator")
        self.counts_per_deg = self.declare_parameter("counts_per_deg", 12.0).value
        self.gain = self.declare_parameter("gain", 1.6).value  # 1/s
        self.max_rate = self.declare_parameter("max_rate", 5.0).value  # deg/s
        self.max_step = self.declare_parameter("max_step", 0.8).value  # deg/s per tick
        self.dead_band = self.declare_parameter("dead_band", 0.15).value  # deg
        self.lead = self.declare_parameter("lead", 0.3).value  # lag of the rotator (s)
        self.storm = self.declare_parameter("storm_wind", 22.0).value  # m/s
        self.park = self.declare_parameter("park_azimuth", 0.0).value
        self.track_from = self.declare_parameter("track_from_elevation", 3.0).value  # deg

        self.azimuth = 0.0
        self.predicted = None
        self.drift_rate = 0.0
        self.elevation = -90.0
        self.wind = 0.0
        self.rate = 0.0

        self.create_subscription(Int32, "rotator/encoder", self.on_encoder, 10)
        self.create_subscription(Float32, "pass/azimuth", self.on_azimuth, 10)
        self.create_subscription(Float32, "pass/elevation", self.on_elevation, 10)
        self.create_subscription(Float32, "mast/wind", self.on_wind, 10)
        self.motor = self.create_publisher(Float32, "rotator/rate", 10)
        self.locked = self.create_publisher(Bool, "rotator/on_target", 10)
        self.period = 0.1
        self.create_timer(self.period, self.tick)

    def on_encoder(self, msg):
        self.azimuth = msg.data / self.counts_per_deg

    def on_azimuth(self, msg):
        if self.predicted is not None:
            self.drift_rate += 0.2 * ((msg.data - self.predicted) / self.period - self.drift_rate)
        self.predicted = msg.data

    def on_elevation(self, msg):
        self.elevation = msg.data

    def on_wind(self, msg):
        self.wind = msg.data

    def target(self):
        if self.wind > self.storm or self.predicted is None:
            return self.park
        if self.elevation < self.track_from:
            return self.predicted
        return self.predicted + self.lead * self.drift_rate

    def tick(self):
        error = self.target() - self.azimuth
        wanted = 0.0 if abs(error) < self.dead_band else self.gain * error
        wanted = max(-self.max_rate, min(self.max_rate, wanted))
        self.rate += max(-self.max_step, min(self.max_step, wanted - self.rate))
        self.motor.publish(Float32(data=self.rate))
        self.locked.publish(Bool(data=abs(error) < 2.0))


def main(args=None):
    rclpy.init(args=args)
    node = AntennaRotator()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
