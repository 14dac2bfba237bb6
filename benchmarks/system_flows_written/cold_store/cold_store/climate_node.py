"""Pair temperature and humidity, publish the dew point and whether the coil may freeze over."""

import message_filters
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import RelativeHumidity, Temperature
from std_msgs.msg import Bool, Float64

from cold_store.psychrometrics import LowPass, dew_point


class ClimateNode(Node):
    """Watch the air of the store and its cooling coil."""

    def __init__(self):
        super().__init__("climate_node")
        self.declare_parameter("margin", 1.0)
        self._margin = self.get_parameter("margin").value
        self._filter = LowPass(0.2)
        self._coil = 20.0
        self._dew_pub = self.create_publisher(Float64, "dew_point", 10)
        self._frost_pub = self.create_publisher(Bool, "frost_risk", 10)
        self.create_subscription(Temperature, "coil/temperature", self._on_coil, 10)
        air = message_filters.Subscriber(self, Temperature, "air/temperature")
        humidity = message_filters.Subscriber(self, RelativeHumidity, "humidity")
        self._sync = message_filters.ApproximateTimeSynchronizer([air, humidity], 10, 0.5)
        self._sync.registerCallback(self._on_air)

    def _on_coil(self, msg):
        self._coil = self._filter.update(msg.temperature)

    def _on_air(self, air, humidity):
        dew = dew_point(air.temperature, humidity.relative_humidity)
        self._dew_pub.publish(Float64(data=dew))
        self._frost_pub.publish(Bool(data=self._coil < dew + self._margin))


def main(args=None):
    """Run the node until it is shut down."""
    rclpy.init(args=args)
    rclpy.spin(ClimateNode())
    rclpy.shutdown()
